#include "levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/parallel.h"
#include "core/sort_once.h"

namespace tetropolis {

namespace {

/// Levels rise at least so much for every metre of elevation.
constexpr double kLeastRise = 0.2;

/// Segments on the two sides of a roof's edge are to be apart by this share of the shorter one.
constexpr double kMargin = 0.1;

/// Passes over the edges of a city's roofs in search of levels.
constexpr int kMostSweeps = 400;

/// Passes that spread levels over roofs.
constexpr int kSpreadSweeps = 40;

/// The floors of a column by elevation, each once: positions, elevations, levels; then its top.
struct Knots {
  std::vector<std::int32_t> position;
  std::vector<double> z, level;
  bool is_fixed = false;  ///< The lowest is open ground, whose level is its elevation.

  std::size_t at(std::int32_t floor) const {
    return static_cast<std::size_t>(std::lower_bound(position.begin(), position.end(), floor) -
                                    position.begin());
  }
  /// Of a node in the piece above or below a floor.
  double level_of(const double* nodes, std::int32_t node) const {
    std::size_t k = 1;
    while (position[k] < node) ++k;
    const double share = (nodes[node] - z[k - 1]) / (z[k] - z[k - 1]);
    return level[k - 1] + (level[k] - level[k - 1]) * share;
  }
  /// Moves knot k to `to`, or as near as the ends and the least rise allow; others give way.
  void move(std::size_t k, double to) {
    const std::size_t top = z.size() - 1;
    to = std::min(to, level[top] - kLeastRise * (z[top] - z[k]));
    if (is_fixed) to = std::max(to, level[0] + kLeastRise * (z[k] - z[0]));
    level[k] = to;
    for (std::size_t i = k; i-- > (is_fixed ? 1U : 0U);)
      level[i] = std::min(level[i], level[i + 1] - kLeastRise * (z[i + 1] - z[i]));
    for (std::size_t i = k + 1; i < top; ++i)
      level[i] = std::max(level[i], level[i - 1] + kLeastRise * (z[i] - z[i - 1]));
  }
};

/// The search, over the columns at the edges of buildings that have roofs that are not horizontal.
class LevelSearch {
 public:
  LevelSearch(const ColumnMesh& mesh, const RoofHeights& roofs);
  void relax();
  void spread(const RoofHeights& roofs);
  std::int64_t close(RoofHeights& roofs) const;
  void store(RoofHeights& roofs) const;

 private:
  struct Edge {
    std::array<std::size_t, 2> column;                      // of knots_
    std::array<std::int32_t, 2> low, high;                  // positions of floors
    std::array<RegionIndex, 2> part{kNoRegion, kNoRegion};  // lower and upper, for closing
  };

  double key(const Edge& edge, std::size_t i, std::int32_t node) const {
    const Knots& knots = knots_[edge.column[i]];
    const double* const z = mesh_.z.data() + mesh_.first[vertices_[edge.column[i]]];
    return knots.level_of(z, node) + knots.level_of(z, node + 1);
  }
  /// How far, in levels, the upper floor at end i is too high for that at the other end; at most 0
  /// if it is not.
  double excess(const Edge& edge, std::size_t i) const;

