#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tetropolis/core/row_major.h"
#include "tetropolis/geometry/polygon.h"

#include "core/infinity.h"
#include "core/mix64.h"
#include "core/units.h"
#include "hilbert.h"
#include "refiner.h"

namespace tetropolis {

namespace {

// Tuned on random rectangles and on the Stockholm tile by the number and the angles of triangles:
// spacing of the lattice and its distance from segments, in units of the longest edge allowed.
constexpr double kLatticeSpacing = 0.88;
constexpr double kLatticeClearance = 0.45;

double distance_between(Point2 p, Point2 q) {
  return std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y));
}

Point2 between(Point2 a, Point2 b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

}  // namespace

SizeBound::SizeBound(const PlanarGraph& graph, const RefineOptions& options) : options_(&options) {
  if (options.max_edge > 0) base_ = options.max_edge;
  base_squared_ = base_ * base_;
  for (const RegionSeed& region : graph.regions)
    if (region.max_edge > 0) regions_.emplace_back(region.marker, region.max_edge);
  for (std::size_t r = 0; r < options.region_max_edge.size(); ++r)
    if (std::isfinite(options.region_max_edge[r]))
      regions_.emplace_back(static_cast<std::int32_t>(r), options.region_max_edge[r]);
  std::sort(regions_.begin(), regions_.end());
  by_region_ = !regions_.empty();
  const std::vector<double>& edges = graph.segment_max_edge;
  if (std::any_of(edges.begin(), edges.end(), [&](double edge) { return edge < base_; }))
    by_segment_ = &edges;
}

double SizeBound::in_region(std::int32_t region) const {
  double bound = base_;
  const auto first = std::lower_bound(regions_.begin(), regions_.end(), std::pair{region, 0.0});
  if (first != regions_.end() && first->first == region) bound = std::min(bound, first->second);
  return bound;
}

double SizeBound::local_squared(std::int32_t region, Point2 p, Point2 q) const {
  double bound = by_region_ ? in_region(region) : base_;
  if (options_->size_field) {
    const Point2 middle{0.5 * (p.x + q.x), 0.5 * (p.y + q.y)};
    bound = std::min(bound, options_->size_field(middle));
  }
  return bound * bound;
}

void Refiner::seed(const Progress& progress) {
  find_pieces();
  if (mesh_.triangles.empty()) return;
  mesh_.tracking = false;
  mesh_.some_triangle.clear();
  find_corners();
  const Bounds2 box = bounds(mesh_.points);
  const double h = size_.base();
  const double squares = std::isfinite(h) ? box.width() * box.height() / (h * h) : 0;
  // Several times what any input has needed: cities get about 1.7 vertices a square and seven a
  // point of the input.
  if (max_vertices_ <= 0)
    max_vertices_ = std::int64_t{2'000'000} + 200 * static_cast<std::int64_t>(mesh_.points.size()) +
                    static_cast<std::int64_t>(std::min(8 * squares, 1e9));
  max_vertices_ = std::min(max_vertices_, kMostVertices);
  // About what is to come (measured on cities), within reason: growing would copy everything time
  // and again, and what is not used takes up no memory.
  const double triangles = std::min(5.5 * static_cast<double>(mesh_.points.size()) + 3.3 * squares,
                                    static_cast<double>(max_vertices_));
  mesh_.triangles.reserve(static_cast<std::size_t>(triangles));
  mesh_.points.reserve(static_cast<std::size_t>(triangles / 2));
  kinds_.reserve(static_cast<std::size_t>(triangles / 2));
  const double longest = std::min(h, std::max(box.width(), box.height()));
  largest_edge_exponent_ = 2 * std::ilogb(longest) + 1;
  cut_pieces();
  progress.update(0.3);
  if (options_.lattice && std::isfinite(size_.base())) insert_lattice(portion(progress, 0.3, 1));
  mesh_.touched.clear();
}

void Refiner::find_pieces() {
  kinds_.assign(mesh_.points.size(), kHardVertex);
  pieces_.clear();
  if (size_.by_segment()) hard_bounds_.assign(mesh_.points.size(), kInfinity);
  for (TriMesh::Subsegment& s : mesh_.subsegments) {
    const auto index = static_cast<std::int32_t>(pieces_.size());
    pieces_.push_back({{s.v[0], s.v[1]}, s.piece, {false, false}});
    if (size_.by_segment() && s.v[0] != TriMesh::kDead)
      for (const std::int32_t v : s.v) {
        double& bound = hard_bounds_[static_cast<std::size_t>(v)];
        bound = std::min(bound, size_.at_segment(s.piece));
      }
    s.piece = index;
  }
}

