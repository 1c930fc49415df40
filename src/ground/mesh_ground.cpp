#include "tetropolis/ground/mesh_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/ground/refine.h"

#include "hilbert.h"
#include "size_field.h"

namespace tetropolis {

namespace {

struct Before {
  bool operator()(Point2 p, Point2 q) const { return p.x != q.x ? p.x < q.x : p.y < q.y; }
};

// What areas of the ground lie along outlines of buildings and sides of the domain, and the lines
// between areas.
class SurfaceBorders {
 public:
  SurfaceBorders(const Surfaces* surfaces, RegionIndex open_ground) : open_ground_(open_ground) {
    if (surfaces == nullptr) return;
    for (const SurfaceLine& line : surfaces->lines) {
      const bool turn = line.left != SurfaceLine::kBeyond;  // buildings lie on the left
      if (line.left != SurfaceLine::kBeyond && line.right != SurfaceLine::kBeyond)
        inner_.push_back(line);
      else
        pieces_[turn ? line.to : line.from] = {turn ? line.from : line.to,
                                               region(turn ? line.left : line.right)};
    }
  }

  struct Piece {
    Point2 to;
    RegionIndex region;
  };
  // The pieces of the straight line from p to q, with the building or what is beyond the domain on
  // the left: each with where it ends and what is on the right.
  std::vector<Piece> pieces(Point2 p, Point2 q) const {
    std::vector<Piece> result;
    for (auto next = pieces_.find(p); next != pieces_.end(); next = pieces_.find(next->second.to)) {
      result.push_back(next->second);
      if (next->second.to == q) return result;
    }
    return {{q, open_ground_}};
  }

  const std::vector<SurfaceLine>& inner() const { return inner_; }
  RegionIndex region(std::int32_t area) const {
    return area == SurfaceLine::kOpenGround ? open_ground_ : open_ground_ + 1 + area;
  }

 private:
  RegionIndex open_ground_;
  std::map<Point2, Piece, Before> pieces_;
  std::vector<SurfaceLine> inner_;
};

// Vertices by where they are: those that lines of areas end at.
class SharedVertices {
 public:
  VertexIndex at(Point2 p, PlanarGraph& graph) {
    const auto [place, is_new] = vertices_.try_emplace(p, graph.points.size());
    if (is_new) graph.points.push_back(p);
    return place->second;
  }
  void note(Point2 p, VertexIndex v) { vertices_.emplace(p, v); }

 private:
  std::map<Point2, VertexIndex, Before> vertices_;
};

// What is to be triangulated, and what its segments are: TaggedEdge without vertices.
struct Input {
  PlanarGraph graph;
  std::vector<TaggedEdge> segments;
  SharedVertices shared;
};

void require_inside(const Domain& domain, BuildingIndex building, Point2 p) {
  if (domain.encloses(p)) return;
  throw Error(ErrorKind::kInput,
              fmt::format("footprint {}: vertex ({}, {}) is not inside the domain; drop or clip "
                          "the footprint",
                          building.value(), p.x, p.y));
}

bool has_bounds(const GroundMeshOptions& options) {
  return options.wall_edge != nullptr || options.party_line != nullptr ||
         is_graded(options.mesh_size, options.grading);
}

double longest_edge(const GroundMeshOptions& options) {
  return std::max(options.mesh_size, options.grading.far_size);
}

// Adds a ring, directed so that the building lies on the left of its segments.
void add_ring(const Ring& ring, bool is_hole, BuildingIndex building, RegionIndex inside,
              const SurfaceBorders& borders, const Domain& domain, const GroundMeshOptions& options,
              std::int32_t number, Input& input) {
  PlanarGraph& graph = input.graph;
  const VertexIndex first(graph.points.size());
  const bool turn = (signed_area(ring) > 0) == is_hole;
  for (const Point2 p : ring) {
    require_inside(domain, building, p);
    if (options.surfaces != nullptr) input.shared.note(p, VertexIndex(graph.points.size()));
    graph.points.push_back(p);
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t j = i + 1 == ring.size() ? 0 : i + 1;
    const Point2 p = ring[turn ? j : i], q = ring[turn ? i : j];
    VertexIndex a = first + (turn ? j : i);
    const VertexIndex b = first + (turn ? i : j);
    for (const SurfaceBorders::Piece& piece : borders.pieces(p, q)) {
      const VertexIndex end = piece.to == q ? b : input.shared.at(piece.to, graph);
      graph.segments.push_back({a, end});
      graph.segment_sides.push_back({inside.value(), piece.region.value()});
      input.segments.push_back({{}, {}, inside, number});
      if (has_bounds(options))
        graph.segment_max_edge.push_back(
            options.wall_edge ? options.wall_edge(inside, ring[i], ring[j]) : options.mesh_size);
      a = end;
    }
    ++number;
  }
}

// A building of several parts: each line between two of them once.
class PartLines {
 public:
  PartLines(std::span<const PartOutline> parts, const SurfaceBorders& borders,
            const GroundMeshOptions& options, Input& input)
      : parts_(parts),
        borders_(borders),
        options_(options),
        input_(input),
        vertices_(options.surfaces == nullptr ? own_ : input.shared) {}