  const ColumnMesh& mesh_;
  std::vector<VertexIndex> vertices_;  // ascending
  std::vector<Knots> knots_;           // of each of them
  std::vector<Edge> edges_;
  std::vector<std::pair<VertexIndex, double>> shifts_;  // of roofs that are on none of these edges
};

LevelSearch::LevelSearch(const ColumnMesh& mesh, const RoofHeights& roofs) : mesh_(mesh) {
  const EdgeGraph& graph = mesh.edges;
  std::vector<std::uint8_t> is_shaped(mesh.ground.regions.size(), 0);
  for (const RoofFloor& floor : roofs.sloped.values) is_shaped[floor.part] = 1;
  const auto is_shaped_step = [&](EdgeIndex e) {
    if (!is_step(mesh, e)) return false;
    const auto [t0, t1] = graph.triangles[e];
    return is_shaped[mesh.ground.region[t0]] != 0 || is_shaped[mesh.ground.region[t1]] != 0;
  };
  std::vector<EdgeIndex> steps;
  for (const EdgeIndex e : graph.vertices.indices())
    if (is_shaped_step(e)) {
      steps.push_back(e);
      for (const VertexIndex v : graph.vertices[e]) vertices_.push_back(v);
    }
  sort_once(vertices_);
  for (const VertexIndex v : vertices_) {
    Knots knots;
    const std::span<const std::int32_t> floors = mesh.floors_at(v);
    knots.position.assign(floors.begin(), floors.end());
    knots.position.push_back(static_cast<std::int32_t>((mesh.top(v) - mesh.first[v])));
    sort_once(knots.position);
    for (const std::int32_t p : knots.position) knots.z.push_back(mesh.z[mesh.first[v] + p]);
    knots.level = knots.z;
    for (const RegionIndex r : mesh.regions[v])
      knots.is_fixed |= !mesh.ground.regions[r].is_building();
    knots_.push_back(std::move(knots));
  }
  for (const EdgeIndex e : steps) {
    Edge edge;
    std::array<RegionIndex, 2> regions;
    for (std::size_t s = 0; s < 2; ++s) regions[s] = mesh.ground.region[graph.triangles[e][s]];
    double rise = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const VertexIndex v = graph.vertices[e][i];
      edge.column[i] = static_cast<std::size_t>(
          std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
      const NodeIndex a = mesh.floor(regions[0], v), b = mesh.floor(regions[1], v);
      edge.low[i] = static_cast<std::int32_t>(std::min(a, b) - mesh.first[v]);
      edge.high[i] = static_cast<std::int32_t>(std::max(a, b) - mesh.first[v]);
      rise += mesh.z[b] - mesh.z[a];
    }
    edge.part = rise > 0 ? regions : std::array{regions[1], regions[0]};
    if (edge.low != edge.high) edges_.push_back(edge);
  }
}

double LevelSearch::excess(const Edge& edge, std::size_t i) const {
  const std::size_t j = 1 - i;
  if (edge.low[i] == edge.high[i]) return 0;  // nothing below
  const Knots &own = knots_[edge.column[i]], &other = knots_[edge.column[j]];
  const double below = key(edge, i, edge.high[i] - 1), above = key(edge, j, edge.high[j]);
  const double length_below = own.level[own.at(edge.high[i])] * 2 - below;
  const double length_above = above - other.level[other.at(edge.high[j])] * 2;
  return (below - above + kMargin * std::min(length_below, length_above)) / 2;
}

void LevelSearch::relax() {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool changed = false;
    for (const Edge& edge : edges_)
      for (std::size_t i = 0; i < 2; ++i) {
        if (!(excess(edge, i) > 0)) continue;
        Knots &own = knots_[edge.column[i]], &other = knots_[edge.column[1 - i]];
        const std::size_t k = own.at(edge.high[i]), l = other.at(edge.high[1 - i]);
        const double apart = own.level[k] - other.level[l];
        if (!(apart > 0)) continue;
        own.move(k, own.level[k] - apart / 8);
        other.move(l, other.level[l] + apart / 8);
        changed = true;
      }
    if (!changed) return;
  }
}

/// Roofs away from their edges take the mean of the shifts around them, so that fronts lean with
/// the roof and neighbouring columns do not shear.
void LevelSearch::spread(const RoofHeights& roofs) {
  std::vector<std::uint8_t> at_step(mesh_.vertex_count(), 0);
  std::vector<double> shift(mesh_.vertex_count(), 0.0);
  for (const Edge& edge : edges_)
    for (const std::size_t c : edge.column) at_step[vertices_[c]] = 1;
  std::vector<VertexIndex> free;
  bool is_shifted = false;
  for (std::size_t c = 0; c < vertices_.size(); ++c) {
    const VertexIndex v = vertices_[c];
    const Knots& knots = knots_[c];
    // Of the highest roof, which is next to the air above all of them.
    const std::size_t k = knots.z.size() - 2;
    shift[v] = knots.level[k] - knots.z[k];
    is_shifted |= shift[v] != 0;
  }
  if (!is_shifted) return;
  for (const VertexIndex v : mesh_.ground.vertices.indices())
    if (at_step[v] == 0 && !roofs.sloped_at(v).empty()) free.push_back(v);
  for (int sweep = 0; sweep < kSpreadSweeps; ++sweep)
    for (const VertexIndex v : free) {
      double sum = 0;
      int count = 0;
      for (const EdgeIndex e : mesh_.edges.starting_at(v)) {
        sum += shift[mesh_.edges.vertices[e][1]];
        ++count;
      }
      for (const EdgeIndex e : mesh_.edges.ends[v]) {
        sum += shift[mesh_.edges.vertices[e][0]];
        ++count;
      }
      shift[v] = sum / count;
    }
  for (const VertexIndex v : free) shifts_.emplace_back(v, shift[v]);
}

std::int64_t LevelSearch::close(RoofHeights& roofs) const {
  std::int64_t closed = 0;
  for (const Edge& edge : edges_) {
    const auto fails = [&](std::size_t i) {
      if (edge.low[i] == edge.high[i]) return false;
      return !climbs_first(key(edge, i, edge.high[i] - 1), vertices_[edge.column[i]],
                           key(edge, 1 - i, edge.high[1 - i]), vertices_[edge.column[1 - i]]);
    };
    if (!fails(0) && !fails(1)) continue;
    if (!mesh_.ground.regions[edge.part[0]].is_building()) continue;
    for (const std::size_t c : edge.column) {
      const VertexIndex v = vertices_[c];
      const double to = roofs.at(edge.part[1], v);
      const double from = roofs.at(edge.part[0], v);
      for (RoofFloor& floor : roofs.sloped[v])
        if (floor.z == from) floor.z = floor.level = to;
    }
    ++closed;
  }
  return closed;
}

void LevelSearch::store(RoofHeights& roofs) const {
  for (std::size_t c = 0; c < vertices_.size(); ++c) {
    const VertexIndex v = vertices_[c];
    for (RoofFloor& floor : roofs.sloped[v]) {
      const auto position = static_cast<std::int32_t>(mesh_.floor(floor.part, v) - mesh_.first[v]);
      floor.level = knots_[c].level[knots_[c].at(position)];
    }
  }
  for (const auto& [v, shift] : shifts_)
    for (RoofFloor& floor : roofs.sloped[v]) floor.level = floor.z + shift;
}

LevelledColumn column_of(const ColumnMesh& mesh, VertexIndex v) {
  const double* const level = mesh.climbing().data();
  return {v, {level + mesh.first[v], level + mesh.first[v + 1]}, mesh.floors_at(v)};
}

}  // namespace

