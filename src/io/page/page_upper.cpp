#include "page_upper.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/is_among.h"
#include "core/ragged_builder.h"
#include "page_columns.h"

namespace tetropolis {

namespace {

/// A node of the front: those of a column follow each other, from the lid upwards. A step is told
/// by the one that it leaves.
using Place = std::uint32_t;

/// The steps: one to each fan.
class Steps {
 public:
  explicit Steps(const ColumnMesh& mesh) : fans_(mesh.upper.fans) {
    const UpperMesh& upper = mesh.upper;
    const std::size_t columns = mesh.vertex_count();
    std::vector<Place> nodes(columns, 1);
    for (const VertexIndex v : upper.vertex) ++nodes[v];
    first_.push_back(0);
    for (const Place count : nodes) first_.push_back(first_.back() + count);
    for (const VertexIndex v : mesh.ground.vertices.indices()) vertex_.resize(first_[v + 1], v);
    const auto place = [&](UpperPlace p) {
      if (p < columns) return first_[p];
      const std::size_t node = p - columns;
      return static_cast<Place>(node + std::size_t{upper.vertex[node]} + 1);
    };
    fan_.assign(vertex_.size(), kNoFan);
    for (std::size_t f = 0; f + 1 < fans_.size(); ++f)
      fan_[place(fans_[f].node)] = static_cast<std::uint32_t>(f);
    around_.reserve(upper.others.size());
    for (const UpperPlace p : upper.others) around_.push_back(place(p));
  }

  Place size() const { return static_cast<Place>(vertex_.size()); }
  Place first(VertexIndex v) const { return first_[v]; }
  Place last(VertexIndex v) const { return first_[v + 1] - 1; }
  VertexIndex vertex(Place p) const { return vertex_[p]; }
  bool is_on_lid(Place p) const { return p == first_[vertex_[p]]; }
  bool is_step(Place p) const { return fan_[p] != kNoFan; }
  bool is_end(Place p) const { return is_step(p) && p == last(vertex_[p]); }

  /// The places around it when it is taken, some twice: of the cells that the step makes.
  std::span<const Place> around(Place p) const {
    if (!is_step(p)) return {};
    const std::size_t begin = fans_[fan_[p]].other, end = fans_[fan_[p] + 1].other;
    return std::span(around_).subspan(begin, end - begin);
  }

 private:
  static constexpr std::uint32_t kNoFan = 0xffffffff;
  std::span<const UpperFan> fans_;
  std::vector<Place> first_;         // per vertex, and one more
  std::vector<VertexIndex> vertex_;  // per place
  std::vector<std::uint32_t> fan_;   // per place
  std::vector<Place> around_;        // of each fan
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

/// Of a step, while keys are found.
struct Turn {
  std::int64_t key = 0;      // the least that it may be
  std::uint32_t before = 0;  // how many are to be taken before
  std::int32_t wait = 0;
};

/// Returns the turns of steps, by place. The key of each follows those that have made the places
/// around it, and comes before those that leave them.
std::vector<Turn> add_waits(const ColumnMesh& mesh, const Steps& steps, std::span<const double> z,
                            std::span<const std::int32_t> read, PageUpper& page) {
  // By place: the steps it is around of.
  const auto is_around =
      ragged_from_pairs<Place, std::uint32_t>(steps.size(), [&](const auto& use) {
        for (Place p = 0; p < steps.size(); ++p)
          for (const Place q : steps.around(p)) use(q, p);
      });
  std::vector<Turn> turns(steps.size());
  std::vector<Place> ready;
  for (Place p = 0; p < steps.size(); ++p) {
    std::size_t before = is_around[p].size();
    for (const Place q : steps.around(p)) before += steps.is_on_lid(q) ? 0 : 1;
    before += steps.is_on_lid(p) ? 0 : 1;
    // The turn of what is no step never comes.
    turns[p].before = static_cast<std::uint32_t>(before) + (steps.is_step(p) ? 0 : 1);
    if (turns[p].before == 0) ready.push_back(p);
  }
  while (!ready.empty()) {
    const Place p = ready.back();
    ready.pop_back();
    Turn& own = turns[p];
    const Due made_up = due(mesh, steps, z, read, p);
    const std::int64_t late = std::max<std::int64_t>(0, own.key - made_up.key);
    own.wait = static_cast<std::int32_t>((late + made_up.unit - 1) / made_up.unit);
    own.key = made_up.key + own.wait * made_up.unit;
    const auto precede = [&, after = own.key + 1](Place q) {
      Turn& next = turns[q];
      next.key = std::max(next.key, after);
      if (--next.before == 0) ready.push_back(q);
    };
    for (const Place q : steps.around(p)) precede(q);
    if (p == steps.last(steps.vertex(p))) continue;
    precede(p + 1);
    for (const Place q : is_around[p + 1]) precede(q);
  }
  for (Place p = 0; p < steps.size(); ++p)
    if (steps.is_step(p)) page.wait.push_back(turns[p].wait);
  return turns;
}

/// Tells how holes of columns are covered.
class SplitWriter {
 public:
  SplitWriter(const Steps& steps, std::vector<std::uint8_t>& splits)
      : steps_(steps), splits_(splits) {}
  /// That of a column that ends at `p`.
  void add(Place p);

