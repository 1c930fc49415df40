#include "excavate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/infinity.h"
#include "core/sort_once.h"
#include "volume/column/rising.h"

namespace tetropolis {

namespace {

constexpr double kWorthwhile = 1e-9;  // metres: what is less adds up from triangle to triangle

/// The triangles outside buildings, by corner.
class TrianglesAt {
 public:
  explicit TrianglesAt(const GroundMesh& mesh) : ends_(mesh.vertices.size() + 1, 0) {
    const auto for_each_corner = [&](const auto& visit) {
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (!mesh.inside_building(t))
          for (const VertexIndex v : mesh.triangles[t]) visit(static_cast<std::size_t>(v), t);
    };
    for_each_corner([&](std::size_t v, std::size_t) { ++ends_[v + 1]; });
    std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
    triangles_.resize(static_cast<std::size_t>(ends_.back()));
    // Each vertex's end moves from that of the one before it to its own.
    for_each_corner([&](std::size_t v, std::size_t t) {
      triangles_[static_cast<std::size_t>(ends_[v]++)] = static_cast<TriangleIndex>(t);
    });
  }
  std::span<const TriangleIndex> operator()(std::size_t v) const {
    const std::int32_t begin = v == 0 ? 0 : ends_[v - 1];
    return {triangles_.data() + begin, triangles_.data() + ends_[v]};
  }

 private:
  std::vector<std::int32_t> ends_;
  std::vector<TriangleIndex> triangles_;
};

/// A set of numbers, to be gone through in ascending order.
class OrderedSet {
 public:
  explicit OrderedSet(std::size_t size) : words_((size + kBits - 1) / kBits, 0) {}

  void insert(std::size_t i) { words_[i / kBits] |= std::uint64_t{1} << (i % kBits); }

  /// Takes out each number for visit(number), which may insert greater ones.
  template <typename Visit>
  void drain(const Visit& visit) {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      while (words_[w] != 0) {
        const auto i = w * kBits + static_cast<std::size_t>(std::countr_zero(words_[w]));
        words_[w] &= words_[w] - 1;
        visit(i);
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
             std::span<const double> roofs, const ExcavationMarks& marks,
             const ExcavationSlopes& slopes, std::vector<double>& ground)
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
  bool is_at_marked_roof(std::size_t v) const {
    return building_[v] != kNoRegion && !marks_.roofs.empty() &&
           marks_.roofs[static_cast<std::size_t>(building_[v])] != 0;
  }
  bool is_toe(std::size_t v) const { return !marks_.toes.empty() && marks_.toes[v] < kInfinity; }
  bool lower(std::size_t v, std::size_t a, std::size_t b);

  const GroundMesh& mesh_;
  std::span<const RegionIndex> building_;
  std::span<const double> roofs_;
  const ExcavationMarks& marks_;
  double at_source_, beyond_;  ///< Slopes.
  std::vector<double>& ground_;
  std::vector<double> start_;  ///< Of slopes: where marked, or excavated already.
  std::vector<std::uint8_t> is_source_, has_lowered_;
};

void Excavation::start_from_marks() {
  for (std::size_t v = 0; v < start_.size(); ++v) {
    if (is_at_marked_roof(v)) start_[v] = roofs_[static_cast<std::size_t>(building_[v])];
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
bool Excavation::lower(std::size_t v, std::size_t a, std::size_t b) {
  const double slope = is_source_[a] != 0 || is_source_[b] != 0 ? at_source_ : beyond_;
  const double most = highest_at(mesh_.vertices[v], mesh_.vertices[a], start_[a], mesh_.vertices[b],
                                 start_[b], slope);
  if (!(most < ground_[v] - kWorthwhile)) return false;
  ground_[v] = most;
  start_[v] = std::min(start_[v], most);
  for (const std::size_t u : {a, b}) has_lowered_[u] |= is_source_[u];
  return true;
}

/// Sweeps over the triangles beside what this sweep or the one before has changed, until none
/// changes.
void Excavation::spread() {
  const TrianglesAt triangles_at(mesh_);
  OrderedSet now(mesh_.triangles.size()), next(mesh_.triangles.size());
  for (std::size_t v = 0; v < is_source_.size(); ++v)
    if (is_source_[v] != 0)
      for (const TriangleIndex t : triangles_at(v)) next.insert(static_cast<std::size_t>(t));
  for (bool again = true; again;) {
    again = false;
    std::swap(now, next);
    now.drain([&](std::size_t t) {
      const auto corner = [&](std::size_t k) {
        return static_cast<std::size_t>(mesh_.triangles[t][k % 3]);
      };
      for (std::size_t i = 0; i < 3; ++i) {
        if (!lower(corner(i), corner(i + 1), corner(i + 2))) continue;
        again = true;
        for (const TriangleIndex beside : triangles_at(corner(i))) {
          const auto b = static_cast<std::size_t>(beside);
          next.insert(b);
          if (b > t) now.insert(b);
        }
      }
    });
  }
}

ExcavationSources Excavation::sources() const {
  ExcavationSources sources;
  for (std::size_t v = 0; v < ground_.size(); ++v) {
    if (has_lowered_[v] == 0) continue;
    if (is_toe(v))
      sources.toes.push_back({mesh_.vertices[v].x, mesh_.vertices[v].y, marks_.toes[v]});
    if (is_at_marked_roof(v))
      sources.roofs.push_back(mesh_.regions[static_cast<std::size_t>(building_[v])].building);
  }
  sort_once(sources.roofs);
  return sources;
}

}  // namespace

ExcavationSources excavate(const GroundMesh& mesh, std::span<const RegionIndex> building,
                           std::span<const double> roofs, const ExcavationMarks& marks,
                           const ExcavationSlopes& slopes, std::vector<double>& ground) {
  Excavation excavation(mesh, building, roofs, marks, slopes, ground);
  excavation.start_from_marks();
  excavation.spread();
  return excavation.sources();
}

}  // namespace tetropolis
