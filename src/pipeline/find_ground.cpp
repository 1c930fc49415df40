#include "find_ground.h"

#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/terrain/ground_filter.h"

#include "core/parallel.h"
#include "terrain/ground_outliers.h"
#include "unclassified_files.h"

namespace tetropolis {

namespace {

/// Of all points.
bool is_wanted(const BuildCityOptions& options, const std::map<int, std::int64_t>& by_class) {
  if (options.ground_filter != GroundFilter::kAuto)
    return options.ground_filter == GroundFilter::kAlways;
  return !has_class(by_class, kGround, kStrayGround) && has_unclassified(by_class);
}

std::string describe(std::span<const FilePoints> files) {
  return files.size() == 1 ? fmt::format("{} has", files[0].path)
                           : fmt::format("{} and {} more have", files[0].path, files.size() - 1);
}

/// Of the points near the files only: what else there is may be large.
std::vector<std::uint8_t> filter_around(const CityInput& input, std::span<const FilePoints> files,
                                        std::span<const Polygon> footprints,
                                        const GroundFilterOptions& options,
                                        const Progress& progress) {
  // Of openings as wide as the window on both sides, what decides lies within twice that; the rest
  // is room for segments that reach further.
  constexpr double kWindows = 3;
  const std::vector<std::size_t> near =
      find_points_near(input, files, kWindows * options.window, portion(progress, 0, 0.2));
  PointCloud cloud;
  cloud.x.reserve(near.size());
  cloud.y.reserve(near.size());
  cloud.z.reserve(near.size());
  cloud.classification.reserve(near.size());
  for (const std::size_t p : near) {
    cloud.push_back(input.points.points.x[p], input.points.points.y[p], input.points.points.z[p],
                    input.points.points.classification[p]);
  }
  const std::vector<std::uint8_t> found =
      filter_ground(cloud, footprints, options, portion(progress, 0.2, 1));
  std::vector<std::uint8_t> ground(input.points.points.size(), 0);
  for (std::size_t k = 0; k < near.size(); ++k) ground[near[k]] = found[k];
  return ground;
}

/// Of all points, or of the files given.
void run_filter(GroundFilterOptions options, CityInput& input, std::span<const FilePoints> files,
                StepClock& clock, InputFacts& facts, std::vector<Warning>& warnings) {
  options.classes.push_back(kGround);
  const ClassTable candidates = class_table(options.classes);
  std::span<std::uint8_t> classes = input.points.points.classification;
  std::vector<PointRange> ranges;
  for (const FilePoints& file : files) ranges.push_back(file.kept);
  if (files.empty()) ranges.push_back({0, classes.size()});
  std::int64_t before = 0, after = 0, all = 0;
  clock.run("1.3", "find ground points", [&](const Progress& progress) {
    std::vector<Polygon> footprints;
    for (const Footprint& feature : input.footprints.features)
      if (!feature.is_planned) footprints.push_back(feature.polygon);
    const std::vector<std::uint8_t> ground =
        files.empty() ? filter_ground(input.points.points, footprints, options, progress)
                      : filter_around(input, files, footprints, options, progress);
    for (const PointRange& range : ranges)
      for (std::size_t p = range.begin; p < range.end; ++p) {
        before += classes[p] == kGround ? 1 : 0;
        after += ground[p];
        all += candidates[classes[p]] ? 1 : 0;
        if (ground[p] != 0)
          classes[p] = kGround;
        else if (classes[p] == kGround)
          classes[p] = kUnclassified;
      }
  });
  facts.ground_filtered = after;
  std::string why = "the cloud has no class 2 (ground)";
  if (!files.empty())
    why = describe(files) + " no class 2 (ground)";
  else if (before > 0)
    why = fmt::format("the class of {} ground points was ignored", before);
  warnings.push_back({"ground_filtered", after,
                      fmt::format("{}; a filter found {} of {} unclassified points on the ground",
                                  why, after, all)});
}

/// Ground points that cannot be ground become noise.
void drop_ground_outliers(CityInput& input, StepClock& clock, InputFacts& facts,
                          std::vector<Warning>& warnings) {
  PointCloud& cloud = input.points.points;
  const std::vector<std::uint32_t> outliers = clock.run(
      "1.3", "ground outliers",
      [&](const Progress& progress) { return find_ground_outliers(cloud, {}, progress); });
  if (outliers.empty()) return;
  // Any of the two serves: nothing looks at noise. High noise says less about the depth.
  for (const std::uint32_t p : outliers) cloud.classification[p] = kHighNoise;
  facts.ground_outliers = static_cast<std::int64_t>(outliers.size());
  const std::uint32_t first = outliers.front();
  warnings.push_back(
      {"ground_outliers", facts.ground_outliers,
       fmt::format("{} ground points far above or below all others around them were left out, the "
                   "first at ({:.2f}, {:.2f}) with elevation {:.2f}",
                   outliers.size(), cloud.x[first] + input.points.origin.x,
                   cloud.y[first] + input.points.origin.y, cloud.z[first])});
}

/// Names the file, which the terrain does not know.
void require_ground(const CityInput& input) {
  const PointsInput& points = input.points;
  const auto& codes = points.points.classification;
  if (std::any_of(codes.begin(), codes.end(), is_ground)) return;
  if (input.has_surface)
    throw Error(ErrorKind::kInput,
                fmt::format("{}: nothing in this surface is known as ground; give the terrain, "
                            "too, as `dtm`, or find the ground with ground_filter = auto",
                            points.source));
  std::vector<std::string> parts;
  for (const auto& [code, count] : points.points_by_class)
    parts.push_back(fmt::format("class {} ({} points)", code, count));
  throw Error(ErrorKind::kInput,
              fmt::format("{}: no ground among the points, only {}; classify the ground (class 2), "
                          "or give unclassified points (0 or 1) to ground_filter = auto",
                          points.source, fmt::join(parts, ", ")));
}

/// Where the terrain is known, what nobody has classified and lies on it is ground.
void find_on_terrain(const Raster& terrain, PointsInput& points) {
  constexpr double kNear = 0.5;  // metres
  PointCloud& cloud = points.points;
  const ClassTable candidates = class_table(GroundFilterOptions{}.classes);
  constexpr std::size_t kGrain = std::size_t{1} << 15;
  parallel_chunks(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      if (candidates[cloud.classification[p]] &&
          cloud.z[p] <= sample(terrain, {cloud.x[p], cloud.y[p]}) + kNear)
        cloud.classification[p] = kGround;
  });
}

/// Of a surface, whose cells have no class, what is no ground is what stands on it.
void class_surface(PointCloud& cloud) {
  for (std::uint8_t& code : cloud.classification)
    if (!is_ground(code) && code != kLowNoise && code != kHighNoise) code = kBuildingClass;
}

}  // namespace

void find_ground(const BuildCityOptions& options, CityInput& input, StepClock& clock,
                 InputFacts& facts, std::vector<Warning>& warnings) {
  if (input.terrain) {
    find_on_terrain(input.terrain->raster, input.points);
    if (input.has_surface) class_surface(input.points.points);
    return;
  }
  const std::vector<FilePoints> files = clock.run(
      "1.3", "find files without ground",
      [&](const Progress& progress) { return find_files_without_ground(input, progress); });
  input.no_buildings = find_ranges_without_buildings(input, files);
  if (is_wanted(options, input.points.points_by_class))
    run_filter(options.filter, input, {}, clock, facts, warnings);
  else if (!files.empty() && options.ground_filter == GroundFilter::kAuto)
    run_filter(options.filter, input, files, clock, facts, warnings);
  drop_ground_outliers(input, clock, facts, warnings);
  require_ground(input);
  if (input.has_surface) class_surface(input.points.points);
}

}  // namespace tetropolis
