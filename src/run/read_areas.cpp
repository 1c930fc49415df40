#include "read_areas.h"

#include <filesystem>
#include <system_error>

#include "tetropolis/core/error.h"

#include "io/vector/model_footprints.h"
#include "io/vector/osm/osm_elements.h"

namespace tetropolis {

FootprintsInput read_areas(const std::string& file, const std::string& crs, bool attributes,
                           std::vector<Warning>& warnings) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) {
    if (is_osm_file(file))
      throw Error(ErrorKind::kInput,
                  file +
                      ": is an OpenStreetMap extract, of which only buildings are read; export "
                      "its areas first (ogr2ogr areas.gpkg EXTRACT multipolygons)");
    if (is_city_model(file))
      throw Error(
          ErrorKind::kInput,
          file + ": is a city model, of which only buildings are read; give a file of areas");
  }
  ReadFootprintsOptions options;
  options.target_crs = crs;
  options.attributes = attributes;
  FootprintsInput input = read_footprints(file, options);
  warnings.insert(warnings.end(), input.warnings.begin(), input.warnings.end());
  return input;
}

}  // namespace tetropolis
