#include "blocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tetropolis/geometry/polygon.h"

#include "convex.h"

namespace tetropolis {

namespace {

using namespace convex;

constexpr double kDepth = 11;       // Of perimeter buildings, metres.
constexpr double kDepthStep = 1.5;  // Rear walls jump by this or not at all.
constexpr double kGreatestDepth = kDepth + 2 * kDepthStep;
constexpr double kShortestEdge = 9;  // Of a perimeter block, metres.
constexpr double kFrontage = 12;     // Usual width of a row house, metres.

/// Appends p unless the ring ends there already.
void push(Ring& ring, Point2 p) {
  const Point2 q = on_mm(p);
  if (ring.empty() || !(ring.back() == q)) ring.push_back(q);
}

double storeys(double floors, SeededRandom& random) {
  return round_to_mm(floors * 3.1 + random.uniform(1.0, 2.6));
}

/// Corners sharper than this make no usable building plots: cut so that the cut is 16 m long.
Ring without_sharp_corners(Ring ring) {
  constexpr double kSharp = 0.45;  // Cosine.
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 corner = ring[i];
    const Point2 a = unit(ring[(i + ring.size() - 1) % ring.size()] - corner);
    const Point2 b = unit(ring[(i + 1) % ring.size()] - corner);
    if (dot(a, b) < kSharp) continue;
    const Point2 bisector = unit(a + b);
    const double cut = 8 * (1 + dot(a, b)) / cross(b, a);
    ring = clip(ring, corner + cut * bisector, bisector);
    if (ring.empty()) return ring;
  }
  return ring;
}

/// One side of a perimeter block. Positions along it are metres from its start.
struct Side {
  std::size_t edge = 0;  ///< Of the block's ring.
  Point2 start;
  Point2 along;  ///< Unit vector; the block is to its left.
  double length = 0;
  double corner_start = 0;  ///< Where the plot of the start corner ends.
  double corner_end = 0;    ///< Where the plot of the end corner begins.

