#include "tetropolis/pipeline/run.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <sys/resource.h>

#include "tetropolis/city/clearance.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/atomic_file.h"
#include "tetropolis/io/cityjson.h"
#include "tetropolis/io/crs.h"
#include "tetropolis/io/geotiff.h"
#include "tetropolis/io/las.h"
#include "tetropolis/io/vector.h"
#include "tetropolis/synth/adversarial_city.h"
#include "tetropolis/synth/synthetic_city.h"

#include "elevations.h"
#include "memory.h"
#include "require_metres.h"
#include "result_files.h"
#include "stages.h"
#include "synth_adversarial.h"
#include "synth_leftovers.h"

namespace tetropolis {

namespace {

void require(bool given, const char* option, const char* what) {
  if (!given) throw Error(ErrorKind::kUsage, fmt::format("{} is missing: {}", option, what));
}

Report begin_report(const char* command, const Config& config) {
  Report report;
  report.command = command;
  report.config = config;
  report.threads = thread_count();
  return report;
}

std::int64_t peak_rss_bytes() {
  // Of this program: what getrusage tells includes the caller's until it started this one.
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtoll(line.c_str() + 6, nullptr, 10) * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

/// Writes the report as the last file and makes the results appear. What goes wrong after that is
/// told by the report that is returned only.
void finish(Report& report, OutputFolder& out) {
  report.peak_rss_bytes = peak_rss_bytes();
  AtomicFile file(out.result(results::kReport));
  file.write(to_json(report));
  file.commit();
  out.commit();
  if (const auto& left = out.leftover())
    report.warnings.push_back(
        {"hidden_folder_left", 1,
         fmt::format("{}: cannot be removed: {}; the results are complete without it, remove it",
                     left->folder.string(), left->reason)});
}

void require_input(const Config& config) {
  require(!config.points.empty(), "--points", "name LAS or LAZ files or a folder of them");
  require(!config.footprints.empty() || config.terrain_only, "--footprints",
          "name a vector file with building footprints, or add --terrain-only");
  require(!config.out.empty(), "--out", "name a folder for the results");
}

/// Results never replace what the run reads.
void keep_inputs(const Config& config, OutputFolder& out) {
  for (const std::string& file : {config.footprints, config.city, config.dtm})
    if (!file.empty()) out.keep(file);
  for (const std::string& file : config.points) out.keep(file);
}

void keep_domain(const CityModel& city, Report& report) {
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin);
}

}  // namespace

Report run_build(const Config& config, const RunHooks& hooks) {
  require_input(config);
  memory_limit(config);  // so that a mistake in it is reported before the work
  const ThreadLimit limit(config.threads);
  Report report = begin_report("build", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output);
  keep_inputs(config, out);
  CityAndTerrain stage = make_city(config, Next::kMesh, out, clock, report);
  keep_domain(stage.city, report);
  make_mesh(config, stage.city, std::move(stage.dtm), out, clock, report);
  finish(report, out);
  return report;
}

Report run_city(const Config& config, const RunHooks& hooks) {
  require_input(config);
  memory_limit(config);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("city", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output);
  keep_inputs(config, out);
  const CityAndTerrain stage = make_city(config, Next::kNothing, out, clock, report);
  keep_domain(stage.city, report);
  finish(report, out);
  return report;
}

namespace {

/// The domain of a written city model and terrain, local frame: as given, as the model says, as the
/// terrain's file says, or all of the terrain.
Bounds2 domain_of(const Config& config, const CityModel& city, const RasterInput& terrain) {
  if (!config.bounds.empty())
    return {snap_coordinate(config.bounds[0] - city.origin.x),
            snap_coordinate(config.bounds[1] - city.origin.y),
            snap_coordinate(config.bounds[2] - city.origin.x),
            snap_coordinate(config.bounds[3] - city.origin.y)};
  if (!city.domain.empty() && city.domain.width() > 0) return city.domain;
  if (terrain.domain) return *terrain.domain;
  return terrain.raster.bounds();
}

/// Where a city's domain is, in its reference system, for messages.
std::string domain_text(const CityModel& city) {
  const Bounds2 domain = city.domain.moved(city.origin);
  return fmt::format("x {:.1f} .. {:.1f}, y {:.1f} .. {:.1f}", domain.xmin, domain.xmax,
                     domain.ymin, domain.ymax);
}

/// Whether the terrain is the city's: same reference system, and under all of the domain but for a
/// fringe of one step.
void require_terrain_under(const Config& config, const CityModel& city,
                           const RasterInput& terrain) {
  if (!city.crs.empty() && !terrain.crs.empty() && !same_horizontal_crs(city.crs, terrain.crs))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: the terrain is in {}, the city {} in {}", config.dtm,
                            crs_name(terrain.crs), config.city, crs_name(city.crs)));
  const Bounds2 covered = terrain.raster.bounds().grown(terrain.raster.step);
  if (!covered.contains({city.domain.xmin, city.domain.ymin}) ||
      !covered.contains({city.domain.xmax, city.domain.ymax}))
    throw Error(ErrorKind::kInput,
                fmt::format("{}: the terrain does not cover the domain, which is {}; give smaller "
                            "--bounds or another terrain",
                            config.dtm, domain_text(city)));
}

