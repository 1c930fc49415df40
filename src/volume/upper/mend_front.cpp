#include "mend_front.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/sort_once.h"
#include "geometry/vec2.h"

namespace tetropolis {

namespace {

// Found by trial, as in front.cpp.

/// Segments at poor columns and beside them become shorter by this factor, so often at most, and
/// down to this share: where that does not help, shorter ones are worse.
constexpr double kShorter = 0.85;
constexpr int kMostRounds = 8;
constexpr double kLeastShare = 0.5;

/// Columns around poor ones climb again, as far away as these are below the top times this; the
/// second time if the first does not do.
constexpr std::array kReach{1.5, 3.0};

/// Where these are more than this share of all, all climb: by tiles, on several threads.
constexpr double kMost = 0.5;

/// What climbs again.
struct Part {
  std::vector<VertexIndex> columns;
  std::vector<VertexIndex> others;  ///< All that these have been next to, and no more than that.
};

template <typename Visit>
void for_each_beside(const ColumnMesh& mesh, VertexIndex v, const Visit& visit) {
  for (const EdgeIndex e : mesh.edges.starting_at(v)) visit(mesh.edges.vertices[e][1]);
  for (const EdgeIndex e : mesh.edges.ends[v]) visit(mesh.edges.vertices[e][0]);
}

/// Of all phases, one after the other.
std::vector<const FrontSteps*> tiles_of(const FrontPhases& phases) {
  std::vector<const FrontSteps*> all;
  for (const std::vector<FrontSteps>& tiles : phases)
    for (const FrontSteps& tile : tiles) all.push_back(&tile);
  return all;
}

constexpr std::int32_t kNoPart = -1;

/// The columns within `reach` of some, by what hangs together on the ground. Sets `part_of`, per
/// vertex.
std::vector<Part> parts_around(const ColumnMesh& mesh, std::span<const VertexIndex> middles,
                               double reach, std::vector<std::int32_t>& part_of) {
  std::vector<std::uint8_t> is_near(mesh.vertex_count(), 0);
  std::vector<std::pair<VertexIndex, VertexIndex>> queue;  // and the middle
  const auto visit = [&](VertexIndex v, VertexIndex middle) {
    const Point2 p = mesh.ground.vertices[middle], q = mesh.ground.vertices[v];
    if (is_near[v] != 0 || distance(p, q) > reach) return;
    is_near[v] = 1;
    queue.emplace_back(v, middle);
  };
  for (const VertexIndex v : middles) visit(v, v);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const auto [v, middle] = queue[i];
    for_each_beside(mesh, v, [&, middle = middle](VertexIndex u) { visit(u, middle); });
  }
  std::vector<Part> parts;
  part_of.assign(mesh.vertex_count(), kNoPart);
  for (const VertexIndex first : middles) {
    if (part_of[first] != kNoPart) continue;
    std::vector<VertexIndex> columns;
    const auto add = [&](VertexIndex v) {
      if (is_near[v] == 0 || part_of[v] != kNoPart) return;
      part_of[v] = static_cast<std::int32_t>(parts.size());
      columns.push_back(v);
    };
    add(first);
    for (std::size_t i = 0; i < columns.size(); ++i) for_each_beside(mesh, columns[i], add);
    std::sort(columns.begin(), columns.end());
    parts.push_back({std::move(columns), {}});
  }
  return parts;
}

/// Finds Part::others.
void find_others(const FrontPhases& phases, const std::vector<std::int32_t>& part_of,
                 std::vector<Part>& parts) {
  const std::vector<const FrontSteps*> tiles = tiles_of(phases);
  std::vector<std::vector<std::pair<std::int32_t, VertexIndex>>> found(tiles.size());
  parallel_in_order(tiles.size(), [&](std::size_t i) {
    for_each_step(*tiles[i], [&](const FrontStep& step, std::span<const VertexIndex> others) {
      const std::int32_t own = part_of[step.vertex];
      for (const VertexIndex u : others) {
        const std::int32_t other = part_of[u];
        if (own == other) continue;
        if (own != kNoPart) found[i].emplace_back(own, u);
        if (other != kNoPart) found[i].emplace_back(other, step.vertex);
      }
    });
    sort_once(found[i]);
  });
  for (const auto& in_tile : found)
    for (const auto& [part, v] : in_tile) parts[static_cast<std::size_t>(part)].others.push_back(v);
  for (Part& part : parts) sort_once(part.others);
}

std::vector<VertexIndex> poor_of(const FrontPhases& phases) {
  std::vector<VertexIndex> poor;
  for (const FrontSteps* tile : tiles_of(phases))
    poor.insert(poor.end(), tile->poor.begin(), tile->poor.end());
  return poor;
}

/// Calls job(i) for all parts: at the same time for those in a row that touch no column in common.
template <typename Job>
void for_each_apart(const std::vector<Part>& parts, const FrontRecord& record, std::size_t columns,
                    const Job& job) {
  const auto for_each_touched = [&](const Part& part, const auto& visit) {
    for (const VertexIndex v : part.columns) visit(v);
    for (const VertexIndex v : part.others) {
      visit(v);
      for (const FrontRecord::Step& step : record.steps_of(v))
        for (const VertexIndex u : step.others()) visit(u);
    }
  };
  std::vector<std::size_t> row_of(columns, 0);  // the last in which it is touched, from 1 on
  for (std::size_t first = 0, row = 1; first < parts.size(); ++row) {
    std::size_t end = first;
    for (bool is_apart = true; end < parts.size(); ++end) {
      for_each_touched(parts[end], [&](VertexIndex v) { is_apart &= row_of[v] != row; });
      if (!is_apart) break;
      for_each_touched(parts[end], [&](VertexIndex v) { row_of[v] = row; });
    }
    parallel_in_order(end - first, [&](std::size_t i) { job(first + i); });
    first = end;
  }
}

void shorten(std::span<const VertexIndex> poor, std::vector<double>& shares) {
  for (const VertexIndex v : poor) shares[v] = std::max(shares[v] * kShorter, kLeastShare);
}

/// The steps of the last round, where `poor` are poor before the first. Nothing if they would
/// matter to columns elsewhere.
std::optional<StepsWithin> steps_of_rounds(FrontClimb& climb, const Part& part,
                                           const FrontRecord& record, std::vector<VertexIndex> poor,
                                           std::vector<double>& shares) {
  std::optional<StepsWithin> steps;
  for (int round = 0; round < kMostRounds && !poor.empty(); ++round) {
    sort_once(poor);
    if (!std::includes(part.columns.begin(), part.columns.end(), poor.begin(), poor.end()))
      return std::nullopt;
    shorten(poor, shares);
    steps = climb.within(part.columns, part.others, record, shares);
    if (!steps) return std::nullopt;
    poor = steps->done.poor;
  }
  return steps;
}

/// Columns that have climbed again.
class Again {
 public:
  /// `steps`: per part.
  Again(const FrontRecord& before, const std::vector<std::int32_t>& part_of,
        const std::vector<Part>& parts, const std::vector<StepsWithin>& steps);
  /// Whether columns elsewhere would have done the same as before.
  bool is_complete(const FrontPhases& phases) const;
  /// Precondition: is_complete(phases).
  void replace_in(FrontPhases& phases) const;