  Point2 at(double position, double depth) const {
    return start + position * along + depth * left_of(along);
  }
};

/// Where the lines at a depth behind a side and the side before it meet, seen from their corner.
double corner_reach(const Side& before, const Side& side, double depth) {
  const Point2 a = -1.0 * before.along;
  return depth * (1 + dot(a, side.along)) / cross(side.along, a);
}

/// The sides with their corner plots; empty if a side is too short for its corners.
std::vector<Side> perimeter_sides(const Ring& ring, SeededRandom& random) {
  std::vector<Side> sides(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2 edge = ring[(i + 1) % ring.size()] - ring[i];
    sides[i] = {i, ring[i], unit(edge), length(edge)};
    sides[i].corner_end = sides[i].length;
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    Side& before = sides[(i + sides.size() - 1) % sides.size()];
    // Beyond this, the deepest plots of the two sides do not get in each other's way.
    const double reach = std::max(corner_reach(before, sides[i], kGreatestDepth), 2.0);
    before.corner_end -= reach + random.uniform(1, 6);
    sides[i].corner_start = reach + random.uniform(1, 6);
  }
  for (Side& side : sides) {
    const double room = side.corner_end - side.corner_start;
    if (room >= 6) continue;
    // No room between the corner plots: they meet in the middle of what is left.
    const double middle = (side.corner_end + side.corner_start) / 2;
    side.corner_end = side.corner_start = middle;
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& before = sides[(i + sides.size() - 1) % sides.size()];
    const double reach = corner_reach(before, sides[i], kDepth) + 1;
    if (sides[i].corner_start < reach || before.length - before.corner_end < reach) return {};
  }
  return sides;
}

/// The party walls of one side: position and depth of the plots between the corner plots.
struct SidePlots {
  std::vector<double> walls;   ///< From corner_start to corner_end.
  std::vector<double> depths;  ///< One less than walls; empty if the corner plots meet.
};

/// The depth of a plot between two walls, less where the block is narrow: the rear corners keep as
/// far from the other sides as these may build.
double plot_depth(const Side& side, double from, double to, const Ring& block,
                  SeededRandom& random) {
  double depth = kDepth + kDepthStep * std::floor(random.uniform(-2, 3));
  const auto narrow = [&](double position) {
    return depth_inside(block, side.at(position, depth), side.edge) < kGreatestDepth + 1;
  };
  while (depth > kDepth - 2 * kDepthStep && (narrow(from) || narrow(to))) depth -= kDepthStep;
  return depth;
}

SidePlots divide(const Side& side, const Ring& block, double scale, SeededRandom& random) {
  const double room = side.corner_end - side.corner_start;
  if (room <= 0) return {{side.corner_start}, {}};
  const double n = std::max(1.0, std::nearbyint(room / (kFrontage * scale)));
  std::vector<double> weights;
  double total = 0;
  for (int k = 0; k < static_cast<int>(n); ++k) {
    weights.push_back(random.uniform(0.7, 1.4));
    total += weights.back();
  }
  SidePlots plots;
  plots.walls.push_back(side.corner_start);
  for (const double weight : weights)
    plots.walls.push_back(plots.walls.back() + room * weight / total);
  plots.walls.back() = side.corner_end;
  for (std::size_t k = 0; k + 1 < plots.walls.size(); ++k)
    plots.depths.push_back(plot_depth(side, plots.walls[k], plots.walls[k + 1], block, random));
  return plots;
}

/// A wing into the courtyard behind plot k, if it keeps away from the other sides.
void add_wing(Ring& ring, const Side& side, const SidePlots& plots, std::size_t k,
              const Ring& block, SeededRandom& random) {
  const double from = plots.walls[k];
  const double width = plots.walls[k + 1] - from;
  const bool wanted = random.chance(0.4);
  const double reach = plots.depths[k] + random.uniform(5, 9);
  const double left = from + 1.5;
  const double right = from + 1.5 + std::max(0.45 * width, 4.5);
  if (!wanted || width < 9) return;
  // Beyond the wings of the other sides.
  const double clearance = kGreatestDepth + 11;
  if (depth_inside(block, side.at(left, reach), side.edge) < clearance ||
      depth_inside(block, side.at(right, reach), side.edge) < clearance)
    return;
  push(ring, side.at(right, plots.depths[k]));
  push(ring, side.at(right, reach));
  push(ring, side.at(left, reach));
  push(ring, side.at(left, plots.depths[k]));
}

/// The building on plot k of a side. Where a neighbour is shallower its rear corner becomes a
/// vertex of the party wall, so that the wall is shared vertex by vertex.
Ring row_house(const Side& side, const SidePlots& plots, std::size_t k, const Ring& block,
               SeededRandom& random) {
  const double depth = plots.depths[k];
  const double before = k == 0 ? kDepth : plots.depths[k - 1];
  const double after = k + 1 == plots.depths.size() ? kDepth : plots.depths[k + 1];
  Ring ring;
  push(ring, side.at(plots.walls[k], 0));
  push(ring, side.at(plots.walls[k + 1], 0));
  if (after < depth) push(ring, side.at(plots.walls[k + 1], after));
  push(ring, side.at(plots.walls[k + 1], depth));
  add_wing(ring, side, plots, k, block, random);
  push(ring, side.at(plots.walls[k], depth));
  if (before < depth) push(ring, side.at(plots.walls[k], before));
  return ring;
}

/// The building around the corner between two sides.
Ring corner_house(const Side& before, const SidePlots& plots_before, const Side& side,
                  const SidePlots& plots) {
  const double depth_before = plots_before.depths.empty() ? kDepth : plots_before.depths.back();
  const double depth_after = plots.depths.empty() ? kDepth : plots.depths.front();
  Ring ring;
  push(ring, before.at(before.corner_end, 0));
  push(ring, side.start);
  push(ring, side.at(side.corner_start, 0));
  if (depth_after < kDepth) push(ring, side.at(side.corner_start, depth_after));
  push(ring, side.at(side.corner_start, kDepth));
  push(ring, side.at(corner_reach(before, side, kDepth), kDepth));
  push(ring, before.at(before.corner_end, kDepth));
  if (depth_before < kDepth) push(ring, before.at(before.corner_end, depth_before));
  return ring;
}

void add(std::vector<SyntheticBuilding>& buildings, Ring ring, double height, SyntheticKind kind) {
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() >= 3) buildings.push_back({{std::move(ring), {}}, height, kind});
}

/// A rectangle in the frame of `axis`, from its south-west corner.
Ring rectangle(Point2 corner, Point2 axis, double width, double depth) {
  const Point2 up = left_of(axis);
  return {on_mm(corner), on_mm(corner + width * axis), on_mm(corner + width * axis + depth * up),
          on_mm(corner + depth * up)};
}

