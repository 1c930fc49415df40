#include "roof_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/infinity.h"
#include "core/ragged_builder.h"

namespace tetropolis {

namespace {

/// Elevations of the parts around some vertices, while they are changed.
class Floors {
 public:
  Floors(const GroundMesh& mesh, const EdgeGraph& edges, std::span<const RoofPlane> planes);

  void close_small_steps();
  /// Whether it changed anything.
  bool uncross();
  bool lift();
  ReconciledRoofs done(std::span<const RoofPlane> planes);

 private:
  struct Row {
    VertexIndex vertex;
    std::vector<RoofFloor> floors;  // ascending by part
    double closed = 0, lifted = 0;
  };
  /// An edge between two parts.
  struct Line {
    std::array<std::size_t, 2> rows;
    std::array<RegionIndex, 2> parts;
  };

  static RoofFloor& of(Row& row, RegionIndex part) {
    return *std::find_if(row.floors.begin(), row.floors.end(),
                         [&](const RoofFloor& floor) { return floor.part == part; });
  }
  static void join(Row& row, double a, double b);
  std::vector<RegionIndex> fan(VertexIndex v) const;

  const GroundMesh& mesh_;
  const EdgeGraph& edges_;
  std::vector<Row> rows_;
  std::vector<Line> lines_;
};

/// Parts of buildings with several of them, or with one that slopes.
std::vector<std::uint8_t> find_shaped(const GroundMesh& mesh, std::span<const RoofPlane> planes) {
  std::vector<std::uint8_t> shaped(mesh.regions.size(), 0);
  for (const RegionIndex r : indices<RegionIndex>(planes.size())) {
    const BuildingIndex building = mesh.regions[r].building;
    const bool has_next =
        r + 1 < planes.size() && mesh.regions[r + 1].building == building;
    shaped[r] = mesh.regions[r].part > 0 || has_next || !planes[r].is_flat() ? 1 : 0;
  }
  return shaped;
}

Floors::Floors(const GroundMesh& mesh, const EdgeGraph& edges, std::span<const RoofPlane> planes)
    : mesh_(mesh), edges_(edges) {
  const std::vector<std::uint8_t> shaped = find_shaped(mesh, planes);
  const VertexRegions regions = regions_at_vertices(mesh);
  std::vector<std::int32_t> row_of(mesh.vertices.size(), -1);
  for (const VertexIndex v : mesh.vertices.indices()) {
    Row row{v, {}};
    for (const RegionIndex r : regions[v])
      if (shaped[r] != 0) row.floors.push_back({r, planes[r](mesh.vertices[v]), 0});
    if (row.floors.empty()) continue;
    row_of[v] = static_cast<std::int32_t>(rows_.size());
    rows_.push_back(std::move(row));
  }
  for (const EdgeIndex e : edges.vertices.indices()) {
    const auto [t0, t1] = edges.triangles[e];
    if (t1 == kNoTriangle) continue;
    const RegionIndex a = mesh.region[t0], b = mesh.region[t1];
    if (a == b || shaped[a] == 0 || shaped[b] == 0) continue;
    const auto row = [&](std::size_t i) {
      return static_cast<std::size_t>(row_of[edges.vertices[e][i]]);
    };
    lines_.push_back({{row(0), row(1)}, {a, b}});
  }
}

/// Roofs at elevations a and b meet halfway.
void Floors::join(Row& row, double a, double b) {
  const double middle = a + (b - a) / 2;
  for (RoofFloor& floor : row.floors) {
    if (floor.z != a && floor.z != b) continue;
    row.closed = std::max(row.closed, std::abs(floor.z - middle));
    floor.z = middle;
  }
}

void Floors::close_small_steps() {
  std::vector<double> z;
  for (Row& row : rows_) {
    for (;;) {
      z.clear();
      for (const RoofFloor& floor : row.floors) z.push_back(floor.z);
      std::sort(z.begin(), z.end());
      z.erase(std::unique(z.begin(), z.end()), z.end());
      std::size_t nearest = 0;
      double least = kLeastStep;
      for (std::size_t i = 1; i < z.size(); ++i)
        if (z[i] - z[i - 1] < least) {
          least = z[i] - z[i - 1];
          nearest = i;
        }
      if (nearest == 0) break;
      join(row, z[nearest - 1], z[nearest]);
    }
  }
}

bool Floors::uncross() {
  bool changed = false;
  for (const Line& line : lines_) {
    std::array<double, 2> a{}, b{};
    for (std::size_t i = 0; i < 2; ++i) {
      a[i] = of(rows_[line.rows[i]], line.parts[0]).z;
      b[i] = of(rows_[line.rows[i]], line.parts[1]).z;
    }
    if (!((a[0] < b[0] && a[1] > b[1]) || (a[0] > b[0] && a[1] < b[1]))) continue;
    const std::size_t i = std::abs(a[0] - b[0]) <= std::abs(a[1] - b[1]) ? 0 : 1;
    join(rows_[line.rows[i]], a[i], b[i]);
    changed = true;
  }
  return changed;
}

/// The regions around v, counter-clockwise, each as often as it is met.
std::vector<RegionIndex> Floors::fan(VertexIndex v) const {
  const Point2 p = mesh_.vertices[v];
  std::vector<std::pair<double, RegionIndex>> sectors;
  for (const TriangleIndex t : triangles_around(edges_, {&v, 1})) {
    Point2 centre{};
    for (const VertexIndex u : mesh_.triangles[t]) {
      centre.x += (mesh_.vertices[u].x - p.x) / 3;
      centre.y += (mesh_.vertices[u].y - p.y) / 3;
    }
    sectors.emplace_back(std::atan2(centre.y, centre.x), mesh_.region[t]);
  }
  std::sort(sectors.begin(), sectors.end());
  std::vector<RegionIndex> regions;
  for (const auto& [angle, region] : sectors)
    if (regions.empty() || regions.back() != region) regions.push_back(region);
  while (regions.size() > 1 && regions.front() == regions.back()) regions.pop_back();
  return regions;
}

bool Floors::lift() {
  bool changed = false;
  for (Row& row : rows_) {
    if (row.floors.size() < 2) continue;
    const std::vector<RegionIndex> sectors = fan(row.vertex);
    if (sectors.size() < 4) continue;
    for (;;) {
      // Elevations around the vertex, equal neighbours as one.
      std::vector<double> z;
      for (const RegionIndex r : sectors) {
        const double here = mesh_.regions[r].is_building() ? of(row, r).z : -kInfinity;
        if (z.empty() || z.back() != here) z.push_back(here);
      }
      while (z.size() > 1 && z.front() == z.back()) z.pop_back();
      const std::size_t n = z.size();
      std::size_t valleys = 0, shallowest = n;
      double least = kInfinity;
      for (std::size_t i = 0; i < n; ++i) {
        const double rim = std::min(z[(i + 1) % n], z[(i + n - 1) % n]);
        if (n < 2 || !(z[i] < rim)) continue;
        ++valleys;
        if (rim - z[i] < least) {
          least = rim - z[i];
          shallowest = i;
        }
      }
      if (valleys < 2 || shallowest == n) break;
      const double low = z[shallowest], high = low + least;
      const double rim = std::min(z[(shallowest + 1) % n], z[(shallowest + n - 1) % n]);
      for (RoofFloor& floor : row.floors)
        if (floor.z == low) floor.z = rim;
      row.lifted = std::max(row.lifted, high - low);
      changed = true;
    }
  }
  return changed;
}

ReconciledRoofs Floors::done(std::span<const RoofPlane> planes) {
  ReconciledRoofs result;
  constexpr double kNothing = 0.01;  // metres
  std::vector<double> low(planes.size());
  for (std::size_t r = 0; r < planes.size(); ++r)
    low[r] = planes[r].is_flat() ? planes[r].elevation : kInfinity;
  std::vector<const Row*> sloped(mesh_.vertices.size(), nullptr);
  for (Row& row : rows_) {
    for (const RoofFloor& floor : row.floors)
      if (!planes[floor.part].is_flat()) low[floor.part] = std::min(low[floor.part], floor.z);
    result.closed += row.closed > kNothing ? 1 : 0;
    result.lifted += row.lifted > 0 ? 1 : 0;
    result.most_closed = std::max(result.most_closed, row.closed);
    result.most_lifted = std::max(result.most_lifted, row.lifted);
    for (RoofFloor& floor : row.floors) {
      floor.level = floor.z;
      const RoofPlane& plane = planes[floor.part];
      if (!plane.is_flat() || floor.z != plane.elevation) sloped[row.vertex] = &row;
    }
  }
  result.roofs.flat = std::move(low);
  if (std::all_of(sloped.begin(), sloped.end(), [](const Row* row) { return row == nullptr; }))
    return result;
  for (const VertexIndex v : mesh_.vertices.indices())
    result.roofs.sloped.push_back(sloped[v] == nullptr ? std::span<const RoofFloor>{}
                                                       : std::span(sloped[v]->floors));
  return result;
}

/// Of a line along which two roofs are `from` and `to` apart; `length` is its own.
double longest_on_step(double from, double to, double length) {
  constexpr double kEdgesPerStep = 4;
  if (from * to < 0) return kEdgesPerStep * kLeastStep;
  const auto [least, most] = std::minmax(std::abs(from), std::abs(to));
  if (most < kLeastStep) return length;
  return kEdgesPerStep * std::max(least, kLeastStep);
}

/// Appends the pieces of the line between shares t and u of the way from p to q.
void append_pieces(const std::array<Point2, 2>& line, const std::array<double, 2>& steps, double t,
                   double u, double longest, std::vector<LinePiece>& pieces) {
  const auto step = [&](double s) { return steps[0] + s * (steps[1] - steps[0]); };
  const double length =
      (u - t) * std::hypot(line[1].x - line[0].x, line[1].y - line[0].y);
  const double allowed = std::min(longest, longest_on_step(step(t), step(u), longest));
  if (length > allowed && length > 2 * kLeastStep) {
    append_pieces(line, steps, t, (t + u) / 2, longest, pieces);
    append_pieces(line, steps, (t + u) / 2, u, longest, pieces);
    return;
  }
  const Point2 end = u == 1 ? line[1]
                            : Point2{line[0].x + u * (line[1].x - line[0].x),
                                     line[0].y + u * (line[1].y - line[0].y)};
  pieces.push_back({end, allowed});
}

}  // namespace

std::vector<LinePiece> divide_party_line(const RoofPlane& a, const RoofPlane& b, Point2 p, Point2 q,
                                         double longest) {
  constexpr double kNearEnd = 0.5;  // metres
  const std::array line{p, q};
  const std::array steps{a(p) - b(p), a(q) - b(q)};
  const double length = std::hypot(q.x - p.x, q.y - p.y);
  std::vector<LinePiece> pieces;
  double from = 0;
  if (steps[0] * steps[1] < 0) {
    const double crossing = steps[0] / (steps[0] - steps[1]);
    if (std::min(crossing, 1 - crossing) * length >= kNearEnd) {
      append_pieces(line, steps, 0, crossing, longest, pieces);
      from = crossing;
    }
  }
  append_pieces(line, steps, from, 1, longest, pieces);
  return pieces;
}

ReconciledRoofs reconcile_roofs(const GroundMesh& mesh, const EdgeGraph& edges,
                                std::span<const RoofPlane> planes) {
  Floors floors(mesh, edges, planes);
  // Roofs only ever meet and rise here, so this ends.
  do floors.close_small_steps();
  while (floors.uncross() || floors.lift());
  return floors.done(planes);
}

}  // namespace tetropolis
