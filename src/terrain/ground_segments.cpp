#include "ground_segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plane.h"

namespace tetropolis {

namespace {

/// Gives cells without a point the height of the nearest with one, by steps through such cells.
void spread(HeightGrid& grid, const std::vector<std::uint8_t>& barred, const Frame& frame) {
  std::vector<std::uint32_t> queue;
  for (std::size_t c = 0; c < barred.size(); ++c)
    if (barred[c] == 0 && !std::isnan(grid.values[c]))
      queue.push_back(static_cast<std::uint32_t>(c));
  for (std::size_t k = 0; k < queue.size(); ++k)
    for_each_neighbour(frame, queue[k], [&](std::size_t n) {
      if (barred[n] != 0 || !std::isnan(grid.values[n])) return;
      grid.values[n] = grid.values[queue[k]];
      queue.push_back(static_cast<std::uint32_t>(n));
    });
}

constexpr double kSteepest = 1.25;  // rise over run of terrain

/// The greatest step from a cell to the next that a slope has; about half a storey, however coarse
/// the cells.
double greatest_step(const Frame& frame) {
  constexpr double kRoughness = 0.3;  // metres
  constexpr double kMostOfStorey = 0.55;
  return std::min(kSteepest * frame.cell + kRoughness, kMostOfStorey * kStorey);
}

/// The rise from c to the next cell, or half of that to the one after it, on the side away from its
/// neighbour n, as far as terrain rises: what a slope that goes on beyond c drops from there to n,
/// but for chance.
float rise_behind(const HeightGrid& lowest, const Frame& frame, std::size_t c, std::size_t n) {
  const std::size_t step = c > n ? c - n : n - c;  // 1, or a row
  const std::size_t at = step == 1 ? c % static_cast<std::size_t>(lowest.nx) : c / step;
  const std::size_t cells = static_cast<std::size_t>(step == 1 ? lowest.nx : lowest.ny);
  const auto rise_to = [&](std::size_t steps) {
    const bool inside = c > n ? at + steps < cells : at >= steps;
    if (!inside) return 0.0F;
    const std::size_t there = c > n ? c + steps * step : c - steps * step;
    const float rise = (lowest.values[there] - lowest.values[c]) / static_cast<float>(steps);
    return std::isnan(rise) ? 0.0F : rise;
  };
  return std::clamp(std::max(rise_to(1), rise_to(2)), 0.0F,
                    static_cast<float>(kSteepest * frame.cell));
}

constexpr double kLeastArea = 50;  // square metres that are more than a fragment
constexpr std::size_t kCellsPerPoll = std::size_t{1} << 20;

/// At least `most` cells with ground (all within `reach`, if these are fewer), the nearest to the
/// segment by steps through anything. `seen` has one entry per cell, of which none is `stamp`.
std::vector<std::uint32_t> ground_around(const HeightGrid& lowest,
                                         const std::vector<std::uint8_t>& object,
                                         const Frame& frame,
                                         const std::vector<std::uint32_t>& segment,
                                         std::size_t most, double reach, std::uint32_t stamp,
                                         std::vector<std::uint32_t>& seen) {
  std::vector<std::uint32_t> ground, front = segment, next;
  for (const std::uint32_t c : segment) seen[c] = stamp;
  const auto steps = static_cast<int>(std::ceil(reach / frame.cell));
  for (int step = 0; step < steps && ground.size() < most; ++step) {
    next.clear();
    for (const std::uint32_t c : front)
      for_each_neighbour(frame, c, [&](std::size_t n) {
        if (seen[n] == stamp) return;
        seen[n] = stamp;
        next.push_back(static_cast<std::uint32_t>(n));
        if (object[n] == 0 && !std::isnan(lowest.values[n]))
          ground.push_back(static_cast<std::uint32_t>(n));
      });
    front.swap(next);
  }
  return ground;
}

/// Through the lowest points of these cells; level where it rises by less than `least_rise` a cell,
/// which is chance.
Plane plane_through(const std::vector<std::uint32_t>& cells, const HeightGrid& lowest,
                    double least_rise) {
  const auto nx = static_cast<std::uint32_t>(lowest.nx);
  CellPlaneFit fit;
  for (const std::uint32_t c : cells)
    fit.add(c % nx, c / nx, static_cast<double>(lowest.values[c]));
  Plane plane;
  if (fit.solve(plane) && std::hypot(plane.rise_x, plane.rise_y) >= least_rise) return plane;
  return {0, 0, static_cast<double>(lowest.values[cells.front()])};
}

/// How far the share of the cells that have points is at most above the plane.
double quantile_above(const std::vector<std::uint32_t>& cells, const Plane& plane,
                      const HeightGrid& lowest, double share) {
  std::vector<double> above;
  for (const std::uint32_t c : cells)
    if (!std::isnan(lowest.values[c]))
      above.push_back(static_cast<double>(lowest.values[c]) -
                      plane.at(static_cast<std::int32_t>(c) % lowest.nx,
                               static_cast<std::int32_t>(c) / lowest.nx));
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(above.size()));
  std::nth_element(above.begin(), above.begin() + rank, above.end());
  return above[static_cast<std::size_t>(rank)];
}

}  // namespace