  void add(RegionIndex first, RegionIndex end, const Domain& domain) {
    for (const RegionIndex part : IndexRange<RegionIndex>(first, end))
      for_each_line(part, [&](Point2 a, Point2 b) {
        require_inside(domain, parts_[part].building, a);
        owner_[{a, b}] = part;
      });
    for (const RegionIndex part : IndexRange<RegionIndex>(first, end)) {
      std::int32_t number = 0;
      for_each_line(part, [&](Point2 a, Point2 b) { add_line(a, b, part, number++); });
    }
  }

 private:
  using Line = std::array<Point2, 2>;
  struct LineBefore {
    bool operator()(const Line& p, const Line& q) const {
      const Before before;
      return p[0] != q[0] ? before(p[0], q[0]) : before(p[1], q[1]);
    }
  };

  // Calls visit(a, b) for its lines, each with the part on the left.
  template <typename Visit>
  void for_each_line(RegionIndex part, const Visit& visit) const {
    const Polygon& outline = *parts_[part].outline;
    const auto along = [&](const Ring& ring, bool is_hole) {
      const bool turn = (signed_area(ring) > 0) == is_hole;
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Point2 p = ring[i], q = ring[i + 1 == ring.size() ? 0 : i + 1];
        turn ? visit(q, p) : visit(p, q);
      }
    };
    along(outline.outer, false);
    for (const Ring& hole : outline.holes) along(hole, true);
  }

  void add_line(Point2 a, Point2 b, RegionIndex part, std::int32_t number) {
    const auto other = owner_.find({b, a});
    if (other == owner_.end()) {
      const double longest =
          options_.wall_edge ? options_.wall_edge(part, a, b) : options_.mesh_size;
      for (const SurfaceBorders::Piece& piece : borders_.pieces(a, b)) {
        add_piece(a, piece.to, {part, piece.region}, number, longest);
        a = piece.to;
      }
    } else if (other->second > part) {
      std::vector<LinePiece> pieces{{b, options_.mesh_size}};
      if (options_.party_line) pieces = options_.party_line(part, other->second, a, b);
      for (const LinePiece& piece : pieces) {
        add_piece(a, piece.end, {part, other->second}, number, piece.max_edge);
        a = piece.end;
      }
    }
  }

  void add_piece(Point2 a, Point2 b, const std::array<RegionIndex, 2>& sides, std::int32_t number,
                 double longest) {
    PlanarGraph& graph = input_.graph;
    graph.segments.push_back({vertex(a), vertex(b)});
    graph.segment_sides.push_back({sides[0].value(), sides[1].value()});
    input_.segments.push_back({{}, {}, sides[0], number});
    if (has_bounds(options_)) graph.segment_max_edge.push_back(longest);
  }

  VertexIndex vertex(Point2 p) { return vertices_.at(p, input_.graph); }

