#include "write_page.h"

#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/file/write_file.h"

#include "command_line.h"
#include "result_files.h"

namespace tetropolis {

namespace {

Ring moved(Ring ring, Point2 by) {
  for (Point2& p : ring) p = {p.x + by.x, p.y + by.y};
  return ring;
}

Polygon moved(Polygon polygon, Point2 by) {
  polygon.outer = moved(std::move(polygon.outer), by);
  for (Ring& hole : polygon.holes) hole = moved(std::move(hole), by);
  return polygon;
}

}  // namespace

std::vector<Footprint> features_near(const FootprintsInput& footprints, const PointsInput& points) {
  const Bounds2 box = points.extent.moved(points.origin);
  std::vector<Footprint> near;
  for (const Footprint& feature : footprints.features)
    if (bounds(feature.polygon).intersects(box)) near.push_back(feature);
  return near;
}

std::vector<PageFootprint> page_footprints(const CityModel& raw, const CityModel& city,
                                           std::vector<Footprint> features) {
  std::unordered_map<std::string, BuildingIndex> building;
  for (std::size_t b = 0; b < city.buildings.size(); ++b)
    for (const std::string& id : city.buildings[b].source_ids)
      building.emplace(id, static_cast<BuildingIndex>(b));
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
  for (Footprint& feature : features) {
    if (is_raw.contains(feature.source_id)) continue;
    Polygon polygon = moved(std::move(feature.polygon), {-raw.origin.x, -raw.origin.y});
    if (raw.domain.position_of(polygon) != DomainPosition::kOutside)
      add(feature.source_id, std::move(polygon));
  }
  return footprints;
}

void write_page(const Config& config, const CityModel& city, const ColumnMesh& mesh,
                std::span<const PageFootprint> footprints, Report report, OutputFolder& out) {
  std::map<std::string, std::int64_t> dropped;
  for (const Dropped& feature : city.dropped) ++dropped[feature.reason];
  // Of a country's footprints most are outside the domain: the page counts them.
  if (report.city) report.city->dropped.clear();
  write_file(out.result(results::kPage),
             page_html({.city = city,
                        .mesh = &mesh,
                        .footprints = footprints,
                        .dropped = std::move(dropped),
                        .report = to_json(report),
                        .repeat = command_line(config, report.command)}));
}

}  // namespace tetropolis
