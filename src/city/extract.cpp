#include "tetropolis/city/extract.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/heights.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"

#include "city/radius_search.h"
#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "core/shared_progress.h"
#include "core/sort_once.h"
#include "footprint_index.h"
#include "tree_crowns.h"

namespace tetropolis {

namespace {

constexpr std::size_t kPointGrain = std::size_t{1} << 15;
constexpr std::size_t kPointBatch = std::size_t{1} << 22;  // Between two reports of progress.
constexpr std::size_t kBuildingGrain = 64;

/// Metres from a building in which trees are looked for, and from a wall to what is no part of it.
constexpr double kAround = 3.0;
constexpr double kWall = 0.7;  // eaves and the scatter of footprints
/// Metres from a building in which the roofs of others are looked at.
constexpr double kBeside = 2.0;

/// What roofs and the ground are made of.
struct Classes {
  ClassTable roof{};
  ClassTable ground{};
  bool by_exclusion = false;
};

Classes classes_of(bool by_exclusion) {
  Classes classes;
  classes.ground[kGround] = classes.ground[kWater] = true;
  classes.by_exclusion = by_exclusion;
  if (by_exclusion) {
    for (std::size_t code = 0; code < classes.roof.size(); ++code)
      classes.roof[code] = may_be_roof(static_cast<std::uint8_t>(code));
  } else {
    classes.roof[kBuildingClass] = true;
  }
  return classes;
}

bool has_building_class(const PointCloud& cloud, std::size_t buildings) {
  const std::size_t of_buildings = parallel_reduce_ordered(
      cloud.size(), kPointGrain, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        const auto* codes = cloud.classification.data();
        return static_cast<std::size_t>(std::count(codes + begin, codes + end, kBuildingClass));
      },
      [](std::size_t a, std::size_t b) { return a + b; });
  // Stray points of a class do not make a classified cloud. (What is unclassified within a
  // classified cloud is found file by file, by a finer share: see unclassified_files.h.)
  constexpr std::size_t kFew = 8, kShare = 1000;
  return of_buildings > 0 &&
         (of_buildings >= std::max(buildings, kFew) || of_buildings * kShare >= cloud.size());
}

/// A point found at a building.
struct Hit {
  BuildingIndex building;
  PointIndex point;
};

/// Hits of a chunk of points, in their order. They stay in their chunks until they are lists: put
/// together first, there would be two or three of each for a while.
struct Hits {
  std::vector<Hit> roof;
  std::vector<Hit> ground;
  std::vector<Hit> ground_inside;  ///< By exclusion only.
};

Hits find_hits(const FootprintIndex& index, const PointCloud& cloud, const Classes& classes,
               std::size_t begin, std::size_t end) {
  Hits hits;
  for (std::size_t p = begin; p < end; ++p) {
    const std::uint8_t code = cloud.classification[p];
    const bool roof = classes.roof[code];
    const bool ground = classes.ground[code];
    if (!roof && !ground) continue;
    index.at({cloud.x[p], cloud.y[p]}, [&](BuildingIndex building, bool inside) {
      const Hit hit{building, static_cast<PointIndex>(p)};
      if (inside && roof) hits.roof.push_back(hit);
      if (!inside && ground) hits.ground.push_back(hit);
      if (inside && ground && classes.by_exclusion) hits.ground_inside.push_back(hit);
    });
  }
  for (std::vector<Hit>* list : {&hits.roof, &hits.ground, &hits.ground_inside})
    list->shrink_to_fit();
  return hits;
}

/// All hits, chunk by chunk. Batches of points one after another, the chunks of a batch in
/// parallel.
std::vector<Hits> find_all_hits(const FootprintIndex& index, const PointCloud& cloud,
                                const Classes& classes, const Progress& progress) {
  std::vector<Hits> chunks((cloud.size() + kPointGrain - 1) / kPointGrain);
  for (std::size_t start = 0; start < cloud.size(); start += kPointBatch) {
    progress.update(static_cast<double>(start) / static_cast<double>(cloud.size()));
    const std::size_t size = std::min(kPointBatch, cloud.size() - start);
    parallel_chunks(size, kPointGrain, [&](std::size_t begin, std::size_t end) {
      chunks[(start + begin) / kPointGrain] =
          find_hits(index, cloud, classes, start + begin, start + end);
    });
  }
  return chunks;
}

/// One kind of the hits of all chunks, which lose them. Points stay ascending.
template <typename Chunk>
PointLists take_lists(std::vector<Chunk>& chunks, std::vector<Hit> Chunk::*kind,
                      std::size_t buildings) {
  RaggedBuilder<PointIndex> lists(buildings);
  for (const Chunk& chunk : chunks)
    for (const Hit& hit : chunk.*kind) lists.count(hit.building);
  lists.start();
  for (Chunk& chunk : chunks) {
    for (const Hit& hit : chunk.*kind) lists.place(hit.building, hit.point);
    std::vector<Hit>().swap(chunk.*kind);
  }
  return lists.take();
}

/// Moves the points to keep to the front of a list, in order, and returns how many they are.
std::size_t keep_inliers(std::span<PointIndex> list, const PointCloud& cloud, double sigma) {
  if (list.empty()) return 0;
  const auto n = static_cast<double>(list.size());
  const double first = cloud.z[list[0]];  // sums of what is near 0 round less
  double sum = 0;
  for (const PointIndex p : list) sum += cloud.z[p] - first;
  const double mean = first + sum / n;
  double squares = 0;
  for (const PointIndex p : list) squares += (cloud.z[p] - mean) * (cloud.z[p] - mean);
  // What is at the limit, as one of five often is, stays.
  constexpr double kRounding = 1e-9;  // metres
  const double limit = sigma * std::sqrt(squares / n) + kRounding;
  const auto end = std::remove_if(
      list.begin(), list.end(), [&](PointIndex p) { return std::abs(cloud.z[p] - mean) > limit; });
  return static_cast<std::size_t>(end - list.begin());
}

/// Points that may be roof by their class, at each building they are near.
struct Surroundings {
  std::vector<Hit> around;  ///< In no footprint.
  std::vector<Hit> beside;  ///< In another footprint.
};

/// For the first `buildings` of the footprints, chunk by chunk.
std::vector<Surroundings> find_surroundings(std::span<const Polygon* const> footprints,
                                            std::size_t buildings, const PointCloud& cloud,
                                            const Classes& classes, const Progress& progress) {
  const FootprintIndex index(footprints, kAround);
  SharedProgress shared(progress, static_cast<std::int64_t>(cloud.size()));
  std::vector<Surroundings> chunks((cloud.size() + kPointGrain - 1) / kPointGrain);
  parallel_chunks(cloud.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    Surroundings& found = chunks[begin / kPointGrain];
    std::vector<BuildingIndex> near;
    for (std::size_t p = begin; p < end; ++p) {
      if (!classes.roof[cloud.classification[p]]) continue;
      near.clear();
      bool open = true, covered = false;
      const Point2 position{cloud.x[p], cloud.y[p]};
      index.at(position, [&](BuildingIndex building, bool inside) {
        covered = covered || inside;
        open = open && !inside && index.squared_distance(building, position) > kWall * kWall;
        if (!inside && building < buildings) near.push_back(building);
      });
      for (const BuildingIndex building : near) {
        const Hit hit{building, static_cast<PointIndex>(p)};
        if (open) found.around.push_back(hit);
        if (covered && index.squared_distance(building, position) <= kBeside * kBeside)
          found.beside.push_back(hit);
      }
    }
    found.around.shrink_to_fit();
    found.beside.shrink_to_fit();
    shared.add(static_cast<std::int64_t>(end - begin));
  });
  return chunks;
}