void restore_gentle_rises(const HeightGrid& lowest, const Frame& frame,
                          std::vector<std::uint8_t>& object, const Progress& progress) {
  constexpr std::int64_t kStepsPerWall = 9;  // one in ten is a wall
  constexpr double kStepsWithin = 2;         // mean steps of the rim
  constexpr std::uint8_t kSeen = 1, kKept = 2;
  const auto most = static_cast<float>(greatest_step(frame));
  const std::size_t cells = object.size();
  std::vector<std::uint8_t> state(cells, 0);
  std::vector<std::uint32_t> segment;  // cells; fewer than 2^32 by kMostCells
  for (std::size_t seed = 0; seed < cells; ++seed) {
    if (seed % kCellsPerPoll == 0) progress.update(0.8);
    if (object[seed] == 0 || state[seed] != 0 || std::isnan(lowest.values[seed])) continue;
    segment.assign(1, static_cast<std::uint32_t>(seed));
    state[seed] = kSeen;
    std::int64_t walls = 0, steps = 0;
    double down = 0;  // by steps
    float low = lowest.values[seed], high = low;
    for (std::size_t k = 0; k < segment.size(); ++k) {
      const std::size_t c = segment[k];
      low = std::min(low, lowest.values[c]);
      high = std::max(high, lowest.values[c]);
      for_each_neighbour(frame, c, [&](std::size_t n) {
        const float drop = lowest.values[c] - lowest.values[n];
        if (std::isnan(drop)) return;
        if (drop > most && drop > most + rise_behind(lowest, frame, c, n)) {
          ++walls;
        } else if (object[n] == 0) {
          if (drop < 0) return;
          ++steps;
          down += static_cast<double>(drop);
        } else if (-drop <= most && state[n] == 0) {
          state[n] = kSeen;
          segment.push_back(static_cast<std::uint32_t>(n));
        }
      });
    }
    const double area = static_cast<double>(segment.size()) * frame.cell * frame.cell;
    const double rise = static_cast<double>(high - low);
    if (area >= kLeastArea && steps > kStepsPerWall * walls &&
        rise * static_cast<double>(steps) > kStepsWithin * down)
      for (const std::uint32_t c : segment) state[c] = kKept;
  }
  for (std::size_t c = 0; c < cells; ++c)
    if (state[c] == kKept) object[c] = 0;
}

void reject_fragments(const HeightGrid& lowest, std::vector<std::uint8_t> barred,
                      const Frame& frame, std::vector<std::uint8_t>& object,
                      const Progress& progress) {
  constexpr double kRaised = 1;         // metres: a podium; kerbs and garden walls are lower
  constexpr double kReach = 30;         // metres: across a street and the yards beside it
  constexpr double kLeastSlope = 0.08;  // steeper than streets are drained; less is chance
  // Quantiles, of the fragment and of the ground: a few points of either lie on something else.
  constexpr double kLow = 0.1, kMostGround = 0.75;
  constexpr std::size_t kNearest = 200;  // cells: enough for a plane
  constexpr std::size_t kTooFew = 30;    // cells: a plane through fewer is chance
  const auto most = static_cast<float>(greatest_step(frame));
  const double largest = kLeastArea / (frame.cell * frame.cell);
  const double least_rise = kLeastSlope * frame.cell;
  for (std::size_t c = 0; c < barred.size(); ++c) barred[c] |= object[c];
  HeightGrid full = lowest;
  spread(full, barred, frame);
  std::vector<std::uint32_t> seen(object.size(), 0), segment;
  std::vector<std::uint32_t> fragments;
  std::uint32_t stamp = 0;
  for (std::size_t seed = 0; seed < object.size(); ++seed) {
    if (seed % kCellsPerPoll == 0) progress.update(0.8);
    if (barred[seed] != 0) continue;
    segment.assign(1, static_cast<std::uint32_t>(seed));
    barred[seed] = 1;
    std::size_t known = 0;
    for (std::size_t k = 0; k < segment.size(); ++k) {
      const std::size_t c = segment[k];
      if (!std::isnan(lowest.values[c])) ++known;
      for_each_neighbour(frame, c, [&](std::size_t n) {
        if (barred[n] != 0 || std::abs(full.values[c] - full.values[n]) > most) return;
        barred[n] = 1;
        segment.push_back(static_cast<std::uint32_t>(n));
      });
    }
    if (known == 0 || static_cast<double>(known) > largest) continue;
    const std::vector<std::uint32_t> around =
        ground_around(lowest, object, frame, segment, kNearest, kReach, ++stamp, seen);
    if (around.size() < kTooFew) continue;
    const Plane plane = plane_through(around, lowest, least_rise);
    if (quantile_above(segment, plane, lowest, kLow) <
        quantile_above(around, plane, lowest, kMostGround) + kRaised)
      continue;
    fragments.insert(fragments.end(), segment.begin(), segment.end());
  }
  for (const std::uint32_t c : fragments) object[c] = 1;
}

}  // namespace tetropolis