  std::span<const PartOutline> parts_;
  const SurfaceBorders& borders_;
  const GroundMeshOptions& options_;
  Input& input_;
  std::map<Line, RegionIndex, LineBefore> owner_;  // of the side on the left
  SharedVertices own_;
  SharedVertices& vertices_;
};

Input make_input(std::span<const PartOutline> parts, const Domain& domain,
                 const GroundMeshOptions& options) {
  const RegionIndex open_ground(parts.size());
  const SurfaceBorders borders(options.surfaces, open_ground);
  Input input;
  PlanarGraph& graph = input.graph;
  graph.points = domain.outline().outer;
  const std::size_t sides = graph.points.size();
  if (options.surfaces != nullptr)
    for (const VertexIndex v : indices<VertexIndex>(sides)) input.shared.note(graph.points[v], v);
  for (const VertexIndex v : indices<VertexIndex>(sides)) {
    // What is beyond the domain lies on the left of pieces, and on the right of its sides.
    const VertexIndex next = v + 1 < sides ? v + 1 : VertexIndex(0);
    const Point2 p = graph.points[v], q = graph.points[next];
    VertexIndex end = next;
    for (const SurfaceBorders::Piece& piece : borders.pieces(q, p)) {
      const VertexIndex begin = piece.to == p ? v : input.shared.at(piece.to, graph);
      graph.segments.push_back({begin, end});
      graph.segment_sides.push_back({piece.region.value(), kUnmarkedSide});
      input.segments.push_back({{}, {}, kNoRegion, v.value()});
      if (has_bounds(options)) graph.segment_max_edge.push_back(longest_edge(options));
      end = begin;
    }
  }
  std::vector<RegionIndex> first_part;  // of each building
  for (const RegionIndex part : indices<RegionIndex>(parts.size()))
    if (part == 0 || parts[part].building != parts[part - 1].building) first_part.push_back(part);
  // Along the curve, whatever the order of the input: what is near is meshed soon after.
  const HilbertCurve curve(domain.bounds());
  std::vector<std::uint32_t> keys(first_part.size(), 0);
  for (std::size_t f = 0; f < keys.size(); ++f)
    // What is not finite is refused with its ring.
    if (const Ring& outer = parts[first_part[f]].outline->outer;
        !outer.empty() && std::isfinite(outer[0].x) && std::isfinite(outer[0].y))
      keys[f] = curve(outer[0]);
  for (const std::int32_t f : sorted_order(keys)) {
    const auto number_of = static_cast<std::size_t>(f);
    const RegionIndex part = first_part[number_of];
    const RegionIndex end =
        number_of + 1 < first_part.size() ? first_part[number_of + 1] : open_ground;
    if (end > part + 1) {
      PartLines(parts, borders, options, input).add(part, end, domain);
      continue;
    }
    const BuildingIndex building = parts[part].building;
    const Polygon& footprint = *parts[part].outline;
    std::int32_t number = 0;
    const auto add = [&](const Ring& ring, bool is_hole) {
      add_ring(ring, is_hole, building, part, borders, domain, options, number, input);
      number += static_cast<std::int32_t>(ring.size());
    };
    add(footprint.outer, false);
    for (const Ring& hole : footprint.holes) add(hole, true);
  }
  std::int32_t number = 0;
  for (const SurfaceLine& line : borders.inner()) {
    const RegionIndex left = borders.region(line.left), right = borders.region(line.right);
    graph.segments.push_back({input.shared.at(line.from, graph), input.shared.at(line.to, graph)});
    graph.segment_sides.push_back({left.value(), right.value()});
    input.segments.push_back({{}, {}, std::max(left, right), number++});
    if (has_bounds(options)) graph.segment_max_edge.push_back(longest_edge(options));
  }
  return input;
}

// Of each kind, after those of the domain.
std::vector<PatchInfo> patches_of(const Surfaces& surfaces, const Domain& domain) {
  std::vector<PatchInfo> patches;
  if (surfaces.kinds.empty()) return patches;
  auto number = static_cast<std::int32_t>(Patch::kYMax);
  for (const PatchInfo& info : domain.own_patches())
    number = std::max(number, static_cast<std::int32_t>(info.patch));
  for (const std::string_view name : kSurfaceKindNames)
    patches.push_back({static_cast<Patch>(++number), std::string(name), PatchKind::kGround});
  return patches;
}

// Vertices along the curve, those of no triangle left out; triangles by the sum of their vertices'
// new numbers. `segments`: what the input's segments are.
GroundMesh renumber(const Triangulation& source, const std::vector<TaggedEdge>& segments,
                    const Domain& domain) {
  const HilbertCurve curve(domain.bounds());
  std::vector<char> used(source.points.size(), 0);
  for (const auto& t : source.triangles)
    for (const VertexIndex v : t) used[v] = 1;
  std::vector<std::uint32_t> keys(source.points.size());
  for (std::size_t v = 0; v < keys.size(); ++v) keys[v] = curve(source.points[v]);

  GroundMesh mesh;
  mesh.vertices.reserve(source.points.size());
  std::vector<VertexIndex> number(source.points.size(), kNoVertex);
  for (const std::int32_t i : sorted_order(keys)) {
    const VertexIndex v(i);
    if (used[v] == 0) continue;
    number[v] = mesh.vertices.next();
    mesh.vertices.push_back(source.points[v]);
  }
  // By the sum of a triangle's vertex numbers, to be near all three. They come in patches already,
  // so counting and placing stay near as well. A place for about each triangle is fine enough.
  const auto place = [&](const std::array<VertexIndex, 3>& t) {
    std::int64_t sum = 0;
    for (const VertexIndex v : t) sum += number[v].value();
    return static_cast<std::size_t>(sum / 4);
  };
  std::vector<std::int32_t> starts(mesh.vertices.size() * 3 / 4 + 2, 0);
  for (const auto& t : source.triangles) ++starts[place(t) + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  mesh.triangles.resize(source.triangles.size());
  mesh.region.resize(source.triangles.size());
  for (std::size_t t = 0; t < source.triangles.size(); ++t) {
    const auto& old = source.triangles[t];
    const TriangleIndex to(starts[place(old)]++);
    for (std::size_t i = 0; i < 3; ++i) mesh.triangles[to][i] = number[old[i]];
    mesh.region[to] = RegionIndex(source.triangle_regions[t]);
  }
  mesh.tagged_edges.reserve(source.segments.size());
  for (std::size_t s = 0; s < source.segments.size(); ++s) {
    TaggedEdge edge = segments[static_cast<std::size_t>(source.segment_inputs[s])];
    std::tie(edge.low, edge.high) =
        std::minmax({number[source.segments[s][0]], number[source.segments[s][1]]});
    mesh.tagged_edges.push_back(edge);
  }
  std::sort(mesh.tagged_edges.begin(), mesh.tagged_edges.end(),
            [](const TaggedEdge& a, const TaggedEdge& b) {
              return std::pair(a.low, a.high) < std::pair(b.low, b.high);
            });
  mesh.small_input_angles = source.small_input_angles;
  mesh.triangles_below_min_angle = source.triangles_below_min_angle;
  return mesh;
}

}  // namespace

GroundMesh mesh_ground(std::span<const Polygon> footprints, const Domain& domain,
                       const GroundMeshOptions& options, const Progress& progress) {
  std::vector<PartOutline> parts;
  for (const BuildingIndex b : indices<BuildingIndex>(footprints.size()))
    parts.push_back({&footprints[b], b, 0});
  return mesh_ground_parts(parts, domain, options, progress);
}

GroundMesh mesh_ground_parts(std::span<const PartOutline> parts, const Domain& domain,
                             const GroundMeshOptions& options, const Progress& progress) {
  if (!domain.is_meshable())
    throw Error(
        ErrorKind::kInput,
        fmt::format("domain ({}, {}, {}, {}) is empty; give other bounds", domain.bounds().xmin,
                    domain.bounds().ymin, domain.bounds().xmax, domain.bounds().ymax));
  require_sizes(options.mesh_size, options.grading);
  RefineOptions refinement;
  refinement.min_angle_deg = options.min_angle_deg;
  refinement.max_edge = longest_edge(options);
  refinement.elevation = options.elevation;
  IndexedVector<RegionIndex, Region> regions;
  for (const PartOutline& part : parts)
    regions.push_back({RegionKind::kBuildingPart, part.building, part.part, Patch::kRoof});
  regions.push_back({});
  std::vector<PatchInfo> floors;
  if (options.surfaces != nullptr) {
    floors = patches_of(*options.surfaces, domain);
    for (const SurfaceKind kind : options.surfaces->kinds)
      regions.push_back(
          {RegionKind::kOpenGround, kNoBuilding, 0, floors[static_cast<std::size_t>(kind)].patch});
  }
  for (const Region& region : regions)
    refinement.off_terrain.push_back(region.is_building() ? 1 : 0);
  std::optional<SizeField> field;
  if (is_graded(options.mesh_size, options.grading)) {
    std::vector<const Polygon*> outlines;
    for (const PartOutline& part : parts) outlines.push_back(part.outline);
    field.emplace(graded_sizes(outlines, domain.bounds(), options.mesh_size, options.grading));
    refinement.size_field = [&field](Point2 p) { return (*field)(p); };
    refinement.region_max_edge.assign(parts.size(), options.mesh_size);
    // Several times what it will be, as refine() does for one size.
    double squares = 0;
    for (const auto& [size, covered] : field->sizes()) squares += covered / (size * size);
    refinement.max_vertices = static_cast<std::int64_t>(
        2e6 + 200 * static_cast<double>(8 * parts.size()) + std::min(16 * squares, 1e9));
  }
  const Input input = make_input(parts, domain, options);
  GroundMesh mesh = renumber(refine(input.graph, refinement, progress), input.segments, domain);
  mesh.regions = std::move(regions);
  for (const Domain::Side& side : domain.sides()) mesh.sides.push_back(side.patch);
  for (const PatchInfo& info : domain.own_patches()) mesh.patches.add(info);
  for (const PatchInfo& info : floors) mesh.patches.add(info);
  return mesh;
}

}  // namespace tetropolis
