#include "page_upper.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "page_columns.h"

namespace tetropolis {

namespace {

/// A node of the front: those of a column follow each other, from the lid upwards. A step is told
/// by the one that it leaves.
using Place = std::size_t;

/// The steps: one to each fan.
class Steps {
 public:
  explicit Steps(const ColumnMesh& mesh) : mesh_(mesh) {
    const UpperMesh& upper = mesh.upper;
    std::vector<std::size_t> nodes(mesh.vertex_count(), 1);
    for (const VertexIndex v : upper.vertex) ++nodes[v];
    first_.push_back(0);
    for (const std::size_t count : nodes) first_.push_back(first_.back() + count);
    for (const VertexIndex v : mesh.ground.vertices.indices()) vertex_.resize(first_[v + 1], v);
    fan_.assign(vertex_.size(), kNoFan);
    for (std::size_t f = 0; f + 1 < upper.fans.size(); ++f)
      fan_[place(upper.fans[f].node)] = static_cast<std::uint32_t>(f);
  }

  std::size_t size() const { return vertex_.size(); }
  Place first(VertexIndex v) const { return first_[v]; }
  Place last(VertexIndex v) const { return first_[v + 1] - 1; }
  VertexIndex vertex(Place p) const { return vertex_[p]; }
  bool is_on_lid(Place p) const { return p == first_[vertex_[p]]; }
  bool is_step(Place p) const { return fan_[p] != kNoFan; }
  bool is_end(Place p) const { return is_step(p) && p == last(vertex_[p]); }

  Place place(UpperPlace p) const {
    const std::size_t columns = mesh_.vertex_count();
    if (p < columns) return first_[p];
    return p - columns + std::size_t{mesh_.upper.vertex[p - columns]} + 1;
  }

  /// Of the cells that the step makes.
  std::span<const UpperPlace> others(Place p) const {
    const auto& fans = mesh_.upper.fans;
    const std::size_t begin = fans[fan_[p]].other, end = fans[fan_[p] + 1].other;
    return std::span(mesh_.upper.others).subspan(begin, end - begin);
  }

  /// The places around it when it is taken, some twice.
  template <typename Visit>
  void for_each_around(Place p, const Visit& visit) const {
    if (!is_step(p)) return;
    for (const UpperPlace other : others(p)) visit(place(other));
  }

