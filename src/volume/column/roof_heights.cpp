#include "roof_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/infinity.h"
#include "core/ragged_builder.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

/// Squared secant of its slope: how much flatter cells on it are.
double steepness(const RoofPlane& roof) {
  return 1 + roof.slope_x * roof.slope_x + roof.slope_y * roof.slope_y;
}

/// How many times as high the least step beside the roof is.
double step_factor(const RoofPlane& roof) { return std::max(1.0, steepness(roof) / 2); }

/// Steps at a vertex between roofs that need not have a common wall there, with an own bound for
/// edges, are closed up to this height, metres: those that a triangle around the vertex reaches
/// across too far.
constexpr double kMostClosed = 1;

/// How far a triangle may reach for every metre of a step. Cells over it are then about as sharp as
/// 1 / 6 (9.5 degrees) and, where more has to be moved for that, as 1 / 7 (8.1, just above the
/// floor of quality).
double most_reach(double step) { return step < 0.75 ? 6 : 7; }

/// Elevations of the parts around some vertices, while they are changed.
class Floors {
 public:
  Floors(const GroundMesh& mesh, const EdgeGraph& edges, std::span<const RoofPlane> planes,
         double least_step);

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
  double reach(Row& row, double z) const;
  std::vector<RegionIndex> fan(VertexIndex v) const;

  void find_rises();

  const GroundMesh& mesh_;
  const EdgeGraph& edges_;
  std::vector<std::uint8_t> shaped_;  // per region
  std::vector<double> least_step_;    // per building part
  std::vector<std::int32_t> row_of_;  // per vertex, or -1
  std::vector<Row> rows_;
  std::vector<Line> lines_;
};

/// Parts of buildings with several of them, or with one that slopes.
std::vector<std::uint8_t> find_shaped(const GroundMesh& mesh, std::span<const RoofPlane> planes) {
  std::vector<std::uint8_t> shaped(mesh.regions.size(), 0);
  for (const RegionIndex r : indices<RegionIndex>(planes.size())) {
    const BuildingIndex building = mesh.regions[r].building;
    const bool has_next = r + 1 < planes.size() && mesh.regions[r + 1].building == building;
    shaped[r] = mesh.regions[r].part > 0 || has_next || !planes[r].is_flat() ? 1 : 0;
  }
  return shaped;
}