/// What is higher than the ground around the building, so not the floor of a yard in it. Where that
/// is little, it is the ground that is not to be trusted, and all is returned.
std::vector<PointIndex> above_ground(std::span<const PointIndex> roof,
                                     std::span<const PointIndex> ground, const PointCloud& cloud) {
  constexpr double kClearance = 0.5;  // metres
  constexpr double kLow = 10;         // percentile
  std::vector<PointIndex> kept(roof.begin(), roof.end());
  if (ground.empty()) return kept;
  std::vector<double> heights;
  for (const PointIndex p : ground) heights.push_back(cloud.z[p]);
  const double least = percentile(heights, kLow) + kClearance;
  std::erase_if(kept, [&](PointIndex p) { return cloud.z[p] <= least; });
  if (2 * kept.size() < roof.size()) kept.assign(roof.begin(), roof.end());
  return kept;
}

void drop_low_points(PointLists& roof, const PointLists& ground, const PointCloud& cloud) {
  std::vector<std::vector<PointIndex>> kept(roof.size());
  parallel_chunks(kept.size(), kBuildingGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) kept[b] = above_ground(roof[b], ground[b], cloud);
  });
  roof = ragged_from_lists(kept);
}

/// Of the first `buildings` of the footprints.
BuildingPoints find_points(std::span<const Polygon* const> footprints, std::size_t buildings,
                           const PointCloud& cloud, bool by_exclusion,
                           const ExtractOptions& options, const Progress& progress) {
  const FootprintIndex index(footprints.first(buildings), options.margin);
  const Classes classes = classes_of(by_exclusion);
  const bool find_crowns = by_exclusion && options.drop_tree_crowns;
  std::vector<Hits> hits =
      find_all_hits(index, cloud, classes, portion(progress, 0, find_crowns ? 0.4 : 0.9));
  BuildingPoints points;
  points.roof = take_lists(hits, &Hits::roof, buildings);
  points.ground = take_lists(hits, &Hits::ground, buildings);
  points.by_exclusion.assign(buildings, by_exclusion ? 1 : 0);
  if (by_exclusion) drop_low_points(points.roof, points.ground, cloud);
  if (find_crowns) {
    std::vector<Surroundings> found =
        find_surroundings(footprints, buildings, cloud, classes, portion(progress, 0.4, 0.7));
    drop_tree_crowns(points.roof,
                     {take_lists(hits, &Hits::ground_inside, buildings),
                      take_lists(found, &Surroundings::around, buildings),
                      take_lists(found, &Surroundings::beside, buildings)},
                     cloud, portion(progress, 0.7, 0.9));
  }
  drop_outliers(points.roof, cloud, options.sigma);
  drop_outliers(points.ground, cloud, options.sigma);
  return points;
}

