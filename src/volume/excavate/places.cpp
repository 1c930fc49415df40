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
  for (const EdgeIndex e : edges.starting_at(v)) visit(edges.vertices[e][1]);
  for (const EdgeIndex e : edges.ends[v]) visit(edges.vertices[e][0]);
}

/// Grows places from their seeds, edge by edge, all at once.
class Flood {
 public:
  explicit Flood(const Columns& columns)
      : edges_(columns.mesh.edges), ring_(columns.mesh.vertex_count(), kFar), place_(ring_.size()) {
    for (const RegionIndex part : columns.plan.lowest_roof)
      building_.push_back(part == kNoRegion ? kNoBuilding
                                            : columns.mesh.ground.regions[part].building);
    for (const VertexIndex v : indices<VertexIndex>(building_.size()))
      if (building_[v] != kNoBuilding) at_building_.emplace_back(building_[v], v);
    std::sort(at_building_.begin(), at_building_.end());
  }

  void start(VertexIndex seed) { claim(seed, seed); }

  void spread() {
    for (now_ = 1; now_ <= kReach; ++now_)
      for (const VertexIndex v : std::exchange(front_, {}))
        for_each_neighbour(edges_, v, [&](VertexIndex u) { claim(u, v); });
  }

  std::vector<std::vector<VertexIndex>> places() {
    std::map<VertexIndex, std::vector<VertexIndex>> by_root;
    for (const VertexIndex v : indices<VertexIndex>(ring_.size()))
      if (ring_[v] < kFar) by_root[place_.root(v)].push_back(v);
    std::vector<std::vector<VertexIndex>> places;
    for (auto& [root, vertices] : by_root) places.push_back(std::move(vertices));
    return places;
  }

 private:
  static constexpr std::int32_t kFar = kReach + 1;

  /// Takes v, and the building it belongs to, for the place of `by`; or joins the two places.
  void claim(VertexIndex v, VertexIndex by) {
    const std::int32_t ring = ring_[v];
    if (ring < kFar) {
      if (ring <= kJoined && now_ <= kJoined) place_.join(v, by);
      return;
    }
    take(v, by);
    const BuildingIndex b = building_[v];
    if (b == kNoBuilding) return;
    for (auto at = std::lower_bound(at_building_.begin(), at_building_.end(),
                                    std::pair(b, VertexIndex{0}));
         at != at_building_.end() && at->first == b; ++at)
      if (at->second != v) take(at->second, by);
  }

  void take(VertexIndex v, VertexIndex by) {
    ring_[v] = now_;
    place_.join(v, by);
    front_.push_back(v);
  }

  const EdgeGraph& edges_;
  std::vector<BuildingIndex> building_;                             // per vertex, or kNoBuilding
  std::vector<std::pair<BuildingIndex, VertexIndex>> at_building_;  // ascending
  std::int32_t now_ = 0;
  std::vector<std::int32_t> ring_;  // per vertex: edges from the nearest seed
  DisjointSets<VertexIndex> place_;
  std::vector<VertexIndex> front_;  // of the ring that grows
};

}  // namespace

std::vector<std::vector<VertexIndex>> find_places(const Columns& columns,
                                                  std::span<const std::uint8_t> seeds) {
  Flood flood(columns);
  for (const VertexIndex v : indices<VertexIndex>(seeds.size()))
    if (seeds[v] != 0) flood.start(v);
  flood.spread();
  return flood.places();
}

Cutout cut_out(const Columns& columns, std::span<const VertexIndex> vertices) {
  const GroundMesh& whole = columns.mesh.ground;
  const auto local = [&](VertexIndex v) {
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), v);
    return found != vertices.end() && *found == v ? VertexIndex(found - vertices.begin())
                                                  : kNoVertex;
  };
  Cutout cutout;
  GroundMesh ground;
  ground.regions = whole.regions;
  ground.patches = whole.patches;
  std::vector<std::uint8_t> on_rim(vertices.size(), 0);
  for (const TriangleIndex t : triangles_around(columns.mesh.edges, vertices)) {
    std::array<VertexIndex, 3> corners = whole.triangles[t];
    for (VertexIndex& v : corners) v = local(v);
    if (std::find(corners.begin(), corners.end(), kNoVertex) == corners.end()) {
      ground.triangles.push_back(corners);
      ground.region.push_back(whole.region[t]);
    } else {
      for (const VertexIndex v : corners)
        if (v != kNoVertex) on_rim[v] = 1;
    }
  }
  cutout.fixed = on_rim;
  for (const auto& corners : ground.triangles)
    for (const VertexIndex v : corners)
      if (on_rim[v] != 0)
        for (const VertexIndex u : corners) cutout.fixed[u] = 1;
  ColumnPlan& plan = cutout.columns.plan;
  const RoofHeights& roofs = columns.plan.roofs;
  plan.roofs.flat = roofs.flat;
  plan.layers = columns.plan.layers;
  for (const VertexIndex v : vertices) {
    ground.vertices.push_back(whole.vertices[v]);
    plan.terrain.push_back(columns.plan.terrain[v]);
    plan.ground.push_back(columns.plan.ground[v]);
    plan.lowest_roof.push_back(columns.plan.lowest_roof[v]);
    plan.top.push_back(columns.plan.top[v]);
    plan.spacing.push_back(columns.plan.spacing[v]);
    plan.rise.push_back(columns.plan.rise[v]);
    if (!columns.plan.lift.empty()) plan.lift.push_back(columns.plan.lift[v]);
    if (!roofs.all_flat()) plan.roofs.sloped.push_back(roofs.sloped[v]);
  }
  cutout.columns.mesh = gather_columns(vertices.size(), [&](VertexIndex v) {
    return ColumnOf{&columns.mesh, vertices[v]};
  });
  cutout.columns.mesh.edges = build_edge_graph(ground);
  cutout.columns.mesh.ground = std::move(ground);
  return cutout;
}

std::vector<VertexIndex> different_columns(const ColumnMesh& a, const ColumnMesh& b) {
  std::vector<VertexIndex> different;
  for (const VertexIndex v : indices<VertexIndex>(a.first.size() - 1))
    if (!std::ranges::equal(a.floors_at(v), b.floors_at(v)) ||
        a.first[v + 1] - a.first[v] != b.first[v + 1] - b.first[v] ||
        !std::equal(a.z.data() + a.first[v], a.z.data() + a.first[v + 1], b.z.data() + b.first[v]))
      different.push_back(v);
  return different;
}

}  // namespace tetropolis
