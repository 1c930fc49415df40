#include "reported_run.h"

#include <cmath>
#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

#include "core/units.h"
#include "run/earlier_results.h"
#include "run/folders.h"
#include "run/result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Without "one/../", unless that leads elsewhere: the system follows links before "..".
fs::path shortened(const fs::path& path) {
  fs::path normal = path.lexically_normal();
  return real_path(normal) == real_path(path) ? normal : path;
}

[[noreturn]] void throw_not_ours(const fs::path& folder) {
  throw Error(ErrorKind::kInput,
              (folder / results::kReport).string() + ": not a report of tetropolis");
}

CutsCheck cuts_of(const Report& report, const fs::path& folder) {
  CutsCheck cuts;
  CutSources& from = cuts.from.emplace();
  double slope = report.config.cut_slope;
  if (report.volume_mesh) {
    if (report.volume_mesh->cut_slope_deg != 0) slope = report.volume_mesh->cut_slope_deg;
    from.roofs = report.volume_mesh->roofs_cut_back;
    for (const Point3& toe : report.volume_mesh->feet_cut_back)
      from.feet.push_back({toe[0] - report.origin.x, toe[1] - report.origin.y, toe[2]});
  }
  if (!(slope > 0 && slope <= 90)) throw_not_ours(folder);
  cuts.slopes.at_start = std::tan(to_radians(slope));
  return cuts;
}

}  // namespace

std::optional<ReportedRun> read_reported_run(const fs::path& folder) {
  std::optional<ReadReport> read = read_report(folder);
  if (!read) return std::nullopt;
  ReportedRun run{std::move(read->report),
                  std::move(read->missing),
                  read->has_origin,
                  read->has_domain,
                  read->has_crs,
                  {},
                  {},
                  {}};
  Report& report = run.report;
  normalise_crs("EPSG:4326");  // Where no reference system is known, it is not the report's fault.
  try {
    report.crs = normalise_crs(report.crs);
  } catch (const Error&) {
    throw_not_ours(folder);
  }
  report.files = names_below(report.files);
  if (const auto city = report.sources.find("city"); city != report.sources.end())
    run.city_model = shortened(folder / city->second);
  if (const auto terrain = report.sources.find("dtm"); terrain != report.sources.end())
    run.terrain = shortened(folder / terrain->second);
  run.cuts = cuts_of(report, folder);
  return run;
}

}  // namespace tetropolis
