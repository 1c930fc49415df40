#include "write_page.h"

#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/file/write_file.h"
#include "tetropolis/pipeline/mesh_city.h"

#include "command_line.h"
#include "result_files.h"

namespace tetropolis {

std::vector<PageFootprint> page_footprints(const BuiltCity& built) {
  const CityModel& raw = built.raw;
  const CityModel& city = built.city;
  std::unordered_map<std::string, BuildingIndex> building;
  for (const BuildingIndex b : city.buildings.indices())
    for (const std::string& id : city.buildings[b].source_ids) building.emplace(id, b);
  std::unordered_map<std::string, std::string> reason;
  for (const Dropped& feature : city.dropped) reason.emplace(feature.source_id, feature.reason);

  std::vector<PageFootprint> footprints;
  const auto add = [&](const std::string& id, Polygon polygon) {
    PageFootprint& added = footprints.emplace_back(PageFootprint{id, std::move(polygon)});
    if (const auto b = building.find(id); b != building.end()) added.building = b->second;
    if (const auto r = reason.find(id); r != reason.end()) added.reason = r->second;
  };
  std::unordered_map<std::string, bool> is_raw;
  for (const Building& member : raw.buildings)
    for (const std::string& id : member.source_ids) {
      is_raw[id] = true;
      add(id, member.footprint);
    }
  for (const Footprint& feature : built.footprints.features)
    if (!is_raw.contains(feature.source_id) &&
        raw.domain.position_of(feature.polygon) != DomainPosition::kOutside)
      add(feature.source_id, feature.polygon);
  return footprints;
}

PageMesh page_preview(const CityModel& city, const Raster& terrain, const StepHooks& hooks) {
  // Lines of roofs bring up to two triangles for each one of outlines and ground.
  const auto mesh = mesh_preview(city, terrain, kMostPageTriangles / 3, hooks);
  if (!mesh) return {};
  PageMesh shown = page_mesh(*mesh, 0);
  shown.cells = 0;  // of the run
  return shown;
}

std::string page_of(const CityModel& city, const PageMesh* mesh,
                    std::span<const PageFootprint> footprints, Report report, std::string repeat) {
  std::map<std::string, std::int64_t> dropped;
  for (const Dropped& feature : city.dropped) ++dropped[feature.reason];
  if (report.city && report.city->account.unlisted > 0)
    dropped[kOutsideReason] += report.city->account.unlisted;
  // Of a country's footprints most are outside the domain: the page counts them.
  if (report.city) report.city->dropped.clear();
  return page_html({.city = city,
                    .mesh = mesh,
                    .footprints = footprints,
                    .dropped = std::move(dropped),
                    .report = to_json(report),
                    .repeat = std::move(repeat)});
}

void write_page(const Config& config, const CityModel& city, const PageMesh& mesh,
                std::span<const PageFootprint> footprints, Report report, OutputFolder& out) {
  std::string repeat = command_line(config, report.command);
  write_file(out.result(results::kPage),
             page_of(city, &mesh, footprints, std::move(report), std::move(repeat)));
}

}  // namespace tetropolis