 private:
  struct Step {
    const FrontStep* step = nullptr;
    std::size_t first_other = 0;  // in those of its part
  };
  std::span<const Step> steps_of(VertexIndex v) const {
    return std::span(steps_).subspan(first_[v], first_[v + 1] - first_[v]);
  }
  const StepsWithin& steps_around(VertexIndex v) const {
    return (*new_)[static_cast<std::size_t>((*part_of_)[v])];
  }
  std::span<const VertexIndex> others_of(VertexIndex v, const Step& step) const {
    return std::span(steps_around(v).done.others)
        .subspan(step.first_other, static_cast<std::size_t>(step.step->others()));
  }
  bool is_same(VertexIndex v, std::span<const FrontRecord::Step> before) const;

  const std::vector<std::int32_t>* part_of_;
  const std::vector<StepsWithin>* new_;
  std::vector<std::uint32_t> first_;  // per vertex and one more
  std::vector<Step> steps_;
  std::vector<std::uint8_t> differs_;  // per vertex
  bool is_within_ = true;              // All that are next to those that differ are of their part.
};

Again::Again(const FrontRecord& before, const std::vector<std::int32_t>& part_of,
             const std::vector<Part>& parts, const std::vector<StepsWithin>& steps)
    : part_of_(&part_of), new_(&steps), first_(part_of.size() + 1, 0), differs_(part_of.size(), 0) {
  for (const StepsWithin& part : steps)
    for (const FrontStep& step : part.done.steps) ++first_[step.vertex + 1];
  std::inclusive_scan(first_.begin(), first_.end(), first_.begin());
  steps_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const StepsWithin& part : steps) {
    std::size_t other = 0;
    for (const FrontStep& step : part.done.steps) {
      steps_[next[step.vertex]++] = {&step, other};
      other += static_cast<std::size_t>(step.others());
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (steps[i].done.steps.empty()) continue;  // It stays as it is.
    for (const VertexIndex v : parts[i].columns)
      differs_[v] = is_same(v, before.steps_of(v)) ? 0 : 1;
  }
  for (const Part& part : parts)
    for (const VertexIndex v : part.columns) {
      const auto check = [&](std::span<const VertexIndex> others) {
        for (const VertexIndex u : others)
          if (differs_[v] != 0 || differs_[u] != 0)
            is_within_ = is_within_ && part_of[u] == part_of[v];
      };
      for (const Step& step : steps_of(v)) check(others_of(v, step));
      for (const FrontRecord::Step& step : before.steps_of(v)) check(step.others());
    }
}

bool Again::is_same(VertexIndex v, std::span<const FrontRecord::Step> before) const {
  const std::span<const Step> own = steps_of(v);
  if (own.size() != before.size()) return false;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const FrontStep &a = *own[i].step, &b = *before[i].step;
    if (a.is_end() != b.is_end() || (!a.is_end() && a.to != b.to)) return false;
    const std::span<const VertexIndex> others = others_of(v, own[i]),
                                       others_before = before[i].others();
    if (!std::equal(others.begin(), others.end(), others_before.begin(), others_before.end()))
      return false;
  }
  return true;
}

