#include "find_ground.h"

#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tetropolis/terrain/ground_filter.h"
#include "tetropolis/terrain/outliers.h"

namespace tetropolis {

namespace {

bool is_wanted(const Config& config, const std::map<int, std::int64_t>& by_class) {
  if (config.ground_filter != GroundFilter::kAuto)
    return config.ground_filter == GroundFilter::kAlways;
  const GroundFilterOptions defaults;
  std::int64_t all = 0;
  for (const auto& [code, count] : by_class) all += count;
  // A stray point or two of a class do not make a classified cloud.
  const auto ground = by_class.find(kGround);
  return (ground == by_class.end() || ground->second < all / 1000) &&
         std::any_of(defaults.classes.begin(), defaults.classes.end(),
                     [&](std::uint8_t code) { return by_class.contains(code); });
}

void run_filter(const Config& config, InputData& input, StepClock& clock, Report& report) {
  GroundFilterOptions options;
  options.window = config.ground_filter_window;
  options.slope = config.ground_filter_slope;
  options.classes.push_back(kGround);
  std::span<std::uint8_t> classes = input.points.classification;
  std::int64_t before = 0;
  GroundFilterReport counts;
  clock.run("1.3", "find ground points", [&](const Progress& progress) {
    std::vector<Polygon> footprints;
    for (const Footprint& feature : input.footprints.features)
      footprints.push_back(feature.polygon);
    const std::vector<std::uint8_t> ground =
        filter_ground(input.points, footprints, options, progress, &counts);
    for (std::size_t p = 0; p < classes.size(); ++p) {
      before += classes[p] == kGround ? 1 : 0;
      if (ground[p] != 0)
        classes[p] = kGround;
      else if (classes[p] == kGround)
        classes[p] = kUnclassified;
    }
  });
  report.input->ground_filtered = counts.ground_points;
  report.warnings.push_back(
      {"ground_filtered", counts.ground_points,
       fmt::format("{}; a filter found {} of {} unclassified points on the ground",
                   before == 0 ? "the cloud has no class 2 (ground)"
                               : fmt::format("the class of {} ground points was ignored", before),
                   counts.ground_points, counts.candidates)});
}

/// Ground points that cannot be ground become noise.
void drop_ground_outliers(InputData& input, StepClock& clock, Report& report) {
  PointCloud& cloud = input.points;
  const std::vector<std::uint32_t> outliers = clock.run(
      "1.3", "ground outliers",
      [&](const Progress& progress) { return find_ground_outliers(cloud, {}, progress); });
  if (outliers.empty()) return;
  // Any of the two serves: nothing looks at noise. High noise says less about the depth.
  for (const std::uint32_t p : outliers) cloud.classification[p] = kHighNoise;
  report.input->ground_outliers = static_cast<std::int64_t>(outliers.size());
  const std::uint32_t first = outliers.front();
  report.warnings.push_back(
      {"ground_outliers", report.input->ground_outliers,
       fmt::format("ground points far above or below all others around them were left out, the "
                   "first at ({:.2f}, {:.2f}) with elevation {:.2f}",
                   cloud.x[first] + input.origin.x, cloud.y[first] + input.origin.y,
                   cloud.z[first])});
}

/// Names the file, which the terrain does not know.
void require_ground(const Config& config, const PointCloud& cloud, const Report& report) {
  const auto is_ground = [](std::uint8_t code) { return code == kGround || code == kWater; };
  const auto& codes = cloud.classification;
  if (std::any_of(codes.begin(), codes.end(), is_ground)) return;
  std::vector<std::string> parts;
  for (const auto& [code, count] : report.input->points_by_class)
    parts.push_back(fmt::format("class {} ({} points)", code, count));
  throw Error(ErrorKind::kInput,
              fmt::format("{}: no ground among the points, only {}; classify the ground (class 2), "
                          "or give unclassified points (0 or 1) to --ground-filter auto",
                          config.points.front(), fmt::join(parts, ", ")));
}

}  // namespace

void find_ground(const Config& config, InputData& input, StepClock& clock, Report& report) {
  if (is_wanted(config, report.input->points_by_class)) run_filter(config, input, clock, report);
  drop_ground_outliers(input, clock, report);
  require_ground(config, input.points, report);
}

}  // namespace tetropolis
