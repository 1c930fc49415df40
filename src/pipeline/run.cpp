#include "tetropolis/pipeline/run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <optional>

#include "stages.h"
#include "tetropolis/city/synthetic.h"
#include "tetropolis/core/parallel.h"
#include "tetropolis/io/atomic_file.h"
#include "tetropolis/io/cityjson.h"
#include "tetropolis/io/geotiff.h"
#include "tetropolis/io/las.h"
#include "tetropolis/io/vector.h"

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
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

/// Writes the report as the last file and makes the results appear.
void finish(Report& report, OutputFolder& out) {
  report.peak_rss_bytes = peak_rss_bytes();
  AtomicFile file(out / "report.json");
  file.write(to_json(report));
  file.commit();
  out.commit();
}

void require_input(const Config& config) {
  require(!config.points.empty(), "--points", "name LAS or LAZ files or a folder of them");
  require(!config.footprints.empty() || config.terrain_only, "--footprints",
          "name a vector file with building footprints, or add --terrain-only");
  require(!config.out.empty(), "--out", "name a folder for the results");
}

void keep_domain(const CityModel& city, Report& report) {
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = {city.domain.xmin + city.origin.x, city.domain.ymin + city.origin.y,
                   city.domain.xmax + city.origin.x, city.domain.ymax + city.origin.y};
}

}  // namespace

Report run_build(const Config& config, const RunHooks& hooks) {
  require_input(config);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("build", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out);
  const CityAndTerrain stage = make_city(config, out, clock, report);
  keep_domain(stage.city, report);
  make_mesh(config, stage.city, stage.dtm, out, clock, report);
  finish(report, out);
  return report;
}

Report run_city(const Config& config, const RunHooks& hooks) {
  require_input(config);
  const ThreadLimit limit(config.threads);
  Report report = begin_report("city", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out);
  const CityAndTerrain stage = make_city(config, out, clock, report);
  keep_domain(stage.city, report);
  finish(report, out);
  return report;
}

Report run_mesh(const Config& config, const RunHooks& hooks) {
  require(!config.city.empty(), "--city", "name a city model (.city.json)");
  require(!config.dtm.empty(), "--dtm", "name a terrain raster (.tif)");
  require(!config.out.empty(), "--out", "name a folder for the results");
  const ThreadLimit limit(config.threads);
  Report report = begin_report("mesh", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out);
  CityModel city = read_city(config.city);
  RasterInput terrain = read_raster(config.dtm, city.origin);
  report.warnings.insert(report.warnings.end(), terrain.warnings.begin(), terrain.warnings.end());
  if (!config.bounds.empty())
    city.domain = {snap_coordinate(config.bounds[0] - city.origin.x),
                   snap_coordinate(config.bounds[1] - city.origin.y),
                   snap_coordinate(config.bounds[2] - city.origin.x),
                   snap_coordinate(config.bounds[3] - city.origin.y)};
  else if (terrain.domain)
    city.domain = *terrain.domain;
  else if (city.domain.empty() || city.domain.width() == 0)
    city.domain = terrain.raster.bounds();
  keep_domain(city, report);
  make_mesh(config, city, terrain.raster, out, clock, report);
  finish(report, out);
  return report;
}

Report run_synth(const Config& config, const RunHooks& hooks) {
  require(!config.out.empty(), "--out", "name a folder for the results");
  const ThreadLimit limit(config.threads);
  Report report = begin_report("synth", config);
  StepClock clock(hooks, report);
  OutputFolder out(config.out);
  const bool blocks = config.kind == "blocks";
  const SyntheticCity city = clock.run("0.1", "invent the city", [&](const Progress& progress) {
    const auto seed = static_cast<std::uint64_t>(config.seed);
    if (blocks) {
      BlockCityOptions options;
      options.size = config.size > 0 ? config.size : options.size;
      options.seed = seed;
      options.points_per_m2 = config.point_density;
      options.relief = config.relief < 0 ? options.relief : config.relief;
      options.buildings = config.buildings;
      return synthetic_block_city(options, progress);
    }
    RandomCityOptions options;
    options.buildings = config.buildings > 0 ? config.buildings : 3096;
    options.size = config.size > 0 ? config.size : options.size;
    options.seed = seed;
    options.points_per_m2 = config.point_density;
    options.relief = config.relief < 0 ? options.relief : config.relief;
    return synthetic_random_city(options, progress);
  });
  clock.run("0.2", "write footprints and points", [&](const Progress&) {
    write_footprints(out / "footprints.shp", city.footprints, city.ids, city.heights, city.origin,
                     city.crs);
    WritePointsOptions options;
    options.crs = city.crs;
    write_points(out / "points.laz", city.points, city.origin, options);
  });
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = {city.domain.xmin + city.origin.x, city.domain.ymin + city.origin.y,
                   city.domain.xmax + city.origin.x, city.domain.ymax + city.origin.y};
  report.input = InputReport{};
  report.input->points_kept = report.input->points_read =
      static_cast<std::int64_t>(city.points.size());
  for (const std::uint8_t code : city.points.classification) ++report.input->points_by_class[code];
  report.input->footprints_read = static_cast<std::int64_t>(city.footprints.size());
  finish(report, out);
  return report;
}

}  // namespace tetropolis
