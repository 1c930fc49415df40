#include "tetropolis/ground/refine.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "core/units.h"
#include "refiner.h"
#include "validate.h"

namespace tetropolis {

namespace {

// Points on the sides of a corner are rounded: squares of distances that are equal but for that.
constexpr double kEqual = 0.998;

constexpr double kSquaredSine30 = 0.25;

double squared_distance(Point2 p, Point2 q) {
  const double dx = p.x - q.x, dy = p.y - q.y;
  return dx * dx + dy * dy;
}

// Drops the last digits, in which the mathematical functions of different systems may differ.
double portable(double value) { return std::round(value * 0x1p40) * 0x1p-40; }

void check_options(const RefineOptions& options) {
  if (!(options.min_angle_deg >= 0 && options.min_angle_deg <= 33))
    throw Error(ErrorKind::kUsage, fmt::format("minimum angle of {} degrees: must be from 0 to 33",
                                               options.min_angle_deg));
  if (!(options.max_edge >= 0))
    throw Error(ErrorKind::kUsage,
                fmt::format("mesh size {}: must be positive, or 0 for none", options.max_edge));
}

}  // namespace

Refiner::Refiner(const PlanarGraph& graph, const RefineOptions& options, Construction& construction)
    : options_(options), mesh_(construction.mesh), size_(graph, options) {
  const double angle = to_radians(options.min_angle_deg);
  // A hair more than asked, so that no rounding on the way to a measured angle falls below it.
  const double sine = portable(std::sin(angle) * (1 + 1e-9));
  sine_squared_ = sine * sine;
  cosine_ = portable(std::cos(angle));
  // The off-centre sees the shortest edge under the minimum angle: a little nearer, so that its
  // triangle is not at the limit (Ungor 2004).
  off_centre_height_ = portable(0.95 * 0.5 / std::tan(0.5 * std::max(angle, 0.05)));
  // A lens of angle 180 - 2 * angle, so that a triangle of a segment and an apex outside of it can
  // be good (Shewchuk 2002); never thinner than for 20 degrees nor fatter than for 30.
  const double lens = 2 * to_radians(std::clamp(options.min_angle_deg, 20.0, 30.0));
  lens_cosine_squared_ = portable(std::cos(lens) * std::cos(lens));
  max_vertices_ = options.max_vertices;
}

Refiner::Shape Refiner::shape(const TriMesh::Triangle& x) const {
  const Point2 a = mesh_.point(x.v[0]), b = mesh_.point(x.v[1]), c = mesh_.point(x.v[2]);
  const double k = squared_distance(b, c), l = squared_distance(c, a), m = squared_distance(a, b);
  Shape s;
  s.squared = {k, l, m};
  s.twice_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const double low = l < k ? l : k, high = k < l ? l : k, inner = high < m ? high : m;
  s.least = m < low ? m : low;
  s.middle = low < inner ? inner : low;
  s.most = high < m ? m : high;
  return s;
}

// The longest of the edges that are longer than allowed, or kNothing.
int Refiner::oversized_edge(const TriMesh::Triangle& x, const Shape& s) const {
  if (size_.constant() && !size_.by_segment())
    return s.most > size_.base() * size_.base() ? s.longest() : TriMesh::kNothing;
  int found = TriMesh::kNothing;
  double worst = 1;
  for (int i = 0; i < 3; ++i) {
    const double bound = squared_bound(x.region, x.v[(i + 1) % 3], x.v[(i + 2) % 3]);
    const double ratio = s.squared[static_cast<std::size_t>(i)] / bound;
    if (ratio > worst) {
      worst = ratio;
      found = i;
    }
  }
  return found;
}

// A skinny triangle that cannot be helped: it lies in, or across from, a corner of the input that
// is sharper than the minimum angle. Across from it only if it is no sharper than that corner: the
// one on the edge between two points at distance r, whose apex lies at distance k * r on a side of
// the corner of angle a, has the sine sin a / sqrt(k * k - 2 * k * cos a + 1), so that is so up to
// k = 2 cos a. Where it is sharper, both sides are free further than that and can be split; no
// vertex comes closer to another than that edge is long as long as a is at most 30 degrees.
bool Refiner::excused(const TriMesh::Triangle& x, const Shape& s) const {
  const int i = s.shortest();
  if (x.n[(i + 1) % 3] < 0 && x.n[(i + 2) % 3] < 0) return true;
  const double corner = squared_sine_across(x.v[(i + 1) % 3], x.v[(i + 2) % 3]);
  const double asked = kEqual * kEqual * std::min(corner, kSquaredSine30);
  return corner > 0 && s.twice_area * s.twice_area >= asked * (s.most * s.middle);
}

// Of the corner, sharper than the minimum angle, between the two sides that x and y lie on, at the
// same distance from it; 0 if they do not.
double Refiner::squared_sine_across(std::int32_t x, std::int32_t y) const {
  const std::int32_t px = kind(x);
  const std::int32_t py = kind(y);
  if (px == py || px < 0 || py < 0) return 0;
  // The shell of x and y about a corner `w` they share a piece with.
  const auto squared_sine = [&](std::int32_t w) {
    const Point2 c = mesh_.point(w);
    const double dx2 = squared_distance(mesh_.point(x), c),
                 dy2 = squared_distance(mesh_.point(y), c);
    if (dx2 < kEqual * dy2 || dy2 < kEqual * dx2) return 0.0;
    const Point2 p = mesh_.point(x), q = mesh_.point(y);
    const double dot = (p.x - c.x) * (q.x - c.x) + (p.y - c.y) * (q.y - c.y);
    if (!(dot > 0 && dot * dot > cosine_ * cosine_ * dx2 * dy2)) return 0.0;
    const double cross = (p.x - c.x) * (q.y - c.y) - (p.y - c.y) * (q.x - c.x);
    return cross * cross / (dx2 * dy2);
  };
  for (const std::int32_t w : piece(px).v)
    if (w == piece(py).v[0] || w == piece(py).v[1])
      if (const double found = squared_sine(w); found > 0) return found;
  return 0;
}

int Refiner::skinny_bucket(const Shape& s) const {
  const int exponent = std::ilogb(s.least);
  return std::clamp(kSkinnyBuckets - 1 + exponent - largest_edge_exponent_, 0, kSkinnyBuckets - 1);
}

int Refiner::oversized_bucket(const TriMesh::Triangle& x, const Shape& s, int edge) const {
  // The circumradius in units of the size allowed: from a half up, finely where most of them are.
  const double bound = squared_bound(x.region, x.v[(edge + 1) % 3], x.v[(edge + 2) % 3]);
  const double squared_radius =
      s.squared[0] * s.squared[1] * s.squared[2] / (4 * s.twice_area * s.twice_area * bound);
  const double rank = 24 * (std::sqrt(squared_radius) - 0.5);
  return kBuckets - 1 -
         static_cast<int>(
             std::clamp(rank, 0.0, static_cast<double>(kBuckets - kSkinnyBuckets - 1)));
}

void Refiner::consider(std::int32_t t) {
  TriMesh::Triangle& x = mesh_.tri(t);
  if (x.v[0] == TriMesh::kDead || x.considered != 0) return;
  x.considered = 1;
  for (int i = 0; i < 3; ++i) {
    if (x.n[i] >= 0) continue;
    const TriMesh::Subsegment& s = mesh_.sub(~x.n[i]);
    if (in_lens(mesh_.point(x.v[i]), mesh_.point(s.v[0]), mesh_.point(s.v[1])))
      encroached_.push_back({~x.n[i], {s.v[0], s.v[1]}});
  }
  const Shape s = shape(x);
  int bucket = 0;
  if (skinny(s) && !excused(x, s)) {
    bucket = skinny_bucket(s);
  } else if (const int edge = oversized_edge(x, s); edge >= 0) {
    bucket = oversized_bucket(x, s, edge);
  } else {
    return;
  }
  buckets_[static_cast<std::size_t>(bucket)].push_back({t, {x.v[0], x.v[1], x.v[2]}});
  filled_ |= std::uint64_t{1} << bucket;
  ++queued_;
}

void Refiner::consider_touched() {
  for (const std::int32_t t : mesh_.touched) consider(t);
  mesh_.touched.clear();
}

bool Refiner::pop(BadTriangle& bad) {
  while (filled_ != 0) {
    const int b = std::countr_zero(filled_);
    auto& bucket = buckets_[static_cast<std::size_t>(b)];
    bad = bucket.front();
    bucket.pop_front();
    --queued_;
    if (bucket.empty()) filled_ &= ~(std::uint64_t{1} << b);
    const TriMesh::Triangle& x = mesh_.tri(bad.t);
    if (x.v[0] == bad.v[0] && x.v[1] == bad.v[1] && x.v[2] == bad.v[2]) return true;
  }
  return false;
}

// Where a vertex would improve the triangle: the circumcentre, or on the way to it from the
// shortest edge the point where that edge is seen under the minimum angle.
Point2 Refiner::split_position(const TriMesh::Triangle& x, const Shape& s, bool is_skinny) const {
  const int i = s.shortest();
  const Point2 p = mesh_.point(x.v[(i + 1) % 3]), q = mesh_.point(x.v[(i + 2) % 3]);
  const double dx = q.x - p.x, dy = q.y - p.y;
  // Height of the circumcentre over the edge: half its length times the cotangent at the apex.
  const double l2 = s.squared[static_cast<std::size_t>((i + 1) % 3)];
  const double m2 = s.squared[static_cast<std::size_t>((i + 2) % 3)];
  const double e2 = s.squared[static_cast<std::size_t>(i)];
  double height = 0.25 * (l2 + m2 - e2) / s.twice_area;  // in units of the edge's length
  if (is_skinny && !(height <= off_centre_height_)) height = off_centre_height_;
  return {p.x + 0.5 * dx - height * dy, p.y + 0.5 * dy + height * dx};
}

// Goes straight from triangle t towards `target`. The triangle it is in, or kNothing with the
// subsegment that hides it. It ends, whatever is rounded: each edge that it crosses has the target
// beyond it and is locally Delaunay, so the target's power by the circumcircle falls from triangle
// to triangle (Edelsbrunner, "An acyclicity theorem for cell complexes in d dimensions", 1990).
std::int32_t Refiner::walk(std::int32_t t, Point2 target, std::int32_t& blocking) const {
  const TriMesh::Triangle& x = mesh_.tri(t);
  const Point2 v[3] = {mesh_.point(x.v[0]), mesh_.point(x.v[1]), mesh_.point(x.v[2])};
  const Point2 from = {(v[0].x + v[1].x + v[2].x) / 3, (v[0].y + v[1].y + v[2].y) / 3};
  int beyond = 0;
  int out = 0;
  int inner = 0;
  for (int i = 0; i < 3; ++i) {
    if (orient2d(v[(i + 1) % 3], v[(i + 2) % 3], target) < 0) {
      ++beyond;
      out = i;
    } else {
      inner = i;
    }
  }
  if (beyond == 0) return t;
  if (beyond == 2) {
    // The way passes the vertex opposite to the third edge on its left (then it leaves by the edge
    // that ends there) or on its right.
    const bool left = orient2d(from, target, v[inner]) > 0;
    out = left ? (inner + 1) % 3 : (inner + 2) % 3;
  }
  std::int32_t he = 4 * t + out;
  for (;;) {
    const std::int32_t n = mesh_.link(he);
    if (n < 0) {
      blocking = ~n;
      return TriMesh::kNothing;
    }
    const Point2 a = mesh_.point(mesh_.target(n));
    const Point2 b = mesh_.point(mesh_.origin(n));
    const Point2 w = mesh_.point(mesh_.apex(n));
    const bool beyond_first = orient2d(a, w, target) < 0;
    const bool beyond_second = orient2d(w, b, target) < 0;
    if (!beyond_first && !beyond_second) return n >> 2;
    if (beyond_first && beyond_second) {
      he = orient2d(from, target, w) > 0 ? TriMesh::next(n) : TriMesh::prev(n);
    } else {
      he = beyond_first ? TriMesh::next(n) : TriMesh::prev(n);
    }
  }
}

bool Refiner::encroached(std::int32_t s) const {
  const TriMesh::Subsegment& x = mesh_.sub(s);
  for (const std::int32_t he : x.side)
    if (he >= 0 && in_lens(mesh_.point(mesh_.apex(he)), mesh_.point(x.v[0]), mesh_.point(x.v[1])))
      return true;
  return false;
}

std::int32_t Refiner::add_vertex(Point2 p, std::int32_t kind) {
  if (static_cast<std::int64_t>(mesh_.points.size()) >= max_vertices_)
    throw Error(
        ErrorKind::kGuarantee,
        fmt::format(
            "ground mesh: more than {} vertices, the last at ({:.6f}, {:.6f}); remove "
            "the tiny gap or corner there, or ask for wider gaps (min_building_distance) or "
            "a larger mesh_size",
            max_vertices_, p.x, p.y));
  kinds_.push_back(kind);
  return mesh_.add_point(p);
}

Point2 Refiner::cut_position(const TriMesh::Subsegment& s) const {
  const Point2 a = mesh_.point(s.v[0]), b = mesh_.point(s.v[1]);
  const Piece& whole = piece(s.piece);
  const bool from_a = piece_end_is_acute(whole, s.v[0]);
  const bool from_b = piece_end_is_acute(whole, s.v[1]);
  double t = 0.5;
  if (from_a != from_b) {
    // On the shell around the sharp corner, at a power of two between a third and two thirds.
    const double length = std::sqrt(squared_distance(a, b));
    const double shell = power_of_two_below(length * (2.0 / 3.0));
    t = from_a ? shell / length : 1 - shell / length;
  }
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

bool Refiner::split(std::int32_t s) {
  const Point2 a = mesh_.point(mesh_.sub(s).v[0]), b = mesh_.point(mesh_.sub(s).v[1]);
  const Point2 p = cut_position(mesh_.sub(s));
  const double scale = std::max({std::abs(a.x), std::abs(a.y), std::abs(b.x), std::abs(b.y)});
  if (mesh_.sub(s).frozen ||
      squared_distance(a, b) < scale * scale * (kOnSegmentTolerance * kOnSegmentTolerance))
    return false;
  // Free vertices in the diametral circle would be left with short edges (Chew 1993).
  for (int k = 0; k < 2; ++k) {
    for (;;) {
      const std::int32_t he = mesh_.sub(s).side[k];
      if (he < 0) break;
      const std::int32_t w = mesh_.apex(he);
      const Point2 q = mesh_.point(w);
      if (kind(w) != kFreeVertex || (a.x - q.x) * (b.x - q.x) + (a.y - q.y) * (b.y - q.y) >= 0)
        break;
      if (!mesh_.remove_vertex(he)) break;
    }
  }
  const std::int32_t v = add_vertex(p, mesh_.sub(s).piece);
  const bool done = mesh_.split_subsegment(s, v) != TriMesh::kNothing;
  if (!done) mesh_.sub(s).frozen = true;
  consider_touched();
  return done;
}

void Refiner::improve(const BadTriangle& bad) {
  const TriMesh::Triangle x = mesh_.tri(bad.t);
  const Shape s = shape(x);
  const bool is_skinny = skinny(s) && !excused(x, s);
  const auto again = [&] {
    TriMesh::Triangle& now = mesh_.tri(bad.t);
    if (now.v[0] != bad.v[0] || now.v[1] != bad.v[1] || now.v[2] != bad.v[2]) return;
    now.considered = 0;
    consider(bad.t);
  };
  if (const int edge = oversized_edge(x, s); edge >= 0 && x.n[edge] < 0) {
    if (split(~x.n[edge])) again();
    return;
  }
  const Point2 c = split_position(x, s, is_skinny);
  std::int32_t blocking = TriMesh::kNothing;
  const std::int32_t t = walk(bad.t, c, blocking);
  if (t < 0) {
    if (split(blocking)) again();
    return;
  }
  for (const std::int32_t v : mesh_.tri(t).v)
    if (mesh_.point(v) == c) return;
  mesh_.find_cavity(c, t);
  hit_.clear();
  for (const TriMesh::CavityEdge& e : mesh_.cavity)
    if (e.link < 0 && in_lens(c, mesh_.point(e.a), mesh_.point(e.b))) hit_.push_back(~e.link);
  if (hit_.empty()) {
    mesh_.fill_cavity(add_vertex(c, kFreeVertex));
    consider_touched();
    return;
  }
  bool any = false;
  for (const std::int32_t h : hit_) {
    const TriMesh::Subsegment& sub = mesh_.sub(h);
    if (in_lens(c, mesh_.point(sub.v[0]), mesh_.point(sub.v[1]))) any = split(h) || any;
  }
  if (any) again();
}

// Worst first over the whole mesh, and of as bad ones the first along the curve: all places are
// refined alike, and what one has does not go far. Depth first, a house would change the order in
// which others come to the end of the mesh.
void Refiner::run(const Progress& progress) {
  cut_the_rest();
  mesh_.touched.clear();
  for (TriMesh::Triangle& x : mesh_.triangles) x.considered = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh_.triangles.size()); ++t) consider(t);
  double fraction = 0;
  progress.update(fraction);
  for (std::int64_t steps = 1;; ++steps) {
    if ((steps & 0xfff) == 0) {
      const auto done = static_cast<double>(steps);
      fraction = std::max(fraction, done / (done + static_cast<double>(queued_)));
      progress.update(fraction);
    }
    if (!encroached_.empty()) {
      const LongSubsegment e = encroached_.back();
      encroached_.pop_back();
      const TriMesh::Subsegment& s = mesh_.sub(e.s);
      if (s.v[0] == e.v[0] && s.v[1] == e.v[1] && encroached(e.s)) split(e.s);
      continue;
    }
    BadTriangle bad;
    if (!pop(bad)) break;
    improve(bad);
  }
}

