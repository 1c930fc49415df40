// Points and segments from bytes through the constrained Delaunay triangulation.
#include <bit>
#include <cmath>

#include "tetropolis/ground/triangulation.h"

#include "fuzz_input.h"
#include "ground/validate.h"

namespace {

using namespace tetropolis;
using namespace tetropolis::fuzz;

constexpr int kMostPoints = 48;
constexpr int kMostSegments = 48;

/// How bytes become coordinates.
enum class Scale : std::uint8_t {
  kSmallGrid,    ///< 16 x 16: duplicates, collinear and cocircular points everywhere.
  kCentimetres,  ///< As maps have them, far from the origin.
  kNudged,       ///< The small grid off by a few units in the last place.
  kRaw,          ///< Any double, of any magnitude.
};

double nudged(double value, int steps) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return value == 0 ? steps * 1e-16 : std::bit_cast<double>(bits + steps);
}

double coordinate(ByteReader& bytes, Scale scale) {
  switch (scale) {
    case Scale::kSmallGrid:
      return bytes.between(0, 15);
    case Scale::kCentimetres:
      return 84000 + 0.01 * bytes.take<std::uint16_t>();
    case Scale::kNudged: {
      const double value = bytes.between(0, 7);
      return nudged(value, bytes.between(-2, 2));
    }
    case Scale::kRaw:
      break;
  }
  return bytes.take<double>();
}

/// Whether the coordinates are what constrained_delaunay() takes.
bool in_range(const PlanarGraph& graph) {
  double least = 1e300, most = 0;
  for (const std::vector<Point2>* points : {&graph.points, &graph.holes})
    for (const Point2 p : *points)
      for (const double v : {std::abs(p.x), std::abs(p.y)}) {
        if (!(v <= 1e100)) return false;
        if (v > 0) least = std::min(least, v);
        most = std::max(most, v);
      }
  return most == 0 || (least >= 1e-100 && most / least <= 1e100);
}

/// Distinct points so near to one another that segments may not find a way between them.
bool has_points_within_tolerance(const PlanarGraph& graph) {
  double most = 0;
  for (const Point2 p : graph.points) most = std::max({most, std::abs(p.x), std::abs(p.y)});
  for (const Point2 p : graph.points)
    for (const Point2 q : graph.points)
      if (p != q && std::hypot(p.x - q.x, p.y - q.y) <= 0x1p-45 * most) return true;
  return false;
}

PlanarGraph graph_from(ByteReader& bytes, Scale scale) {
  PlanarGraph graph;
  const int points = bytes.between(0, kMostPoints);
  const int segments = bytes.between(0, kMostSegments);
  const int holes = std::max(0, bytes.between(-6, 2));
  for (int i = 0; i < points; ++i) {
    const double x = coordinate(bytes, scale);
    graph.points.push_back({x, coordinate(bytes, scale)});
  }
  if (points == 0) return graph;
  for (int i = 0; i < segments && !bytes.empty(); ++i) {
    const VertexIndex a(bytes.between(0, points - 1));
    graph.segments.push_back({a, VertexIndex(bytes.between(0, points - 1))});
  }
  for (int i = 0; i < holes; ++i) {
    const double x = coordinate(bytes, scale);
    graph.holes.push_back({x, coordinate(bytes, scale)});
  }
  return graph;
}

Violations violations_of(const PlanarGraph& graph, const Triangulation& mesh, bool all_kept) {
  if (all_kept) return validate(graph, mesh);
  // check_input() does not know of segments that go with a hole or with the outside.
  Violations found = check_topology(mesh.points, mesh.triangles);
  if (found.empty() && !mesh.triangles.empty())
    found = check_constrained_delaunay(mesh.points, mesh.triangles, mesh.segments);
  return found;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ByteReader bytes(data, size);
  const auto scale = static_cast<Scale>(bytes.between(0, 3));
  TriangulationOptions options;
  options.convex_hull = bytes.between(0, 1) == 1;
  const PlanarGraph graph = graph_from(bytes, scale);
  const bool sound = in_range(graph);
  // Nothing but an end and a valid triangulation is promised of segments among such points.
  const bool blurred = has_points_within_tolerance(graph);
  try {
    const Triangulation mesh = constrained_delaunay(graph, options);
    const bool all_kept = options.convex_hull && graph.holes.empty() && !blurred;
    claim(sound, "coordinates out of range are refused");
    const Violations violations = violations_of(graph, mesh, all_kept);
    claim(violations.empty(), violations.empty() ? "" : violations[0]);
    const Triangulation again = constrained_delaunay(graph, options);
    claim(again.triangles == mesh.triangles && again.points == mesh.points, "the same again");
  } catch (const Error& error) {
    claim_error(error, ErrorKind::kInput);
    claim(!sound || blurred, error.what());
  }
  return 0;
}