 private:
  using Corners = std::array<VertexIndex, 3>;
  bool is_cover(VertexIndex a, VertexIndex b, VertexIndex c) const;
  void find_ring();
  void split(std::size_t i, std::size_t j);

  const Steps& steps_;
  std::vector<std::uint8_t>& splits_;
  std::vector<Corners> covers_;
  std::vector<std::pair<VertexIndex, VertexIndex>> edges_, rim_;  // directed
  std::vector<VertexIndex> ring_;
};

void SplitWriter::add(Place p) {
  covers_.clear();
  edges_.clear();
  Corners c;
  std::size_t corners = 0;
  for (const Place other : steps_.around(p)) {
    c[corners++] = steps_.vertex(other);
    if (corners < 3) continue;
    covers_.push_back(c);
    for (std::size_t k = 0; k < 3; ++k) edges_.emplace_back(c[k], c[(k + 1) % 3]);
    corners = 0;
  }
  find_ring();
  split(0, ring_.size() - 1);
}

/// Of edges without one that goes back, from its least vertex.
void SplitWriter::find_ring() {
  rim_.clear();
  for (const auto& [a, b] : edges_)
    if (!is_among(std::pair(b, a), edges_)) rim_.emplace_back(a, b);
  std::iter_swap(rim_.begin(), std::min_element(rim_.begin(), rim_.end()));
  for (std::size_t i = 1; i < rim_.size(); ++i)
    std::iter_swap(rim_.begin() + i, std::find_if(rim_.begin() + i, rim_.end(), [&](const auto& e) {
                     return e.first == rim_[i - 1].second;
                   }));
  ring_.clear();
  for (const auto& [a, b] : rim_) ring_.push_back(a);
}

bool SplitWriter::is_cover(VertexIndex a, VertexIndex b, VertexIndex c) const {
  for (const Corners& cover : covers_)
    for (std::size_t k = 0; k < 3; ++k)
      if (cover[k] == a && cover[(k + 1) % 3] == b && cover[(k + 2) % 3] == c) return true;
  return false;
}

void SplitWriter::split(std::size_t i, std::size_t j) {
  if (j - i < 2) return;
  std::size_t k = i + 1;
  while (!is_cover(ring_[i], ring_[k], ring_[j])) ++k;
  if (j - i > 2) splits_.push_back(static_cast<std::uint8_t>(k - i - 1));
  split(i, k);
  split(k, j);
}

void add_splits(const Steps& steps, std::span<const Turn> turns, PageUpper& page) {
  struct End {
    std::int64_t key;
    std::uint32_t begin, end;  // of its splits
  };
  std::vector<End> ends;
  std::vector<std::uint8_t> splits;  // by place
  SplitWriter writer(steps, splits);
  const auto told = [&] { return static_cast<std::uint32_t>(splits.size()); };
  for (Place p = 0; p < steps.size(); ++p) {
    if (!steps.is_end(p)) continue;
    const std::uint32_t begin = told();
    writer.add(p);
    ends.push_back({turns[p].key, begin, told()});
  }
  // Of those with one key the lower place first.
  std::stable_sort(ends.begin(), ends.end(),
                   [](const End& a, const End& b) { return a.key < b.key; });
  page.splits.reserve(splits.size());
  for (const End& e : ends)
    for (std::uint32_t i = e.begin; i < e.end; ++i) page.splits.push_back(splits[i]);
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
  const std::vector<Turn> turns = add_waits(mesh, steps, z, read, page);
  add_splits(steps, turns, page);
  return page;
}

}  // namespace tetropolis
