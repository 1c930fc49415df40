#include "foreign_model.h"

#include <filesystem>
#include <string>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/pipeline/meshable.h"

#include "core/files.h"
#include "result_files.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Of a model of another program; where its domain would be does not matter.
bool is_meshable(CityModel city, double min_distance) {
  Bounds2 box = Bounds2::nothing();
  for (const Building& building : city.buildings) box.extend(bounds(building.footprint));
  if (box.empty()) return true;  // refused with a reason later
  constexpr double kFar = 1000;
  city.domain = box.grown(kFar);
  drop_unmeshable(city, min_distance);
  flatten_unmeshable(city, min_distance);
  try {
    require_meshable(city, min_distance, "");
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInput) throw;
    return false;
  }
  return true;
}

}  // namespace

std::optional<Config> as_footprints(Config& config) {
  const CityModel city = read_city(config.city, nullptr, BrokenObjects::kDrop);
  const bool is_ours = !city.domain.empty() && city.domain.bounds().width() > 0;
  const fs::path beside = fs::path(config.city).parent_path() / results::kTerrain;
  if (config.dtm.empty() && is_ours && is_file(beside)) config.dtm = {beside.string()};
  if (!config.dtm.empty() && (is_ours || is_meshable(city, config.min_building_distance)))
    return {};
  Config building = config;
  building.footprints = {config.city};
  building.city.clear();
  return building;
}

}  // namespace tetropolis