// Measures the angles between neighbouring pieces at their ends, where the area between them is
// meshed.
void Refiner::find_corners() {
  const double small_tangent = std::tan(to_radians(options_.min_angle_deg));
  const auto count = static_cast<std::int32_t>(mesh_.subsegments.size());
  for (std::int32_t s = 0; s < count; ++s) {
    if (mesh_.sub(s).v[0] == TriMesh::kDead) continue;
    for (int end = 0; end < 2; ++end) {
      std::int32_t he = mesh_.sub(s).side[end];
      if (mesh_.tri(he >> 2).region == kOutsideRegion) continue;
      const std::int32_t corner = mesh_.origin(he);
      const Point2 c = mesh_.point(corner), from = mesh_.point(mesh_.target(he));
      while (mesh_.link(TriMesh::prev(he)) >= 0) he = mesh_.link(TriMesh::prev(he));
      const std::int32_t other = ~mesh_.link(TriMesh::prev(he));
      if (other == s) continue;
      const Point2 to = mesh_.point(mesh_.apex(he));
      const double ux = from.x - c.x, uy = from.y - c.y, vx = to.x - c.x, vy = to.y - c.y;
      const double cross = ux * vy - uy * vx, dot = ux * vx + uy * vy;
      if (!(cross >= 0 && dot > 0 && cross < std::numbers::sqrt3 * dot)) continue;
      if (cross < small_tangent * dot) ++small_input_angles_;
      piece(mesh_.sub(s).piece).acute[end] = true;
      Piece& p = piece(mesh_.sub(other).piece);
      p.acute[p.v[0] == corner ? 0 : 1] = true;
    }
  }
}

void Refiner::cut_pieces() {
  const auto count = static_cast<std::int32_t>(mesh_.subsegments.size());
  for (std::int32_t s = 0; s < count; ++s) {
    if (mesh_.sub(s).v[0] == TriMesh::kDead) continue;
    double size = size_.at_segment(piece(mesh_.sub(s).piece).input);
    for (const std::int32_t he : mesh_.sub(s).side) {
      const std::int32_t region = mesh_.tri(he >> 2).region;
      // Where there is a size field, the main loop halves what is too long for it.
      if (region != kOutsideRegion && !options_.size_field)
        size = std::min(size, size_.in_region(region));
    }
    if (std::isfinite(size)) cut_piece(s, size);
  }
}

// Even cuts; but at a sharp corner at multiples of one power of two, so that the cuts of its two
// sides face each other.
void Refiner::cut_piece(std::int32_t s, double size) {
  const Piece whole = piece(mesh_.sub(s).piece);
  const Point2 a = mesh_.point(whole.v[0]), b = mesh_.point(whole.v[1]);
  const double length = distance_between(a, b);
  if (length <= size) return;
  std::vector<double> cuts;
  if (!whole.acute[0] && !whole.acute[1]) {
    const double n = std::ceil(length / size);
    for (double i = 1; i < n; ++i) cuts.push_back(i / n);
  } else {
    const double step = power_of_two_below(size);
    const bool both = whole.acute[0] && whole.acute[1];
    const double reach = both ? 0.5 * length : length;
    for (double d = step; d + 0.5 * step < reach; d += step) cuts.push_back(d / length);
    if (!whole.acute[0])
      for (double& t : cuts) t = 1 - t;
    if (both) {
      const std::size_t n = cuts.size();
      cuts.push_back(0.5);
      for (std::size_t i = 0; i < n; ++i) cuts.push_back(1 - cuts[i]);
    }
    std::sort(cuts.begin(), cuts.end());
  }
  cut({s, std::move(cuts)});
}

/// Leaves the rest of it to cut_the_rest() where a place is off the line, by rounding, and beyond a
/// triangle of the outside that is as thin.
void Refiner::cut(Cuts cuts) {
  const Piece& whole = piece(mesh_.sub(cuts.segment).piece);
  const Point2 a = mesh_.point(whole.v[0]), b = mesh_.point(whole.v[1]);
  for (auto t = cuts.places.begin(); t != cuts.places.end(); ++t) {
    const std::int32_t v = add_vertex(between(a, b, *t), mesh_.sub(cuts.segment).piece);
    mesh_.touched.clear();
    const std::int32_t next = mesh_.split_subsegment(cuts.segment, v);
    if (next == TriMesh::kNothing) {
      cuts.places.erase(cuts.places.begin(), t);
      rest_.push_back(std::move(cuts));
      return;
    }
    cuts.segment = next;
  }
}

void Refiner::cut_the_rest() {
  for (Cuts& cuts : std::exchange(rest_, {})) cut(std::move(cuts));
}