Floors::Floors(const GroundMesh& mesh, const EdgeGraph& edges, std::span<const RoofPlane> planes,
               double least_step)
    : mesh_(mesh),
      edges_(edges),
      shaped_(find_shaped(mesh, planes)),
      row_of_(mesh.vertices.size(), -1) {
  for (const RoofPlane& plane : planes) least_step_.push_back(least_step * step_factor(plane));
  const VertexRegions regions = regions_at_vertices(mesh);
  for (const VertexIndex v : mesh.vertices.indices()) {
    Row row{v, {}};
    for (const RegionIndex r : regions[v])
      if (shaped_[r] != 0) row.floors.push_back({r, planes[r](mesh.vertices[v]), 0, 0});
    if (row.floors.empty()) continue;
    row_of_[v] = static_cast<std::int32_t>(rows_.size());
    rows_.push_back(std::move(row));
  }
  for (const EdgeIndex e : edges.vertices.indices()) {
    const auto [t0, t1] = edges.triangles[e];
    if (t1 == kNoTriangle) continue;
    const RegionIndex a = mesh.region[t0], b = mesh.region[t1];
    if (a == b || shaped_[a] == 0 || shaped_[b] == 0) continue;
    const auto row = [&](std::size_t i) {
      return static_cast<std::size_t>(row_of_[edges.vertices[e][i]]);
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

/// How far triangles around the vertex with a floor at most at `z` there, or on open ground, reach
/// from it to the opposite side, metres.
double Floors::reach(Row& row, double z) const {
  double furthest = 0;
  for (const TriangleIndex t : triangles_around(edges_, {&row.vertex, 1})) {
    const RegionIndex region = mesh_.region[t];
    if (shaped_[region] != 0 && of(row, region).z > z) continue;
    const auto& v = mesh_.triangles[t];
    const std::size_t i = v[0] == row.vertex ? 0 : v[1] == row.vertex ? 1 : 2;
    const Point2 p = mesh_.vertices[row.vertex], q = mesh_.vertices[v[(i + 1) % 3]],
                 r = mesh_.vertices[v[(i + 2) % 3]];
    const double twice_area = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    furthest = std::max(furthest, twice_area / distance(r, q));
  }
  return furthest;
}

void Floors::close_small_steps() {
  for (Row& row : rows_) {
    std::vector<const RoofFloor*> by_height;
    for (const RoofFloor& floor : row.floors) by_height.push_back(&floor);
    for (;;) {
      std::sort(by_height.begin(), by_height.end(), [](const RoofFloor* a, const RoofFloor* b) {
        return std::pair(a->z, a->part) < std::pair(b->z, b->part);
      });
      double low = 0, high = 0, least = kInfinity;
      for (std::size_t i = 1; i < by_height.size(); ++i) {
        const RoofFloor &below = *by_height[i - 1], &above = *by_height[i];
        const double step = above.z - below.z;
        if (!(step > 0 && step < least)) continue;
        if (!(step < std::max(least_step_[below.part], least_step_[above.part])) &&
            !(step < kMostClosed && reach(row, below.z) > most_reach(step) * step))
          continue;
        least = step;
        low = below.z;
        high = above.z;
      }
      if (least == kInfinity) break;
      join(row, low, high);
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

void Floors::find_rises() {
  for (const TriangleIndex t : mesh_.triangles.indices()) {
    const RegionIndex part = mesh_.region[t];
    if (shaped_[part] == 0) continue;
    const auto floor = [&](VertexIndex v) -> RoofFloor& {
      return of(rows_[static_cast<std::size_t>(row_of_[v])], part);
    };
    double highest = -kInfinity;
    for (const VertexIndex v : mesh_.triangles[t]) highest = std::max(highest, floor(v).z);
    for (const VertexIndex v : mesh_.triangles[t])
      floor(v).rise = std::max(floor(v).rise, highest - floor(v).z);
  }
}

ReconciledRoofs Floors::done(std::span<const RoofPlane> planes) {
  find_rises();
  ReconciledRoofs result;
  constexpr double kNothing = 0.01;  // metres
  std::vector<double> low(planes.size());
  for (std::size_t r = 0; r < planes.size(); ++r)
    low[r] = planes[r].is_flat() ? planes[r].elevation : kInfinity;
  std::vector<std::uint8_t> is_sloped(planes.size(), 0);
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
      if (!plane.is_flat() || floor.z != plane.elevation) is_sloped[floor.part] = 1;
    }
  }
  result.roofs.flat = std::move(low);
  if (std::find(is_sloped.begin(), is_sloped.end(), 1) == is_sloped.end()) return result;
  const auto belongs = [&](const RoofFloor& floor) { return is_sloped[floor.part] != 0; };
  for (const VertexIndex v : mesh_.vertices.indices()) {
    std::span<const RoofFloor> floors;
    if (row_of_[v] >= 0) floors = rows_[static_cast<std::size_t>(row_of_[v])].floors;
    if (std::none_of(floors.begin(), floors.end(), belongs)) floors = {};
    result.roofs.sloped.push_back(floors);
  }
  return result;
}

/// What bounds edges at the steps between two roofs.
struct StepRule {
  double shortest_edge;
  double least_step;
  double edges_per_step = 4;

  StepRule(const RoofPlane& a, const RoofPlane& b, double least)
      : shortest_edge(least),
        least_step(least * std::max(step_factor(a), step_factor(b))),
        // Found by trial, on rows of gables of 30 to 65 degrees.
        edges_per_step(std::min(4.0, 6.7 / std::max(steepness(a), steepness(b)))) {}

  /// On a line along which the roofs are `from` and `to` apart.
  double longest_edge(double from, double to) const {
    if (from * to < 0) return edges_per_step * least_step;
    const auto [least, most] = std::minmax({std::abs(from), std::abs(to)});
    return most < least_step ? kInfinity : edges_per_step * std::max(least, least_step);
  }
};

/// Appends the pieces of the line between shares t and u of the way from p to q.
void append_pieces(const std::array<Point2, 2>& line, const std::array<double, 2>& steps,
                   const StepRule& rule, double t, double u, double longest,
                   std::vector<LinePiece>& pieces) {
  const auto step = [&](double s) { return steps[0] + s * (steps[1] - steps[0]); };
  const double length = (u - t) * distance(line[0], line[1]);
  const double allowed = std::min(longest, rule.longest_edge(step(t), step(u)));
  if (length > allowed && length > 2 * rule.shortest_edge) {
    append_pieces(line, steps, rule, t, (t + u) / 2, longest, pieces);
    append_pieces(line, steps, rule, (t + u) / 2, u, longest, pieces);
    return;
  }
  const Point2 end = u == 1 ? line[1]
                            : Point2{line[0].x + u * (line[1].x - line[0].x),
                                     line[0].y + u * (line[1].y - line[0].y)};
  pieces.push_back({end, allowed});
}

}  // namespace

std::vector<LinePiece> divide_party_line(const RoofPlane& a, const RoofPlane& b, Point2 p, Point2 q,
                                         double longest, double least_step) {
  constexpr double kNearEnd = 0.5;  // metres
  const std::array line{p, q};
  const std::array steps{a(p) - b(p), a(q) - b(q)};
  const double length = distance(p, q);
  const StepRule rule(a, b, least_step);
  std::vector<LinePiece> pieces;
  double from = 0;
  if (steps[0] * steps[1] < 0) {
    const double crossing = steps[0] / (steps[0] - steps[1]);
    if (std::min(crossing, 1 - crossing) * length >= kNearEnd) {
      append_pieces(line, steps, rule, 0, crossing, longest, pieces);
      from = crossing;
    }
  }
  append_pieces(line, steps, rule, from, 1, longest, pieces);
  return pieces;
}

ReconciledRoofs reconcile_roofs(const GroundMesh& mesh, const EdgeGraph& edges,
                                std::span<const RoofPlane> planes, double least_step) {
  Floors floors(mesh, edges, planes, least_step);
  // Roofs only ever meet and rise here, so this ends.
  do floors.close_small_steps();
  while (floors.uncross() || floors.lift());
  return floors.done(planes);
}

}  // namespace tetropolis
