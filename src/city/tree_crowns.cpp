#include "tree_crowns.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "city/radius_search.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/shared_progress.h"

namespace tetropolis {

namespace {

/// Metres around a point that are looked at; less where thirty points lie within a smaller radius,
/// on average over the building's box.
constexpr double kRadius = 1;
constexpr double kShare = 0.2;       // of the points around, those that must lie lower,
constexpr double kHeight = 1.5;      // metres: by how much,
constexpr double kFringe = 1;        // and for a point beside such a one
constexpr double kThickness = 0.15;  // of a surface, as a share of the radius
/// Points of trees around a building, as a share of its roof points, up to which nothing is taken
/// for crowns.
constexpr double kClearing = 0.05;

constexpr double kTreeHeight = 2.5;     // metres above a building's lowest point
constexpr double kTallerTree = 3;       // metres that a crown may be higher than those around
constexpr double kSurfaceShare = 0.5;   // of neighbours on surfaces, at most, in crowns
constexpr double kRemainder = 0.15;     // of a list that is too little to be a roof
constexpr double kOpenRemainder = 0.5;  // the same where much ground is seen inside
constexpr double kOpenGround = 0.2;     // share of points that is much

/// Per point, the quantile kShare of the heights around it.
std::vector<double> levels(const RadiusSearch& search) {
  std::vector<double> result(search.size());
  std::vector<double> heights;
  for (std::size_t k = 0; k < search.size(); ++k) {
    heights.clear();
    search.in_radius(k, [&](std::size_t other) { heights.push_back(search.z(other)); });
    const auto rank = static_cast<std::size_t>(static_cast<double>(heights.size()) * kShare);
    const auto nth = heights.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(heights.begin(), nth, heights.end());
    result[k] = *nth;
  }
  return result;
}

/// The points of one building, and what is known of their surroundings.
struct Scene {
  std::span<const PointIndex> roof, below, around, beside;
};

/// An outline of what is under the ground or gone, if what else stands in it are trees.
bool is_mostly_ground(std::span<const PointIndex> roof, std::span<const PointIndex> below) {
  return below.size() > roof.size();
}

/// How far each roof point is above the highest level around it; minus infinity where something
/// says that it belongs to a building.
std::vector<double> overhangs(const Scene& scene, const RadiusSearch& search,
                              const PointCloud& cloud) {
  constexpr double kNone = -kInfinity;
  // Trees in an open outline need not have others beside it.
  double treetops = is_mostly_ground(scene.roof, scene.below) ? -kNone : kNone;
  for (const PointIndex p : scene.around) treetops = std::max<double>(treetops, cloud.z[p]);
  const std::vector<double> level = levels(search);
  std::vector<std::uint8_t> surface(search.size());
  for (std::size_t k = 0; k < search.size(); ++k)
    surface[k] = search.on_surface(k, kThickness) ? 1 : 0;
  const std::size_t first_beside = scene.roof.size() + scene.below.size();
  std::vector<double> result(scene.roof.size(), kNone);
  for (std::size_t k = 0; k < result.size(); ++k) {
    if (search.z(k) > treetops + kTallerTree) continue;
    double highest = level[k];
    int as_high = 0, on_roofs = 0;  // of points of roofs beside
    search.in_radius(k, [&](std::size_t other) {
      highest = std::max(highest, level[other]);
      if (other < first_beside || search.z(other) < search.z(k) - kHeight) return;
      ++as_high;
      on_roofs += surface[other];
    });
    if (on_roofs > kSurfaceShare * as_high) continue;
    int near = 0, on_surfaces = 0;
    search.near(k, [&](std::size_t other) {
      ++near;
      on_surfaces += surface[other];
    });
    if (on_surfaces <= kSurfaceShare * near) result[k] = search.z(k) - highest;
  }
  return result;
}

std::vector<PointIndex> without_tree_crowns(const Scene& scene, const PointCloud& cloud) {
  const std::span<const PointIndex> roof = scene.roof, below = scene.below;
  std::vector<PointIndex> all(roof.begin(), roof.end());
  all.insert(all.end(), below.begin(), below.end());
  all.insert(all.end(), scene.beside.begin(), scene.beside.end());
  const RadiusSearch search(std::move(all), cloud, kRadius);
  const std::vector<double> overhang = overhangs(scene, search, cloud);
  const auto is_crown = [&](std::size_t k) { return k < roof.size() && overhang[k] > kHeight; };
  const auto is_fringe = [&](std::size_t k) {
    bool found = false;
    if (overhang[k] > kFringe)
      search.in_radius(k, [&](std::size_t other) { found = found || is_crown(other); });
    return found;
  };
  std::vector<PointIndex> kept;
  for (std::size_t k = 0; k < roof.size(); ++k)
    if (!is_crown(k) && !is_fringe(k)) kept.push_back(roof[k]);
  // Chance makes surfaces in crowns too; where nearly all goes, so does the rest.
  const auto n = static_cast<double>(roof.size());
  const auto ground = static_cast<double>(below.size());
  const bool is_open = ground > kOpenGround * (ground + n);
  if (static_cast<double>(kept.size()) < (is_open ? kOpenRemainder : kRemainder) * n) return {};
  return kept;
}

bool has_trees_around(std::span<const PointIndex> roof, std::span<const PointIndex> around,
                      const PointCloud& cloud) {
  if (roof.empty()) return false;
  double lowest = cloud.z[roof[0]];
  for (const PointIndex p : roof) lowest = std::min<double>(lowest, cloud.z[p]);
  const auto high = std::count_if(around.begin(), around.end(),
                                  [&](PointIndex p) { return cloud.z[p] > lowest + kTreeHeight; });
  return static_cast<double>(high) > kClearing * static_cast<double>(roof.size());
}

}  // namespace

void drop_tree_crowns(PointLists& roof, const CrownEvidence& evidence, const PointCloud& cloud,
                      const Progress& progress) {
  assert(roof.size() == evidence.below.size() && roof.size() == evidence.around.size() &&
         roof.size() == evidence.beside.size());
  std::vector<std::vector<PointIndex>> kept(roof.size());
  SharedProgress shared(progress, static_cast<std::int64_t>(roof.size()));
  parallel_chunks(roof.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (is_mostly_ground(roof[b], evidence.below[b]) ||
          has_trees_around(roof[b], evidence.around[b], cloud))
        kept[b] = without_tree_crowns(
            {roof[b], evidence.below[b], evidence.around[b], evidence.beside[b]}, cloud);
      else
        kept[b].assign(roof[b].begin(), roof[b].end());
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  roof = ragged_from_lists(kept);
}

}  // namespace tetropolis