bool Again::is_complete(const FrontPhases& phases) const {
  const std::vector<const FrontSteps*> tiles = tiles_of(phases);
  std::atomic<bool> is_complete = is_within_;
  parallel_in_order(tiles.size(), [&](std::size_t i) {
    bool is_same = true;
    for_each_step(*tiles[i], [&](const FrontStep& step, std::span<const VertexIndex> others) {
      if ((*part_of_)[step.vertex] != kNoPart) return;
      for (const VertexIndex u : others) is_same = is_same && differs_[u] == 0;
    });
    if (!is_same) is_complete = false;
  });
  return is_complete;
}

void Again::replace_in(FrontPhases& phases) const {
  const auto has_climbed = [&](VertexIndex v) {
    return (*part_of_)[v] != kNoPart && !steps_around(v).done.steps.empty();
  };
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::vector<FrontSteps>& tiles : phases)
    // Those of a phase have no column in common.
    parallel_in_order(tiles.size(), [&](std::size_t i) {
      FrontSteps& tile = tiles[i];
      const bool is_touched =
          std::any_of(tile.steps.begin(), tile.steps.end(),
                      [&](const FrontStep& s) { return has_climbed(s.vertex); });
      if (!is_touched) return;
      // In place: most tiles are touched.
      std::size_t steps = 0;
      std::uint32_t kept = 0;  // of `others`
      for_each_step(tile, [&](const FrontStep& step, std::span<const VertexIndex> others) {
        const VertexIndex v = step.vertex;
        if (differs_[v] != 0) return;
        const bool is_own = has_climbed(v);
        const std::size_t first = is_own ? steps_[next[v]++].first_other : 0;
        for (std::size_t k = 0; k < others.size(); ++k, ++kept) {
          const VertexIndex u = others[k];
          tile.others[kept] = u;
          // Columns that differ come after all others.
          if (is_own && differs_[u] != 0)
            tile.risen.push_back({kept, steps_around(v).risen[first + k]});
        }
        tile.steps[steps++] = step;
      });
      tile.steps.resize(steps);
      tile.others.resize(kept);
      tile.orders = {};
      tile.poor = {};
      std::erase_if(tile.covered, [&](const CoveredTriangle& c) { return has_climbed(c.vertex); });
    });
  std::vector<FrontSteps>& last = phases.emplace_back();
  for (const StepsWithin& part : *new_) {
    FrontSteps& own = last.emplace_back();
    own.covered = part.done.covered;
    std::size_t other = 0;
    for_each_step(part.done, [&](const FrontStep& step, std::span<const VertexIndex> others) {
      if (differs_[step.vertex] != 0) {
        own.steps.push_back(step);
        for (std::size_t k = 0; k < others.size(); ++k) {
          own.risen.push_back(
              {static_cast<std::uint32_t>(own.others.size()), part.risen[other + k]});
          own.others.push_back(others[k]);
        }
      }
      other += others.size();
    });
  }
}