bool fits(const Ring& block, const Ring& ring, double distance) {
  return std::all_of(ring.begin(), ring.end(),
                     [&](Point2 p) { return depth_inside(block, p) >= distance; });
}

/// Perimeter buildings around an open courtyard, perhaps with a workshop in it.
bool build_perimeter(const Ring& ring, Point2 axis, double scale, SeededRandom& random,
                     std::vector<SyntheticBuilding>& buildings) {
  const std::vector<Side> sides = perimeter_sides(ring, random);
  if (sides.empty()) return false;
  std::vector<SidePlots> plots;
  for (const Side& side : sides) plots.push_back(divide(side, ring, scale, random));
  const double floors = std::floor(random.uniform(4, 6));
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::size_t before = (i + sides.size() - 1) % sides.size();
    add(buildings, corner_house(sides[before], plots[before], sides[i], plots[i]),
        storeys(floors + (random.chance(0.4) ? 1 : 0), random), SyntheticKind::kRowHouse);
    for (std::size_t k = 0; k < plots[i].depths.size(); ++k) {
      const Ring house = row_house(sides[i], plots[i], k, ring, random);
      const double more = std::floor(random.uniform(-1.3, 1.5));
      add(buildings, house, storeys(floors + more, random), SyntheticKind::kRowHouse);
    }
  }
  const Ring yard = inset(ring, kDepth + 14);
  if (!yard.empty() && random.chance(0.6)) {
    const double width = random.uniform(6, 11);
    const double depth = random.uniform(5, 8);
    const Point2 centre = interior_point({yard, {}});
    const Ring shop =
        rectangle(centre - (width / 2) * axis - (depth / 2) * left_of(axis), axis, width, depth);
    if (fits(ring, shop, kDepth + 14))
      add(buildings, shop, storeys(1, random), SyntheticKind::kHouse);
  }
  return true;
}

/// The range of a ring along a direction: its least and its greatest ordinate.
Point2 extent(const Ring& ring, Point2 direction) {
  Point2 range{dot(direction, ring[0]), dot(direction, ring[0])};
  for (const Point2 p : ring) {
    range.x = std::min(range.x, dot(direction, p));
    range.y = std::max(range.y, dot(direction, p));
  }
  return range;
}

/// Where to cut a ring across `direction`: near a share of the way along its range, but not so near
/// to a vertex that a sliver of wall would be left, if that can be had.
double party_wall(const Ring& ring, Point2 direction, Point2 range, double share, double jitter,
                  SeededRandom& random) {
  double at = 0;
  constexpr int kTries = 8;
  for (int tries = 0; tries < kTries; ++tries) {
    at = range.x + (range.y - range.x) * (share + random.uniform(-jitter, jitter));
    if (std::all_of(ring.begin(), ring.end(),
                    [&](Point2 p) { return std::abs(dot(direction, p) - at) > 0.8; }))
      break;
  }
  return at;
}

/// A ring cut across into a row of buildings that share whole walls.
void build_row(const Ring& ring, Point2 direction, double scale, SeededRandom& random,
               std::vector<SyntheticBuilding>& buildings) {
  if (ring.empty()) return;
  const Point2 range = extent(ring, direction);
  const double n = std::max(1.0, std::nearbyint((range.y - range.x) / (kFrontage * scale)));
  const double floors = std::floor(random.uniform(3, 6));
  Ring rest = ring;
  for (double k = 1; k <= n; ++k) {
    const double at = k < n ? party_wall(rest, direction, range, k / n, 0.25 / n, random) : range.y;
    const Point2 through = at * direction;
    const Ring slice = k < n ? clip(rest, through, -1.0 * direction) : rest;
    if (k < n) rest = clip(rest, through, direction);
    const double height = storeys(floors + std::floor(random.uniform(-1, 2)), random);
    if (slice.empty() || inset(slice, 2).empty()) continue;  // Not for living.
    Ring house;
    for (const Point2 p : slice) push(house, p);
    add(buildings, house, height, SyntheticKind::kRowHouse);
  }
}