/// Per footprint, the points of `ranges` inside, whatever their class.
std::vector<std::uint32_t> count_inside(std::span<const Polygon* const> footprints,
                                        const PointCloud& cloud, std::span<const PointRange> ranges,
                                        const Progress& progress) {
  std::vector<std::uint32_t> inside_of(footprints.size(), 0);
  const FootprintIndex index(footprints, 0);
  std::int64_t all = 0;
  for (const PointRange& range : ranges) all += static_cast<std::int64_t>(range.end - range.begin);
  SharedProgress shared(progress, all);
  for (const PointRange& range : ranges)
    parallel_chunks(range.end - range.begin, kPointGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = range.begin + begin; p < range.begin + end; ++p)
        index.at({cloud.x[p], cloud.y[p]}, [&](BuildingIndex building, bool inside) {
          if (inside) std::atomic_ref(inside_of[building]).fetch_add(1, std::memory_order_relaxed);
        });
      shared.add(static_cast<std::int64_t>(end - begin));
    });
  return inside_of;
}

/// The buildings, ascending, that have more points of `ranges` inside than in `roof`.
std::vector<BuildingIndex> find_unclassified(std::span<const Polygon* const> footprints,
                                             const PointLists& roof, const PointCloud& cloud,
                                             std::span<const PointRange> ranges,
                                             const Progress& progress) {
  const std::vector<std::uint32_t> inside_of = count_inside(footprints, cloud, ranges, progress);
  std::vector<BuildingIndex> result;
  for (std::size_t b = 0; b < footprints.size(); ++b)
    if (inside_of[b] > roof[b].size()) result.push_back(BuildingIndex(b));
  return result;
}