void write_levels(std::span<const double> z, std::span<const std::int32_t> floors,
                  std::span<const double> floor_levels, double* level) {
  const auto top = static_cast<std::int32_t>(z.size()) - 1;
  std::int32_t low = top;
  for (const std::int32_t floor : floors) low = std::min(low, floor);
  const auto level_at = [&](std::int32_t position) {
    for (std::size_t k = 0; k < floors.size(); ++k)
      if (floors[k] == position) return floor_levels[k];
    return z[static_cast<std::size_t>(top)];
  };
  while (low < top) {
    std::int32_t high = top;
    for (const std::int32_t floor : floors)
      if (floor > low) high = std::min(high, floor);
    const double z0 = z[static_cast<std::size_t>(low)], z1 = z[static_cast<std::size_t>(high)];
    const double l0 = level_at(low), l1 = level_at(high);
    const bool same = l0 == z0 && l1 == z1;
    for (std::int32_t n = low; n < high; ++n) {
      const double here = z[static_cast<std::size_t>(n)];
      level[n] = same ? here : l0 + (l1 - l0) * ((here - z0) / (z1 - z0));
    }
    level[high] = l1;
    low = high;
  }
}

bool passes(const StepEnds& ends) {
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t j = 1 - i;
    if (ends.low[i] == ends.high[i] || ends.high[j] == ends.last[j]) continue;
    const double below = climbing_key(ends.level[i], NodeIndex(ends.high[i] - 1));
    const double above = climbing_key(ends.level[j], NodeIndex(ends.high[j]));
    if (!climbs_first(below, ends.vertex[i], above, ends.vertex[j])) return false;
  }
  return true;
}

bool passes(const ColumnMesh& mesh, EdgeIndex e) {
  if (!is_step(mesh, e)) return true;
  const auto [a, b] = mesh.edges.vertices[e];
  return passes(step_ends(mesh, e, {column_of(mesh, a), column_of(mesh, b)}));
}

bool passes_everywhere(const ColumnMesh& mesh) {
  const auto edges = mesh.edges.vertices.indices();
  return mesh.levels.empty() ||
         std::all_of(edges.begin(), edges.end(), [&](EdgeIndex e) { return passes(mesh, e); });
}

std::vector<BuildingIndex> missed_buildings(const ColumnMesh& mesh) {
  std::vector<BuildingIndex> missed;
  if (mesh.levels.empty()) return missed;
  for (const EdgeIndex e : mesh.edges.vertices.indices()) {
    if (passes(mesh, e)) continue;
    for (const TriangleIndex t : mesh.edges.triangles[e])
      if (const Region& region = mesh.ground.region_of(t); region.is_building())
        missed.push_back(region.building);
  }
  sort_once(missed);
  return missed;
}

std::int64_t find_levels(ColumnMesh& mesh, RoofHeights& roofs) {
  LevelSearch search(mesh, roofs);
  search.relax();
  search.spread(roofs);
  const std::int64_t closed = search.close(roofs);
  if (closed > 0) return closed;
  search.store(roofs);
  set_levels(mesh, roofs);
  return 0;
}

void set_levels(ColumnMesh& mesh, const RoofHeights& roofs) {
  if (roofs.all_flat()) return;
  mesh.floor_levels.resize(mesh.floors.size());
  mesh.levels.resize(mesh.z.size());
  parallel_chunks(mesh.vertex_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (const VertexIndex v : indices<VertexIndex>(begin, end)) {
      const std::span<const std::int32_t> floors = mesh.floors_at(v);
      const std::span<double> levels = mesh.floor_levels_at(v);
      const std::span<const double> z{mesh.z.data() + mesh.first[v],
                                      mesh.z.data() + mesh.first[v + 1]};
      for (std::size_t k = 0; k < floors.size(); ++k)
        levels[k] = z[static_cast<std::size_t>(floors[k])];
      for (const RoofFloor& floor : roofs.sloped_at(v))
        levels[mesh.place(floor.part, v)] = floor.level;
      write_levels(z, floors, levels, mesh.levels.data() + mesh.first[v]);
    }
  });
}

}  // namespace tetropolis