/// Rows along the longer side of a block without room for a courtyard: two with gardens between
/// them, or one.
void build_rows(const Ring& ring, Point2 axis, double scale, SeededRandom& random,
                std::vector<SyntheticBuilding>& buildings) {
  const Point2 along = extent(ring, axis);
  const Point2 across = extent(ring, left_of(axis));
  const bool longer_along = along.y - along.x >= across.y - across.x;
  const Point2 direction = longer_along ? axis : left_of(axis);
  const Point2 side = left_of(direction);
  const Point2 range = extent(ring, side);
  const double width = range.y - range.x;
  const double depth = random.uniform(10, 12.5);
  if (width < 2 * 8 + 5) {
    build_row(ring, direction, scale, random, buildings);
    return;
  }
  const double half_gap = std::max(2.5, width / 2 - depth);
  const Point2 middle = ((range.x + range.y) / 2) * side;
  build_row(clip(ring, middle + half_gap * side, side), direction, scale, random, buildings);
  build_row(clip(ring, middle - half_gap * side, -1.0 * side), direction, scale, random, buildings);
}

/// One large building around a yard of its own.
bool build_around_courtyard(const Ring& ring, SeededRandom& random,
                            std::vector<SyntheticBuilding>& buildings) {
  Ring outer;
  Ring hole;
  for (const Point2 p : inset(ring, 4)) push(outer, p);
  for (const Point2 p : without_short_edges(inset(ring, 18), 4)) push(hole, p);
  if (hole.size() < 3 || area({hole, {}}) < 80) return false;
  std::reverse(hole.begin(), hole.end());
  buildings.push_back({{outer, {hole}}, storeys(5, random), SyntheticKind::kCourtyard});
  return true;
}

/// A rectangle in the frame of its block.
struct Plot {
  Point2 corner;  ///< South-west.
  double width = 0;
  double depth = 0;
};

/// Cuts the box of a block into plots of about the given size.
std::vector<Plot> plots_of(const Block& block, double width, double depth) {
  const Point2 up = left_of(block.axis);
  const Point2 along = extent(block.ring, block.axis);
  const Point2 across = extent(block.ring, up);
  const double columns = std::max(1.0, std::floor((along.y - along.x) / width + 0.25));
  const double rows = std::max(1.0, std::floor((across.y - across.x) / depth + 0.25));
  std::vector<Plot> plots;
  for (double j = 0; j < rows; ++j)
    for (double i = 0; i < columns; ++i)
      plots.push_back({(along.x + (along.y - along.x) * i / columns) * block.axis +
                           (across.x + (across.y - across.x) * j / rows) * up,
                       (along.y - along.x) / columns, (across.y - across.x) / rows});
  return plots;
}

/// Towers, some with a lower annex wall to wall, and slabs, on lawns.
void build_tower(const Block& block, const Plot& plot, SeededRandom& random,
                 std::vector<SyntheticBuilding>& buildings) {
  const Point2 up = left_of(block.axis);
  const bool tower = random.chance(0.45);
  const bool annex = random.chance(0.6);
  const double floors = std::floor(tower ? random.uniform(12, 22) : random.uniform(4, 8));
  const double height = storeys(floors, random);
  const double annex_height = storeys(2, random);
  const double annex_width = random.uniform(8, 12);
  constexpr int kTries = 12;
  for (int tries = 0; tries < kTries; ++tries) {
    // Ever smaller, for the corners of the block.
    const double shrink = 1 - 0.03 * tries;
    const double width = shrink * (tower ? random.uniform(16, 22) : random.uniform(26, 32));
    const double depth = shrink * (tower ? random.uniform(16, 21) : random.uniform(12, 14));
    const double right = random.uniform(1, 8);
    const double above = random.uniform(2, 12);
    const Ring main =
        rectangle(plot.corner + right * block.axis + above * up, block.axis, width, depth);
    if (right + width > plot.width - 1 || above + depth > plot.depth - 2 ||
        !fits(block.ring, main, 3))
      continue;
    add(buildings, main, height, SyntheticKind::kTower);
    Ring low = rectangle(plot.corner + (right + width) * block.axis + above * up, block.axis,
                         annex_width, depth);
    low[0] = main[1];
    low[3] = main[2];
    if (tower && annex && right + width + annex_width < plot.width - 1 && fits(block.ring, low, 3))
      add(buildings, low, annex_height, SyntheticKind::kRowHouse);
    return;
  }
}

