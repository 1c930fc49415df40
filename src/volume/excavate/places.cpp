#include "places.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <utility>

#include "core/disjoint_sets.h"

namespace tetropolis {

namespace {

constexpr std::int32_t kReach = 16;  // edges from a seed to the end of its place
constexpr std::int32_t kJoined = 4;  // edges from two seeds to where they meet, in one place

/// Calls visit(u) for the vertices with an edge to v.
template <typename Visit>
void for_each_neighbour(const EdgeGraph& edges, VertexIndex v, const Visit& visit) {
  const auto i = static_cast<std::size_t>(v);
  for (EdgeIndex e = edges.starts[i]; e < edges.starts[i + 1]; ++e)
    visit(edges.vertices[static_cast<std::size_t>(e)][1]);
  for (std::int32_t k = edges.end_offsets[i]; k < edges.end_offsets[i + 1]; ++k)
    visit(edges.vertices[static_cast<std::size_t>(edges.ends[static_cast<std::size_t>(k)])][0]);
}

/// Grows places from their seeds, edge by edge, all at once.
class Flood {
 public:
  explicit Flood(const Columns& columns)
      : edges_(columns.mesh.edges), ring_(columns.mesh.vertex_count(), kFar), place_(ring_.size()) {
    for (const RegionIndex part : columns.plan.lowest_roof)
      building_.push_back(
          part == kNoRegion ? kNoBuilding
                            : columns.mesh.ground.regions[static_cast<std::size_t>(part)].building);
    for (std::size_t v = 0; v < building_.size(); ++v)
      if (building_[v] != kNoBuilding)
        at_building_.emplace_back(building_[v], static_cast<VertexIndex>(v));
    std::sort(at_building_.begin(), at_building_.end());
  }

  void start(VertexIndex seed) { claim(seed, seed); }

  void spread() {
    for (now_ = 1; now_ <= kReach; ++now_)
      for (const VertexIndex v : std::exchange(front_, {}))
        for_each_neighbour(edges_, v, [&](VertexIndex u) { claim(u, v); });
  }

  std::vector<std::vector<VertexIndex>> places() {
    std::map<std::int32_t, std::vector<VertexIndex>> by_root;
    for (std::size_t v = 0; v < ring_.size(); ++v)
      if (ring_[v] < kFar) {
        const auto vertex = static_cast<VertexIndex>(v);
        by_root[place_.root(vertex)].push_back(vertex);
      }
    std::vector<std::vector<VertexIndex>> places;
    for (auto& [root, vertices] : by_root) places.push_back(std::move(vertices));
    return places;
  }

 private:
  static constexpr std::int32_t kFar = kReach + 1;

  /// Takes v, and the building it belongs to, for the place of `by`; or joins the two places.
  void claim(VertexIndex v, VertexIndex by) {
    const std::int32_t ring = ring_[static_cast<std::size_t>(v)];
    if (ring < kFar) {
      if (ring <= kJoined && now_ <= kJoined) place_.join(v, by);
      return;
    }
    take(v, by);
    const BuildingIndex b = building_[static_cast<std::size_t>(v)];
    if (b == kNoBuilding) return;
    for (auto at = std::lower_bound(at_building_.begin(), at_building_.end(),
                                    std::pair(b, VertexIndex{0}));
         at != at_building_.end() && at->first == b; ++at)
      if (at->second != v) take(at->second, by);
  }

  void take(VertexIndex v, VertexIndex by) {
    ring_[static_cast<std::size_t>(v)] = now_;
    place_.join(v, by);
    front_.push_back(v);
  }

  const EdgeGraph& edges_;
  std::vector<BuildingIndex> building_;                             // per vertex, or kNoBuilding
  std::vector<std::pair<BuildingIndex, VertexIndex>> at_building_;  // ascending
  std::int32_t now_ = 0;
  std::vector<std::int32_t> ring_;  // per vertex: edges from the nearest seed
  DisjointSets place_;
  std::vector<VertexIndex> front_;  // of the ring that grows
};

}  // namespace

std::vector<std::vector<VertexIndex>> find_places(const Columns& columns,
                                                  std::span<const std::uint8_t> seeds) {
  Flood flood(columns);
  for (std::size_t v = 0; v < seeds.size(); ++v)
    if (seeds[v] != 0) flood.start(static_cast<VertexIndex>(v));
  flood.spread();
  return flood.places();
}

Cutout cut_out(const Columns& columns, std::span<const VertexIndex> vertices) {
  const GroundMesh& whole = columns.mesh.ground;
  constexpr VertexIndex kNotHere = -1;
  const auto local = [&](VertexIndex v) {
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), v);
    return found != vertices.end() && *found == v
               ? static_cast<VertexIndex>(found - vertices.begin())
               : kNotHere;
  };
  Cutout cutout;
  GroundMesh ground;
  ground.regions = whole.regions;
  std::vector<std::uint8_t> on_rim(vertices.size(), 0);
  for (const TriangleIndex t : triangles_around(columns.mesh.edges, vertices)) {
    std::array<VertexIndex, 3> corners = whole.triangles[static_cast<std::size_t>(t)];
    for (VertexIndex& v : corners) v = local(v);
    if (std::find(corners.begin(), corners.end(), kNotHere) == corners.end()) {
      ground.triangles.push_back(corners);
      ground.region.push_back(whole.region[static_cast<std::size_t>(t)]);
    } else {
      for (const VertexIndex v : corners)
        if (v != kNotHere) on_rim[static_cast<std::size_t>(v)] = 1;
    }
  }
  cutout.fixed = on_rim;
  for (const auto& corners : ground.triangles)
    for (const VertexIndex v : corners)
      if (on_rim[static_cast<std::size_t>(v)] != 0)
        for (const VertexIndex u : corners) cutout.fixed[static_cast<std::size_t>(u)] = 1;
  ColumnPlan& plan = cutout.columns.plan;
  plan.roofs = columns.plan.roofs;
  plan.layers = columns.plan.layers;
  for (const VertexIndex vertex : vertices) {
    const auto v = static_cast<std::size_t>(vertex);
    ground.vertices.push_back(whole.vertices[v]);
    plan.ground.push_back(columns.plan.ground[v]);
    plan.lowest_roof.push_back(columns.plan.lowest_roof[v]);
    plan.top.push_back(columns.plan.top[v]);
    plan.spacing.push_back(columns.plan.spacing[v]);
    plan.rise.push_back(columns.plan.rise[v]);
  }
  cutout.columns.mesh = gather_columns(vertices.size(), [&](std::size_t v) {
    return ColumnOf{&columns.mesh, static_cast<std::size_t>(vertices[v])};
  });
  cutout.columns.mesh.edges = build_edge_graph(ground);
  cutout.columns.mesh.ground = std::move(ground);
  return cutout;
}

std::vector<VertexIndex> different_columns(const ColumnMesh& a, const ColumnMesh& b) {
  std::vector<VertexIndex> different;
  for (std::size_t v = 0; v + 1 < a.first.size(); ++v)
    if (!std::ranges::equal(a.floors_at(v), b.floors_at(v)) ||
        a.first[v + 1] - a.first[v] != b.first[v + 1] - b.first[v] ||
        !std::equal(a.z.begin() + a.first[v], a.z.begin() + a.first[v + 1],
                    b.z.begin() + b.first[v]))
      different.push_back(static_cast<VertexIndex>(v));
  return different;
}

}  // namespace tetropolis