 private:
  static constexpr std::uint32_t kNoFan = 0xffffffff;
  const ColumnMesh& mesh_;
  std::vector<Place> first_;         // per vertex, and one more
  std::vector<VertexIndex> vertex_;  // per place
  std::vector<std::uint32_t> fan_;   // per place
};

/// The elevations of places, as the reader has them.
std::vector<std::int32_t> add_rises(const ColumnMesh& mesh, const Steps& steps,
                                    std::span<const double> z, PageUpper& page) {
  std::vector<std::int32_t> read(steps.size());
  std::int32_t top = 0;
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const NodeIndex lid = mesh.top(v);
    auto before = static_cast<std::int32_t>(z[lid.value() - 1]);
    read[steps.first(v)] = static_cast<std::int32_t>(z[lid]);
    for (Place p = steps.first(v); p < steps.last(v); ++p) {
      const bool is_last = p + 1 == steps.last(v) && !steps.is_end(p + 1);
      const std::int32_t z_up = page_steps(mesh.upper.z[p - std::size_t{v}]);
      const std::int32_t even = is_last ? top : 2 * read[p] - before;
      page.rise.push_back(z_up - even);
      read[p + 1] = z_up;
      if (is_last) top = z_up;
      before = read[p];
    }
  }
  return read;
}

/// When the reader has a step be taken.
struct Due {
  std::int64_t key;   // twice an elevation
  std::int64_t unit;  // of waits
};

/// As long as nothing is told.
Due due(const ColumnMesh& mesh, const Steps& steps, std::span<const double> z,
        std::span<const std::int32_t> read, Place p) {
  std::int64_t ahead = 0;  // of the middle, twice
  if (!steps.is_end(p)) {
    ahead = read[p + 1] - read[p];
  } else {
    const VertexIndex v = steps.vertex(p);
    const std::int32_t below =
        steps.is_on_lid(p) ? static_cast<std::int32_t>(z[mesh.top(v) - 1]) : read[p - 1];
    ahead = (read[p] - below) * std::int64_t{9} / 5;
  }
  return {std::int64_t{2} * read[p] + ahead, std::max<std::int64_t>(1, ahead / 8)};
}

/// Returns the keys of steps, by place. Each follows those that have made the places around it, and
/// comes before those that leave them.
std::vector<std::int64_t> add_waits(const ColumnMesh& mesh, const Steps& steps,
                                    std::span<const double> z, std::span<const std::int32_t> read,
                                    PageUpper& page) {
  // By place: the steps it is around of.
  std::vector<std::uint32_t> begin(steps.size() + 1, 0);
  for (Place p = 0; p < steps.size(); ++p)
    steps.for_each_around(p, [&](Place q) { ++begin[q + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> around(begin.back());
  std::vector<std::uint32_t> filled(begin.begin(), begin.end() - 1);
  std::vector<std::uint32_t> before(steps.size(), 0);  // how many are to be taken before
  for (Place p = 0; p < steps.size(); ++p) {
    steps.for_each_around(p, [&](Place q) {
      around[filled[q]++] = static_cast<std::uint32_t>(p);
      if (!steps.is_on_lid(q)) ++before[p];
    });
    if (!steps.is_on_lid(p)) ++before[p];
    before[p] += begin[p + 1] - begin[p];
  }

  std::vector<std::int64_t> key(steps.size(), 0);  // the least that it may be
  std::vector<std::int32_t> wait(steps.size(), 0);
  std::vector<Place> ready;
  for (Place p = 0; p < steps.size(); ++p)
    if (steps.is_step(p) && before[p] == 0) ready.push_back(p);
  while (!ready.empty()) {
    const Place p = ready.back();
    ready.pop_back();
    const Due made_up = due(mesh, steps, z, read, p);
    const std::int64_t late = std::max<std::int64_t>(0, key[p] - made_up.key);
    wait[p] = static_cast<std::int32_t>((late + made_up.unit - 1) / made_up.unit);
    key[p] = made_up.key + wait[p] * made_up.unit;
    const auto precede = [&](Place q) {
      if (!steps.is_step(q)) return;
      key[q] = std::max(key[q], key[p] + 1);
      if (--before[q] == 0) ready.push_back(q);
    };
    steps.for_each_around(p, precede);
    if (p == steps.last(steps.vertex(p))) continue;
    precede(p + 1);
    for (std::size_t i = begin[p + 1]; i < begin[p + 2]; ++i) precede(around[i]);
  }
  for (Place p = 0; p < steps.size(); ++p)
    if (steps.is_step(p)) page.wait.push_back(wait[p]);
  return key;
}

/// How the hole of a column that ends at `p` is covered.
void add_splits(const Steps& steps, Place p, PageUpper& page) {
  using Corners = std::array<VertexIndex, 3>;
  std::vector<Corners> covers;
  std::vector<std::pair<VertexIndex, VertexIndex>> edges;
  const std::span<const UpperPlace> others = steps.others(p);
  for (std::size_t i = 0; i < others.size(); i += 3) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = steps.vertex(steps.place(others[i + k]));
    covers.push_back(c);
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(c[k], c[(k + 1) % 3]);
  }
  // The ring: edges without one that goes back.
  std::vector<VertexIndex> ring;
  for (const auto& edge : edges) {
    const std::pair back(edge.second, edge.first);
    if (std::find(edges.begin(), edges.end(), back) == edges.end()) ring.push_back(edge.first);
  }
  const auto is_next = [&](VertexIndex a, VertexIndex b) {
    return std::find(edges.begin(), edges.end(), std::pair(a, b)) != edges.end() &&
           std::find(edges.begin(), edges.end(), std::pair(b, a)) == edges.end();
  };
  std::iter_swap(ring.begin(), std::min_element(ring.begin(), ring.end()));
  for (std::size_t i = 1; i < ring.size(); ++i)
    for (std::size_t j = i; j < ring.size(); ++j)
      if (is_next(ring[i - 1], ring[j])) {
        std::swap(ring[i], ring[j]);
        break;
      }
  const auto is_cover = [&](VertexIndex a, VertexIndex b, VertexIndex c) {
    for (const Corners& cover : covers)
      for (std::size_t k = 0; k < 3; ++k)
        if (cover[k] == a && cover[(k + 1) % 3] == b && cover[(k + 2) % 3] == c) return true;
    return false;
  };
  const auto split = [&](const auto& self, std::size_t i, std::size_t j) -> void {
    if (j - i < 2) return;
    std::size_t k = i + 1;
    while (!is_cover(ring[i], ring[k], ring[j])) ++k;
    if (j - i > 2) page.splits.push_back(static_cast<std::uint8_t>(k - i - 1));
    self(self, i, k);
    self(self, k, j);
  };
  split(split, 0, ring.size() - 1);
}

}  // namespace

PageUpper page_upper(const ColumnMesh& mesh, std::span<const double> z) {
  PageUpper page;
  if (mesh.upper.empty()) return page;
  const Steps steps(mesh);
  std::int32_t last = 0;
  for (const VertexIndex v : mesh.ground.vertices.indices()) {
    const auto above = static_cast<std::int32_t>(steps.last(v) - steps.first(v));
    const std::int32_t count = 2 * above + (steps.is_end(steps.last(v)) ? 1 : 0);
    page.count.push_back(count - std::exchange(last, count));
  }
  const std::vector<std::int32_t> read = add_rises(mesh, steps, z, page);
  const std::vector<std::int64_t> key = add_waits(mesh, steps, z, read, page);
  std::vector<std::pair<std::int64_t, Place>> ends;
  for (Place p = 0; p < steps.size(); ++p)
    if (steps.is_end(p)) ends.emplace_back(key[p], p);
  std::sort(ends.begin(), ends.end());
  for (const auto& end : ends) add_splits(steps, end.second, page);
  return page;
}

}  // namespace tetropolis
