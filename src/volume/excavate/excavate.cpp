#include "excavate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/infinity.h"
#include "core/ragged_builder.h"
#include "core/sort_once.h"
#include "volume/column/rising.h"

namespace tetropolis {

namespace {

constexpr double kWorthwhile = 1e-9;  // metres: what is less adds up from triangle to triangle

/// The triangles outside buildings, by corner.
RaggedArray<TriangleIndex, std::int32_t> triangles_outside(const GroundMesh& mesh) {
  return ragged_from_pairs<TriangleIndex, std::int32_t>(mesh.vertices.size(), [&](const auto& use) {
    for (const TriangleIndex t : mesh.triangles.indices())
      if (!mesh.inside_building(t))
        for (const VertexIndex v : mesh.triangles[t]) use(v, t);
  });
}

/// A set of triangles, to be gone through in ascending order.
class OrderedSet {
 public:
  explicit OrderedSet(std::size_t size) : words_((size + kBits - 1) / kBits, 0) {}

  void insert(TriangleIndex t) {
    const std::size_t i = t;
    words_[i / kBits] |= std::uint64_t{1} << (i % kBits);
  }

  /// Takes out each for visit(triangle), which may insert later ones.
  template <typename Visit>
  void drain(const Visit& visit) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      while (words_[w] != 0) {
        const TriangleIndex t = TriangleIndex(w * kBits) + std::countr_zero(words_[w]);
        words_[w] &= words_[w] - 1;
        visit(t);
      }
    }
  }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> words_;
};

/// The state of one call of excavate: what is where, and where slopes start.
class Excavation {
 public:
  Excavation(const GroundMesh& mesh, std::span<const RegionIndex> building,
             const RoofHeights& roofs, const ExcavationMarks& marks, const ExcavationSlopes& slopes,
             std::vector<double>& ground)
      : mesh_(mesh),
        building_(building),
        roofs_(roofs),
        marks_(marks),
        at_source_(slopes.at_source),
        beyond_(std::max(slopes.at_source, slopes.beyond)),
        ground_(ground),
        start_(ground.size(), kInfinity),
        is_source_(ground.size(), 0),
        has_lowered_(ground.size(), 0) {}

  void start_from_marks();
  void spread();
  ExcavationSources sources() const;

 private:
  bool is_at_marked_roof(VertexIndex v) const {
    return building_[v] != kNoRegion && !marks_.roofs.empty() && marks_.roofs[building_[v]] != 0;
  }
  /// Parts of a building follow each other.
  bool has_one_roof(RegionIndex r) const {
    const auto is_beside = [&](RegionIndex other) {
      return mesh_.regions[other].building == mesh_.regions[r].building;
    };
    return !(r > 0 && is_beside(r - 1)) && !is_beside(r + 1);
  }
  bool is_toe(VertexIndex v) const { return !marks_.toes.empty() && marks_.toes[v] < kInfinity; }
  bool lower(VertexIndex v, VertexIndex a, VertexIndex b);

  const GroundMesh& mesh_;
  std::span<const RegionIndex> building_;
  const RoofHeights& roofs_;
  const ExcavationMarks& marks_;
  double at_source_, beyond_;  ///< Slopes.
  std::vector<double>& ground_;
  std::vector<double> start_;  ///< Of slopes: where marked, or excavated already.
  std::vector<std::uint8_t> is_source_, has_lowered_;
};

void Excavation::start_from_marks() {
  for (const VertexIndex v : indices<VertexIndex>(start_.size())) {
    if (is_at_marked_roof(v)) start_[v] = roofs_.at(building_[v], v);
    if (is_toe(v)) {
      if (marks_.toes[v] < ground_[v] - kWorthwhile) {
        has_lowered_[v] = 1;
        ground_[v] = marks_.toes[v];
      }
      start_[v] = std::min(start_[v], ground_[v]);
    }
    if (start_[v] == kInfinity) continue;
    is_source_[v] = 1;
  }
}

/// Lowers v to the slope from the edge from a to b; whether it was above.
bool Excavation::lower(VertexIndex v, VertexIndex a, VertexIndex b) {
  const double slope = is_source_[a] != 0 || is_source_[b] != 0 ? at_source_ : beyond_;
  const double most = highest_at(mesh_.vertices[v], mesh_.vertices[a], start_[a], mesh_.vertices[b],
                                 start_[b], slope);
  if (!(most < ground_[v] - kWorthwhile)) return false;
  ground_[v] = most;
  start_[v] = std::min(start_[v], most);
  for (const VertexIndex u : {a, b}) has_lowered_[u] |= is_source_[u];
  return true;
}

/// Sweeps over the triangles beside what this sweep or the one before has changed, until none
/// changes.
void Excavation::spread() {
  const RaggedArray<TriangleIndex, std::int32_t> triangles_at = triangles_outside(mesh_);
  OrderedSet now(mesh_.triangles.size()), next(mesh_.triangles.size());
  for (const VertexIndex v : indices<VertexIndex>(is_source_.size()))
    if (is_source_[v] != 0)
      for (const TriangleIndex t : triangles_at[v]) next.insert(t);
  for (bool again = true; again;) {
    again = false;
    std::swap(now, next);
    now.drain([&](TriangleIndex t) {
      const auto corner = [&](std::size_t k) { return mesh_.triangles[t][k % 3]; };
      for (std::size_t i = 0; i < 3; ++i) {
        if (!lower(corner(i), corner(i + 1), corner(i + 2))) continue;
        again = true;
        for (const TriangleIndex beside : triangles_at[corner(i)]) {
          next.insert(beside);
          if (beside > t) now.insert(beside);
        }
      }
    });
  }
}

ExcavationSources Excavation::sources() const {
  ExcavationSources sources;
  for (const VertexIndex v : indices<VertexIndex>(ground_.size())) {
    if (has_lowered_[v] == 0) continue;
    double toe = is_toe(v) ? marks_.toes[v] : kInfinity;
    if (is_at_marked_roof(v)) {
      if (has_one_roof(building_[v]))
        sources.roofs.push_back(mesh_.regions[building_[v]].building);
      else
        toe = std::min(toe, roofs_.at(building_[v], v));
    }
    if (toe < kInfinity) sources.toes.push_back({mesh_.vertices[v].x, mesh_.vertices[v].y, toe});
  }
  sort_once(sources.roofs);
  return sources;
}

}  // namespace

ExcavationSources excavate(const GroundMesh& mesh, std::span<const RegionIndex> building,
                           const RoofHeights& roofs, const ExcavationMarks& marks,
                           const ExcavationSlopes& slopes, std::vector<double>& ground) {
  Excavation excavation(mesh, building, roofs, marks, slopes, ground);
  excavation.start_from_marks();
  excavation.spread();
  return excavation.sources();
}

}  // namespace tetropolis
