// What a run did: the content of report.json. Its keys are documented in docs/report.md, by the
// same list of fields that reads and writes them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/core/steps.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/crs/geo_place.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"
#include "tetropolis/pipeline/preflight.h"
#include "tetropolis/run/config.h"

namespace tetropolis {

struct Report {
  std::string version;  ///< Of the program that wrote it.
  std::string command;
  std::string started;  ///< When: UTC, "2026-11-26T09:14:05Z".
  Config config;
  Point2 origin;
  std::string crs;
  Bounds2 domain = Bounds2::nothing();  ///< CRS coordinates.
  std::vector<StepTime> steps;
  std::int64_t peak_rss_bytes = 0;
  int threads = 0;
  std::map<std::string, std::string> sources;  ///< What `mesh` has read, by setting: paths relative
                                               ///< to the folder of the results.
  std::optional<GeoPlace> place;  ///< The middle of the domain; none if the CRS is unknown.
  std::optional<Preflight> preflight;
  std::optional<InputFacts> input;
  std::optional<CityFacts> city;
  std::optional<GroundMeshFacts> ground_mesh;
  std::optional<VolumeMeshFacts> volume_mesh;  ///< Places in CRS coordinates.
  std::optional<SurfaceMeshFacts> surface_mesh;
  std::vector<CellZone> canopies;  ///< As meshed.
  std::vector<SolverFacts> solver;
  std::vector<Warning> warnings;
  std::vector<std::string> files;  ///< Results in the folder, sorted, without the report: what the
                                   ///< run wrote, and what it read there of an earlier run.
};

/// The report as JSON text, UTF-8, ending with a newline.
std::string to_json(Report report);

/// What became of all footprints in one line (account_in_words); "" where the run made no city.
std::string account_line(const Report& report);

/// A report as it was read.
struct ReadReport {
  Report report;                     ///< Members that the file lacks have their defaults.
  std::vector<std::string> missing;  ///< Members that a report of its command has and this one has
                                     ///< not, as JSON pointers ("/city/flags").
  bool has_origin = false, has_domain = false, has_crs = false;
};

/// Of the text of a report.json. Throws Error(kInput) naming `source` if it is none of ours: no
/// JSON, members of other types.
ReadReport report_from_json(const std::string& text, const std::string& source);

/// Of the report.json in the folder, if there is one. Throws Error(kInput) if it cannot be read or
/// is none of ours.
std::optional<ReadReport> read_report(const std::filesystem::path& folder);

/// All keys as one Markdown table.
std::string report_markdown();

}  // namespace tetropolis