/// Warns where the terrain is not what the buildings stand on: heights of two vertical systems are
/// tens of metres apart. What the terrain rises and falls by under a building is no difference.
void warn_off_terrain(const Config& config, const CityModel& city, const Raster& terrain,
                      Report& report) {
  constexpr double kMostOff = 3;  // metres, of the median
  if (city.buildings.empty()) return;
  std::vector<double> above;
  for (const Building& building : city.buildings) {
    double low = sample(terrain, interior_point(building.footprint)), high = low;
    for (const Point2 p : building.footprint.outer) {
      const double z = sample(terrain, p);
      low = std::min(low, z);
      high = std::max(high, z);
    }
    above.push_back(building.h_ground - std::clamp(building.h_ground, low, high));
  }
  const auto off = std::count_if(above.begin(), above.end(),
                                 [](double height) { return std::abs(height) > kMostOff; });
  const double median = percentile(above, 50);
  if (std::abs(median) <= kMostOff) return;
  report.warnings.push_back(
      {"city_off_terrain", off,
       fmt::format(
           "{}: most buildings stand {:.1f} m {} this terrain (median of h_ground); are its "
           "heights of another vertical system than those of {}, or is it of another place?",
           config.dtm, std::abs(median), median > 0 ? "above" : "below", config.city)});
}

void require_elevations(const Config& config, const RasterInput& terrain) {
  const std::vector<double>& values = terrain.raster.values;
  const auto wrong = find_no_elevation(values);
  if (wrong == values.end()) return;
  const auto nx = static_cast<std::ptrdiff_t>(terrain.raster.nx);
  const std::ptrdiff_t node = wrong - values.begin();
  throw Error(ErrorKind::kInput,
              fmt::format("{}: {} in column {}, row {} is not an elevation; if it stands for a "
                          "missing value, declare it (gdal_edit.py -a_nodata {} {})",
                          config.dtm, *wrong, node % nx, terrain.raster.ny - 1 - node / nx, *wrong,
                          config.dtm));
}

/// A city model may come from anywhere; a mesh needs footprints that are valid and apart. Returns
/// their clearance.
double require_meshable(const Config& config, const CityModel& city) {
  std::vector<Polygon> footprints;
  for (const Building& building : city.buildings) footprints.push_back(building.footprint);
  const auto fail = [&](const std::string& what) {
    throw Error(
        ErrorKind::kInput,
        fmt::format("{}: {}; make it with 'tetropolis city', or lower --min-building-distance",
                    config.city, what));
  };
  for (const Building& building : city.buildings)
    for (const double height : {building.h_ground, building.h_roof})
      if (!(height >= kLowestTerrain && height <= kHighestTerrain))
        throw Error(
            ErrorKind::kInput,
            fmt::format("{}: building {} (feature {}) reaches from {:.6g} to {:.6g} m, which "
                        "are no elevations; correct or remove it",
                        config.city, building.id,
                        building.source_ids.empty() ? "?" : building.source_ids.front(),
                        building.h_ground, building.h_roof));
  for (const Building& building : city.buildings)
    if (!city.domain.covers(bounds(building.footprint)))
      throw Error(ErrorKind::kInput,
                  fmt::format("{}: building {} is not wholly in the domain, which is {}; give "
                              "larger --bounds, or make the city with these ('tetropolis city "
                              "--bounds ...')",
                              config.city, building.id, domain_text(city)));
  const auto defects = footprint_defects(footprints, 1);
  if (!defects.empty()) fail(defects.front().message);
  const Clearance clearance = joint_clearance(footprints, city.domain);
  if (!is_clear(clearance.distance, config.min_building_distance))
    fail(fmt::format(
        "footprints come as close as {:.4f} m ({} m required) at building {}", clearance.distance,
        config.min_building_distance,
        city.buildings[static_cast<std::size_t>(std::max(clearance.vertex.polygon, 0))].id));
  return clearance.distance;
}

}  // namespace