/// Has columns within `reach` of the middles climb again. Returns false, with all as it was, if
/// that would matter to others, or these are most.
bool mend_within(const ColumnMesh& mesh, double reach, std::span<const VertexIndex> middles,
                 std::span<const VertexIndex> poor, FrontClimb& climb, FrontPhases& phases) {
  std::vector<std::int32_t> part_of;
  std::vector<Part> parts = parts_around(mesh, middles, reach, part_of);
  find_others(phases, part_of, parts);
  std::vector<std::uint8_t> is_kept(mesh.vertex_count(), 0);
  std::size_t columns = 0;
  for (const Part& part : parts) {
    columns += part.columns.size() + part.others.size();
    for (const VertexIndex v : part.columns) is_kept[v] = 1;
    for (const VertexIndex v : part.others) is_kept[v] = 1;
  }
  if (static_cast<double>(columns) > kMost * static_cast<double>(mesh.vertex_count())) return false;
  const FrontRecord record(phases, is_kept);
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  std::vector<StepsWithin> steps(parts.size());
  std::atomic<bool> is_possible = true;
  for_each_apart(parts, record, mesh.vertex_count(), [&](std::size_t i) {
    std::vector<VertexIndex> own;
    for (const VertexIndex v : poor)
      if (part_of[v] == static_cast<std::int32_t>(i)) own.push_back(v);
    std::optional<StepsWithin> own_steps = steps_of_rounds(climb, parts[i], record, own, shares);
    if (own_steps)
      steps[i] = std::move(*own_steps);
    else
      is_possible = false;
  });
  if (!is_possible) return false;
  const Again again(record, part_of, parts, steps);
  if (!again.is_complete(phases)) return false;
  again.replace_in(phases);
  return true;
}

/// The same for all columns at once.
void mend_all(const ColumnMesh& mesh, FrontClimb& climb, FrontPhases& phases) {
  std::vector<double> shares(mesh.vertex_count(), 1.0);
  std::vector<VertexIndex> poor = poor_of(phases);
  for (int round = 0; round < kMostRounds && !poor.empty(); ++round) {
    sort_once(poor);
    shorten(poor, shares);
    phases.clear();  // Steps of one round are kept at a time.
    phases = climb.to_top(shares);
    poor = poor_of(phases);
  }
}

}  // namespace

void mend_front(const ColumnMesh& mesh, double top, FrontClimb& climb, FrontPhases& phases) {
  const std::vector<VertexIndex> poor = poor_of(phases);
  if (poor.empty()) return;
  std::vector<VertexIndex> middles = poor;
  sort_once(middles);
  double height = 0;
  for (const VertexIndex v : middles) height = std::max(height, top - mesh.z[mesh.top(v)]);
  for (const double reach : kReach)
    if (mend_within(mesh, reach * height, middles, poor, climb, phases)) return;
  mend_all(mesh, climb, phases);
}

}  // namespace tetropolis