/// Nodes of a lattice of nearly equilateral triangles over the box that no segment is near to.
std::vector<Point2> Refiner::lattice_nodes() const {
  const Bounds2 box = bounds(mesh_.points);
  const double h = size_.base();
  const double columns = std::ceil(box.width() / (kLatticeSpacing * h));
  const double rows = std::ceil(box.height() / (kLatticeSpacing * h * 0.5 * std::numbers::sqrt3));
  if (!(columns >= 2 && rows >= 2) || columns * rows > 2e9) return {};
  const double dx = box.width() / columns;
  const double dy = box.height() / rows;
  const auto nx = static_cast<std::int64_t>(columns) + 1;
  const auto ny = static_cast<std::int64_t>(rows) + 1;
  // Odd rows are shifted by half a step; and each by a hair more or less than others, since
  // corners of rectangles lie on one circle, which only the exact predicates can tell.
  const auto node = [&](std::int64_t i, std::int64_t j) {
    const double hair = 0x1p-20 * static_cast<double>(mix64(static_cast<std::uint64_t>(j)) & 1023U);
    return Point2{box.xmin + (static_cast<double>(i) + (j % 2 == 0 ? 0.0 : 0.5) + hair) * dx,
                  box.ymin + static_cast<double>(j) * dy};
  };
  std::vector<char> taken(static_cast<std::size_t>(nx * ny), 0);
  const double clearance = kLatticeClearance * h;
  for (const Piece& p : pieces_) {
    if (p.v[0] < 0) continue;
    const Point2 a = mesh_.point(p.v[0]), b = mesh_.point(p.v[1]);
    const double low = std::min(a.y, b.y) - clearance, high = std::max(a.y, b.y) + clearance;
    const auto j0 = std::max<std::int64_t>(0, std::llround(std::ceil((low - box.ymin) / dy)));
    const auto j1 =
        std::min<std::int64_t>(ny - 1, std::llround(std::floor((high - box.ymin) / dy)));
    for (std::int64_t j = j0; j <= j1; ++j) {
      // The part of the segment whose height is within the clearance of the row.
      const double y = box.ymin + static_cast<double>(j) * dy;
      double t0 = 0, t1 = 1;
      if (a.y != b.y) {
        const double u = (y - clearance - a.y) / (b.y - a.y);
        const double v = (y + clearance - a.y) / (b.y - a.y);
        t0 = std::clamp(std::min(u, v), 0.0, 1.0);
        t1 = std::clamp(std::max(u, v), 0.0, 1.0);
      }
      const double x0 = a.x + t0 * (b.x - a.x), x1 = a.x + t1 * (b.x - a.x);
      const double left = std::min(x0, x1) - clearance, right = std::max(x0, x1) + clearance;
      const auto i0 =
          std::max<std::int64_t>(0, std::llround(std::floor((left - box.xmin) / dx)) - 1);
      const auto i1 =
          std::min<std::int64_t>(nx - 1, std::llround(std::ceil((right - box.xmin) / dx)));
      for (std::int64_t i = i0; i <= i1; ++i) {
        char& cell = taken[row_major(i, j, nx)];
        if (cell == 0 && squared_distance_to_segment(node(i, j), a, b) < clearance * clearance)
          cell = 1;
      }
    }
  }
  std::vector<Point2> nodes;
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i)
      if (taken[row_major(i, j, nx)] == 0 && box.contains(node(i, j))) nodes.push_back(node(i, j));
  return nodes;
}

void Refiner::insert_lattice(const Progress& progress) {
  const double h = size_.base();
  const std::vector<Point2> nodes = lattice_nodes();
  const HilbertCurve curve(bounds(mesh_.points));
  std::vector<std::uint32_t> keys(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) keys[k] = curve(nodes[k]);
  std::int32_t hint = 0;
  const std::vector<std::int32_t> order = sorted_order(keys);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % 4096 == 0) progress.update(static_cast<double>(i) / static_cast<double>(order.size()));
    const Point2 p = nodes[static_cast<std::size_t>(order[i])];
    const TriMesh::Location where = mesh_.locate(p, hint);
    hint = where.triangle;
    const std::int32_t region = mesh_.tri(where.triangle).region;
    if (region == kOutsideRegion || size_.in_region(region) < h || where.vertex >= 0) continue;
    if (options_.size_field && options_.size_field(p) < h) continue;
    if (where.edge >= 0 && mesh_.link(4 * where.triangle + where.edge) < 0) continue;
    mesh_.find_cavity(p, where.triangle);
    mesh_.touched.clear();
    mesh_.fill_cavity(add_vertex(p, kFreeVertex));
    hint = mesh_.touched.back();
  }
}

}  // namespace tetropolis