std::int64_t Refiner::count_below_min_angle() const {
  std::int64_t count = 0;
  for (const TriMesh::Triangle& x : mesh_.triangles) {
    if (x.v[0] == TriMesh::kDead) continue;
    // Those that are below only by the hair that is asked for in addition do not count.
    Shape s = shape(x);
    s.twice_area *= 1 + 2e-9;
    if (skinny(s)) ++count;
  }
  return count;
}

std::vector<std::int32_t> Refiner::piece_inputs() const {
  std::vector<std::int32_t> inputs;
  inputs.reserve(pieces_.size());
  for (const Piece& p : pieces_) inputs.push_back(p.input);
  return inputs;
}

Triangulation refine(const PlanarGraph& graph, const RefineOptions& options,
                     const Progress& progress) {
  check_options(options);
  progress.update(0);
  Construction construction = construct(graph, options.convex_hull);
  progress.update(0.1);
  Refiner refiner(graph, options, construction);
  refiner.seed(portion(progress, 0.1, 0.5));
  carve_along_curve(construction.mesh);
  progress.update(0.55);
  refiner.run(portion(progress, 0.55, 0.8));
  if (options.optimize) refiner.optimize(portion(progress, 0.8, 0.95));
  if (options.elevation) refiner.flatten(portion(progress, 0.95, 0.99));
  Triangulation result = export_triangulation(graph, construction, refiner.piece_inputs());
  result.small_input_angles = refiner.small_input_angles();
  result.triangles_below_min_angle = refiner.count_below_min_angle();
  progress.update(1);
  return result;
}

}  // namespace tetropolis
