#include "reported_run.h"

#include <utility>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"

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

/// In the local frame.
ExcavationSources excavated_of(const Report& report, const fs::path& folder) {
  ExcavationSources excavated;
  std::vector<double> slopes{report.config.cut_slope};
  if (report.volume_mesh) {
    const VolumeMeshFacts& volume = *report.volume_mesh;
    excavated = {volume.roofs_cut_back, volume.feet_cut_back, volume.roof_cut_slopes_deg,
                 volume.foot_cut_slopes_deg};
    for (Point3& toe : excavated.toes)
      toe = {toe[0] - report.origin.x, toe[1] - report.origin.y, toe[2]};
  }
  if (excavated.roofs.size() != excavated.roof_slopes_deg.size() ||
      excavated.toes.size() != excavated.toe_slopes_deg.size())
    throw_not_ours(folder);
  for (const auto* own : {&excavated.roof_slopes_deg, &excavated.toe_slopes_deg})
    slopes.insert(slopes.end(), own->begin(), own->end());
  for (const double degrees : slopes)
    if (!(degrees > 0 && degrees <= 90)) throw_not_ours(folder);
  return excavated;
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
  run.excavated = excavated_of(report, folder);
  return run;
}

}  // namespace tetropolis