Report run_mesh(const Config& config, const RunHooks& hooks) {
  require(!config.city.empty(), "--city", "name a city model (.city.json)");
  require(!config.dtm.empty(), "--dtm", "name a terrain raster (.tif)");
  require(!config.out.empty(), "--out", "name a folder for the results");
  memory_limit(config);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("mesh", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output);
  keep_inputs(config, out);
  // Beside the city model that is meshed, the one it was made from is no leftover.
  out.keep(std::filesystem::path(config.city).parent_path() / results::kRawCity);
  CityModel city = read_city(config.city, &report.warnings);
  require_metres(city.crs, config.city);
  RasterInput terrain = read_raster(config.dtm, city.origin);
  report.warnings.insert(report.warnings.end(), terrain.warnings.begin(), terrain.warnings.end());
  require_metres(terrain.crs, config.dtm);
  require_heights_in_metres(terrain.height_unit, config.dtm, nullptr);
  require_elevations(config, terrain);
  city.domain = domain_of(config, city, terrain);
  require_terrain_under(config, city, terrain);
  if (city.buildings.empty() && !config.terrain_only) {
    const std::string why =
        city.dropped.empty()
            ? ""
            : fmt::format(" ({} dropped, the first, {}: {})", city.dropped.size(),
                          city.dropped.front().source_id, city.dropped.front().reason);
    throw Error(ErrorKind::kInput, config.city + ": holds no building" + why +
                                       "; add --terrain-only for a mesh of the terrain");
  }
  CityReport& city_report = report.city.emplace();
  city_report.min_clearance = require_meshable(config, city);
  warn_off_terrain(config, city, terrain.raster, report);
  city_report.raw_buildings = city_report.buildings =
      static_cast<std::int64_t>(city.buildings.size());
  for (const Building& building : city.buildings)
    city_report.merged_groups += building.source_ids.size() > 1 ? 1 : 0;
  city_report.dropped = city.dropped;
  keep_domain(city, report);
  make_mesh(config, city, std::move(terrain.raster), out, clock, report);
  finish(report, out);
  return report;
}

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
                "--defects: cities of this kind have none; add --kind adversarial");
  const double least = village                             ? kLeastVillageSize
                       : config.kind == SynthKind::kBlocks ? kLeastBlockSize
                                                           : kLeastRandomSize;
  if (config.size > 0 && config.size < least)
    throw Error(ErrorKind::kUsage,
                fmt::format("--size: {} m is too small for a city of this kind; give {} or more",
                            config.size, least));
  if (village && config.size > kGreatestVillageSize)
    throw Error(ErrorKind::kUsage,
                fmt::format("--size: {} m is too large for a city of this kind; give {} or less",
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

/// finish() for a city that may replace one of another kind, with files of other names.
void finish_city(Report& report, OutputFolder& out) {
  const auto outdated = left_by_earlier_city(report.config.out, out / "");
  finish(report, out);
  std::error_code ignored;
  for (const std::filesystem::path& file : outdated) std::filesystem::remove(file, ignored);
}

}  // namespace

Report run_synth(const Config& config, const RunHooks& hooks) {
  require(!config.out.empty(), "--out", "name a folder for the results");
  require_room(config);
  const double size = size_of(config);
  require_scan_fits(size * size * config.point_density);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("synth", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out, hooks.output);
  if (config.kind == SynthKind::kAdversarial) {
    synth_adversarial(config, size, out, clock, report);
    finish_city(report, out);
    return report;
  }
  const bool blocks = config.kind == SynthKind::kBlocks;
  const SyntheticCity city = clock.run("0.1", "invent the city", [&](const Progress& progress) {
    const auto seed = static_cast<std::uint64_t>(config.seed);
    if (blocks) {
      BlockCityOptions options;
      options.size = size;
      options.seed = seed;
      options.points_per_m2 = config.point_density;
      options.relief = config.relief < 0 ? options.relief : config.relief;
      options.buildings = config.buildings;
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
  });
  clock.run("0.2", "write footprints and points", [&](const Progress&) {
    write_footprints(out.result("footprints.shp", {"footprints.shx", "footprints.dbf"}),
                     city.footprints, city.ids, city.heights, city.origin, city.crs);
    WritePointsOptions options;
    options.crs = city.crs;
    write_points(out.result("points.laz"), city.points, city.origin, options);
  });
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin);
  report.input = InputReport{};
  report.input->points_kept = report.input->points_read =
      static_cast<std::int64_t>(city.points.size());
  for (const std::uint8_t code : city.points.classification) ++report.input->points_by_class[code];
  report.input->footprints_read = static_cast<std::int64_t>(city.footprints.size());
  // Blocks come about as dense as asked; far fewer than asked means that no more fit.
  if (report.input->footprints_read < 0.8 * config.buildings)
    report.warnings.push_back({"fewer_buildings", config.buildings - report.input->footprints_read,
                               fmt::format("only {} of {} buildings fit; give a larger --size",
                                           report.input->footprints_read, config.buildings)});
  finish_city(report, out);
  return report;
}

}  // namespace tetropolis