/// Gives the roofs of `which` the points that are there by exclusion, if there are any and
/// accept(number in `which`, points) says so; `mark`: their by_exclusion.
template <typename Accept>
void take_by_exclusion(std::span<const Polygon* const> footprints,
                       std::span<const BuildingIndex> which, const PointCloud& cloud,
                       const ExtractOptions& options, const Progress& progress, std::uint8_t mark,
                       const Accept& accept, BuildingPoints& points) {
  std::vector<const Polygon*> order;
  for (const BuildingIndex b : which) order.push_back(footprints[b]);
  std::size_t next = 0;
  for (std::size_t f = 0; f < footprints.size(); ++f)
    if (next < which.size() && which[next] == f)
      ++next;
    else
      order.push_back(footprints[f]);
  const BuildingPoints found = find_points(order, which.size(), cloud, true, options, progress);
  PointLists roof;
  next = 0;
  for (std::size_t b = 0; b < points.roof.size(); ++b) {
    std::span<const PointIndex> row = points.roof[b];
    if (next < which.size() && which[next] == b) {
      const std::span<const PointIndex> other = found.roof[next];
      if (!other.empty() && accept(next, other)) {
        points.by_exclusion[b] = mark;
        row = other;
      }
      ++next;
    }
    roof.push_back(row);
  }
  points.roof = std::move(roof);
}

constexpr std::size_t kFewRoofPoints = 4, kLeastOfCleanRoof = 10;

/// Whether points by exclusion are a roof beyond doubt; `inside`: of all points in the footprint.
bool is_clean_roof(const Polygon& footprint, std::span<const PointIndex> roof,
                   std::span<const PointIndex> ground, std::size_t inside,
                   const PointCloud& cloud) {
  constexpr double kAbove = 2;                           // metres
  constexpr double kLow = 10;                            // percentile
  constexpr double kLeastRadius = 1, kThickness = 0.25;  // metres
  constexpr double kEnough = 12;                         // points that say what a surface is
  constexpr double kOnSurfaces = 0.75;
  if (roof.size() < kLeastOfCleanRoof || 2 * roof.size() < inside || ground.empty()) return false;
  const auto height = [&](std::span<const PointIndex> list, double share) {
    std::vector<double> heights;
    for (const PointIndex p : list) heights.push_back(cloud.z[p]);
    return percentile(heights, share);
  };
  if (height(roof, 50) < height(ground, kLow) + kAbove) return false;
  const double radius = std::max(
      kLeastRadius,
      std::sqrt(kEnough * area(footprint) / (std::numbers::pi * static_cast<double>(roof.size()))));
  const RadiusSearch search({roof.begin(), roof.end()}, cloud, radius);
  std::size_t on_surfaces = 0;
  for (std::size_t k = 0; k < search.size(); ++k)
    on_surfaces += search.on_surface(k, kThickness / radius) ? 1 : 0;
  return static_cast<double>(on_surfaces) >= kOnSurfaces * static_cast<double>(roof.size());
}

/// Clean roofs that nobody has classified.
void take_clean_roofs(std::span<const Polygon* const> footprints, std::size_t buildings,
                      const PointCloud& cloud, const ExtractOptions& options,
                      const Progress& progress, BuildingPoints& points) {
  std::vector<const Polygon*> few;
  std::vector<BuildingIndex> numbers;
  for (std::size_t b = 0; b < buildings; ++b)
    if (points.roof[b].size() < kFewRoofPoints && points.by_exclusion[b] == 0) {
      few.push_back(footprints[b]);
      numbers.push_back(BuildingIndex(b));
    }
  if (few.empty()) return;
  const PointRange everything{0, cloud.size()};
  const std::vector<std::uint32_t> counts =
      count_inside(few, cloud, {&everything, 1}, portion(progress, 0, 0.3));
  std::vector<BuildingIndex> which;
  std::vector<std::size_t> inside;
  for (std::size_t k = 0; k < few.size(); ++k) {
    if (counts[k] < kLeastOfCleanRoof) continue;
    which.push_back(numbers[k]);
    inside.push_back(counts[k]);
  }
  if (which.empty()) return;
  const PointLists ground = points.ground;
  take_by_exclusion(
      footprints, which, cloud, options, portion(progress, 0.3, 1), 2,
      [&](std::size_t number, std::span<const PointIndex> roof) {
        const BuildingIndex b = which[number];
        return is_clean_roof(*footprints[b], roof, ground[b], inside[number], cloud);
      },
      points);
}