/// A garage at the eastern wall of the house just built, which it shares: a house with a straight
/// wall gets the garage's corner as a vertex.
void build_garage(const Block& block, const Ring& box, bool bent, double width, double height,
                  std::vector<SyntheticBuilding>& buildings) {
  const Point2 end = on_mm(box[1] + 0.55 * (box[2] - box[1]));
  const Ring garage{box[1], on_mm(box[1] + width * block.axis), on_mm(end + width * block.axis),
                    end};
  if (!fits(block.ring, garage, 1)) return;
  Ring& house = buildings.back().footprint.outer;
  if (!bent) house.insert(house.begin() + 2, end);
  add(buildings, garage, height, SyntheticKind::kShed);
}

/// A house, sometimes with an L-shaped plan, and a garage wall to wall or a shed in the garden.
void build_villa(const Block& block, const Plot& plot, SeededRandom& random,
                 std::vector<SyntheticBuilding>& buildings) {
  const Point2 up = left_of(block.axis);
  const double width = random.uniform(0.5, 0.62) * std::min(plot.width, 20.0);
  const double depth = random.uniform(7.5, 10);
  const double height = round_to_mm(random.uniform(4.8, 8.6));
  const bool bent = random.chance(0.3);
  const bool garage = random.chance(0.3);
  const bool shed = random.chance(0.6);
  const double small_width = random.uniform(2.6, 4);
  const double small_depth = random.uniform(2.6, 4.5);
  const double gap = random.uniform(1.2, 2.5);
  const double small_height = round_to_mm(random.uniform(2.6, 3.2));
  if (random.chance(0.05)) return;
  constexpr int kTries = 6;
  for (int tries = 0; tries < kTries; ++tries) {
    const double right = random.uniform(0.5, plot.width - width - small_width - 0.5);
    const double above = random.uniform(1.5, std::max(2.0, plot.depth - depth - 6));
    const Point2 corner = plot.corner + right * block.axis + above * up;
    const Ring box = rectangle(corner, block.axis, width, depth);
    if (!fits(block.ring, box, 1.5)) continue;
    Ring house = box;
    if (bent) {
      const Point2 ridge = corner + 0.55 * width * block.axis;
      const Point2 rise = 0.55 * (box[2] - box[1]);
      house = {box[0], box[1], on_mm(box[1] + rise), on_mm(ridge + rise), on_mm(ridge + depth * up),
               box[3]};
    }
    add(buildings, house, height, SyntheticKind::kHouse);
    const Ring hut = rectangle(corner + (depth + gap) * up, block.axis, small_width, small_depth);
    if (garage) {
      build_garage(block, box, bent, small_width, small_height, buildings);
    } else if (shed && above + depth + gap + small_depth < plot.depth - 0.5 &&
               fits(block.ring, hut, 1)) {
      add(buildings, hut, small_height, SyntheticKind::kShed);
    }
    return;
  }
}

void build_detached(const Block& block, double scale, SeededRandom& random,
                    std::vector<SyntheticBuilding>& buildings) {
  if (block.kind == QuarterKind::kModern) {
    for (const Plot& plot : plots_of(block, 40, 33)) build_tower(block, plot, random, buildings);
  } else {
    for (const Plot& plot : plots_of(block, std::max(17 * scale, 14.0), 21))
      build_villa(block, plot, random, buildings);
  }
}

}  // namespace

bool has_room_for_courtyard(const Block& block) {
  const Ring yard = inset(block.ring, 18);
  return block.kind == QuarterKind::kPerimeter && !yard.empty() && area({yard, {}}) > 250;
}

void build_on_block(const Block& block, const PlotOptions& options, SeededRandom& random,
                    std::vector<SyntheticBuilding>& buildings) {
  if (block.kind == QuarterKind::kPark) return;
  if (block.kind != QuarterKind::kPerimeter) {
    build_detached(block, options.scale, random, buildings);
    return;
  }
  // Before the corners are cut, too: a short edge may hide a sharp corner.
  const Ring blunt = without_sharp_corners(without_short_edges(block.ring, kShortestEdge));
  const Ring ring = without_short_edges(blunt, kShortestEdge);
  if (ring.empty() || area({ring, {}}) < 150) return;
  if (options.around_a_courtyard && build_around_courtyard(ring, random, buildings)) return;
  const Ring yard = inset(ring, kGreatestDepth + 3);
  if (!yard.empty() && area({yard, {}}) > 30 &&
      build_perimeter(ring, block.axis, options.scale, random, buildings))
    return;
  build_rows(ring, block.axis, options.scale, random, buildings);
}

}  // namespace tetropolis
