#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "tetropolis/core/system_memory.h"
#include "tetropolis/core/threads.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/geo_place.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/run/run.h"
#include "tetropolis/synth/synthetic_city.h"

#include "core/step_clock.h"
#include "pipeline/memory.h"
#include "result_files.h"
#include "run_frame.h"
#include "synth/adversarial_city.h"
#include "synth_adversarial.h"

namespace tetropolis {

namespace {

/// Sizes below give no room for a city.
constexpr double kLeastRandomSize = 50;
constexpr double kLeastBlockSize = 300;
/// A village; larger ones are no harder.
constexpr double kLeastVillageSize = 100, kGreatestVillageSize = 1000;

/// The paper's 3096 buildings on 2.5 km, as densely on other squares.
std::int64_t usual_buildings(double size) {
  return std::max<std::int64_t>(1, std::llround(3096 * (size / 2500) * (size / 2500)));
}

void require_room(const Config& config) {
  const bool village = config.kind == SynthKind::kAdversarial;
  if (!village && !config.defects.empty())
    throw Error(ErrorKind::kUsage,
                "`defects`: cities of this kind have none; add `kind` adversarial");
  if (config.kind != SynthKind::kBlocks && config.roofs != SynthRoofs::kFlat)
    throw Error(ErrorKind::kUsage,
                "`roofs`: cities of this kind have level ones; add `kind` blocks");
  const double least = village                             ? kLeastVillageSize
                       : config.kind == SynthKind::kBlocks ? kLeastBlockSize
                                                           : kLeastRandomSize;
  if (config.size > 0 && config.size < least)
    throw Error(ErrorKind::kUsage,
                fmt::format("`size`: {} m is too small for a city of this kind; give {} or more",
                            config.size, least));
  if (village && config.size > kGreatestVillageSize)
    throw Error(ErrorKind::kUsage,
                fmt::format("`size`: {} m is too large for a city of this kind; give {} or less",
                            config.size, kGreatestVillageSize));
}

/// The side of the square: as asked for, or the kind's own.
double size_of(const Config& config) {
  if (config.size > 0) return config.size;
  switch (config.kind) {
    case SynthKind::kRandom:
      return RandomCityOptions{}.size;
    case SynthKind::kBlocks:
      return BlockCityOptions{}.size;
    case SynthKind::kAdversarial:
      return AdversarialCityOptions{}.size;
  }
  return 0;
}

SyntheticCity invent_city(const Config& config, double size, const Progress& progress) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  if (config.kind == SynthKind::kBlocks) {
    BlockCityOptions options;
    options.size = size;
    options.seed = seed;
    options.points_per_m2 = config.point_density;
    options.relief = config.relief < 0 ? options.relief : config.relief;
    options.buildings = config.buildings;
    options.sloped_roofs = config.roofs == SynthRoofs::kSloped;
    return synthetic_block_city(options, progress);
  }
  RandomCityOptions options;
  options.size = size;
  options.buildings = config.buildings > 0 ? config.buildings : usual_buildings(options.size);
  // A margin of 40 m would leave nothing of a small square.
  options.margin = std::min(options.margin, options.size / 5);
  options.seed = seed;
  options.points_per_m2 = config.point_density;
  options.relief = config.relief < 0 ? options.relief : config.relief;
  return synthetic_random_city(options, progress);
}

/// Blocks come about as many as asked for. Far fewer means that no more fit; far more, that plots
/// are as large as they get.
void warn_of_number(const Config& config, std::int64_t found, Report& report) {
  constexpr double kAbout = 0.1;
  if (config.buildings == 0) return;
  if (static_cast<double>(found) < (1 - kAbout) * config.buildings)
    report.warnings.push_back({"fewer_buildings", config.buildings - found,
                               fmt::format("only {} of {} buildings fit; give a larger `size`",
                                           found, config.buildings)});
  if (static_cast<double>(found) > (1 + kAbout) * config.buildings)
    report.warnings.push_back(
        {"more_buildings", found - config.buildings,
         fmt::format(
             "{} buildings, not {}: blocks of this `size` have no fewer; give a smaller one", found,
             config.buildings)});
}

/// Writes footprints.shp and points.laz of a city without defects, and fills the report.
void synth_plain(const Config& config, double size, OutputFolder& out, StepClock& clock,
                 Report& report) {
  const SyntheticCity city = clock.run("0.1", "invent the city", [&](const Progress& progress) {
    return invent_city(config, size, progress);
  });
  clock.run("0.2", "write footprints and points", [&](const Progress&) {
    write_footprints(out.result("footprints.shp", {"footprints.shx", "footprints.dbf"}),
                     city.footprints, city.ids, city.heights, city.origin, city.crs);
    WritePointsOptions options;
    options.crs = city.crs;
    write_points(out.result("points.laz"), city.points, city.origin, options);
    if (!city.truth.buildings.empty())
      write_city(out.result(results::kTruth), city.truth, "What was scanned");
  });
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin);
  InputFacts& input = report.input.emplace();
  input.points_kept = input.points_read = static_cast<std::int64_t>(city.points.size());
  for (const std::uint8_t code : city.points.classification) ++input.points_by_class[code];
  input.footprints_read = static_cast<std::int64_t>(city.footprints.size());
  warn_of_number(config, input.footprints_read, report);
}

}  // namespace

Report run_synth(const Config& config, const RunHooks& hooks) {
  require_in_range(config, kSynth);
  require_given({{!config.out.empty(), "out", "a folder for the results"}});
  require_room(config);
  const double size = size_of(config);
  require_scan_fits(size * size * config.point_density, usable_memory());
  const ThreadLimit limit(config.threads);
  Report report = begin_report("synth", config);
  StepClock clock(hooks, report.steps);
  OutputFolder out(config.out, hooks.output, Replaces::kAll, config.overwrite);
  std::vector<std::string> names{results::kReport};
  names.insert(names.end(), results::kOfSynth.begin(), results::kOfSynth.end());
  claim(out, names, config, hooks);
  const auto synth = config.kind == SynthKind::kAdversarial ? synth_adversarial : synth_plain;
  synth(config, size, out, clock, report);
  report.place = place_of(report.crs, report.domain);
  finish(report, out);
  return report;
}

}  // namespace tetropolis