BuildingPoints extract(std::span<const Polygon* const> footprints, std::size_t buildings,
                       const PointCloud& cloud, const ExtractOptions& options,
                       const Progress& progress) {
  if (cloud.size() > std::numeric_limits<PointIndex>::max())
    throw Error(ErrorKind::kInput,
                fmt::format("the point cloud has {} points, more than 2^32 - 1: choose a smaller "
                            "domain",
                            cloud.size()));
  const bool by_exclusion = options.roof_points == RoofPoints::kAuto
                                ? !has_building_class(cloud, buildings)
                                : options.roof_points == RoofPoints::kExclusion;
  BuildingPoints points = find_points(footprints, buildings, cloud, by_exclusion, options,
                                      portion(progress, 0, by_exclusion ? 1 : 0.6));
  if (!by_exclusion && !options.no_buildings.empty()) {
    const std::vector<BuildingIndex> unclassified =
        find_unclassified(footprints.first(buildings), points.roof, cloud, options.no_buildings,
                          portion(progress, 0.6, 0.65));
    if (!unclassified.empty())
      take_by_exclusion(
          footprints, unclassified, cloud, options, portion(progress, 0.65, 0.8), 1,
          [](std::size_t, std::span<const PointIndex>) { return true; }, points);
  }
  if (!by_exclusion)
    take_clean_roofs(footprints, buildings, cloud, options, portion(progress, 0.8, 1), points);
  progress.update(1);
  return points;
}

PointLists merge_lists(const PointLists& lists,
                       std::span<const std::vector<BuildingIndex>> members) {
  std::vector<std::vector<PointIndex>> merged(members.size());
  parallel_chunks(members.size(), kBuildingGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      std::vector<PointIndex>& list = merged[m];
      for (const BuildingIndex member : members[m]) {
        const std::span<const PointIndex> more = lists[member];
        list.insert(list.end(), more.begin(), more.end());
      }
      sort_once(list);
    }
  });
  return ragged_from_lists(merged);
}

}  // namespace

BuildingPoints extract_building_points(std::span<const Polygon> footprints, const PointCloud& cloud,
                                       const ExtractOptions& options, const Progress& progress) {
  return extract(pointers_to(footprints), footprints.size(), cloud, options, progress);
}

BuildingPoints extract_building_points(std::span<const Building> buildings,
                                       std::span<const Polygon> others, const PointCloud& cloud,
                                       const ExtractOptions& options, const Progress& progress) {
  std::vector<const Polygon*> pointers;
  pointers.reserve(buildings.size() + others.size());
  for (const Building& building : buildings) pointers.push_back(&building.footprint);
  for (const Polygon& footprint : others) pointers.push_back(&footprint);
  return extract(pointers, buildings.size(), cloud, options, progress);
}

void drop_outliers(PointLists& lists, const PointCloud& cloud, double sigma) {
  const std::size_t buildings = lists.size();
  std::vector<std::size_t> kept(buildings);
  parallel_chunks(buildings, kBuildingGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) kept[b] = keep_inliers(lists[b], cloud, sigma);
  });
  std::int64_t end = 0;
  for (std::size_t b = 0; b < buildings; ++b) {
    const auto first = lists.values.begin() + lists.offsets[b];
    lists.offsets[b] = end;
    std::copy(first, first + static_cast<std::ptrdiff_t>(kept[b]), lists.values.begin() + end);
    end += static_cast<std::int64_t>(kept[b]);
  }
  lists.offsets.back() = end;
  lists.values.resize(static_cast<std::size_t>(end));
}

BuildingPoints merge_building_points(const BuildingPoints& points,
                                     std::span<const std::vector<BuildingIndex>> members) {
  BuildingPoints merged{merge_lists(points.roof, members), merge_lists(points.ground, members), {}};
  for (const std::vector<BuildingIndex>& sources : members) {
    std::uint8_t mark = 0;
    for (const BuildingIndex source : sources) {
      const auto s = static_cast<std::size_t>(source);
      if (!points.roof[s].empty()) mark = std::max(mark, points.by_exclusion[s]);
    }
    merged.by_exclusion.push_back(mark);
  }
  return merged;
}

}  // namespace tetropolis
