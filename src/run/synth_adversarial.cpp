#include "synth_adversarial.h"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/io/las/las.h"

#include "io/file/atomic_file.h"
#include "io/vector/raw_vector.h"
#include "result_files.h"
#include "synth/adversarial_city.h"

namespace tetropolis {

namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> write_files(const AdversarialCity& city, OutputFolder& out) {
  std::vector<std::string> files;
  if (city.as_geojson) {
    files = {"footprints.geojson"};
  } else {
    files = {"footprints.shp", "footprints.shx", "footprints.dbf", "footprints.prj",
             "footprints.cpg"};
  }
  write_raw_features(out.result(files.front(), files), city.features, city.origin, city.crs,
                     city.with_z);
  for (std::size_t k = 0; k < city.tiles.size(); ++k) {
    const PointTile& tile = city.tiles[k];
    WritePointsOptions options;
    options.crs = city.crs;
    options.flags = tile.flags;
    // Formats 0 to 5 have room for neither the overlap flag nor classes above 31.
    bool extended = k % 2 == 1;
    for (const std::uint8_t code : tile.points.classification) extended |= code > 31;
    for (const std::uint8_t flags : tile.flags) extended |= (flags & kOverlapPoint) != 0;
    options.point_format = extended ? 6 : 1;
    files.push_back(city.tiles.size() == 1 ? "points.laz" : fmt::format("points_{}.laz", k + 1));
    write_points(out.result(files.back()), tile.points, city.origin, options);
  }
  return files;
}

Json manifest_of(const AdversarialCity& city, const std::vector<std::string>& files,
                 const Report& report) {
  Json ids = Json::array();
  for (const RawFeature& feature : city.features) ids.push_back(feature.id);
  Json defects = Json::array();
  for (const Defect& defect : city.defects)
    defects.push_back({{"name", defect.name}, {"count", defect.count}});
  const Bounds2& box = report.domain;
  return {{"kind", "adversarial"},
          {"seed", report.config.seed},
          {"size", city.domain.xmax},
          {"domain", {box.xmin, box.ymin, box.xmax, box.ymax}},
          {"needs_bounds", city.needs_bounds},
          {"refusable", city.refusable},
          {"defects", defects},
          {"footprints", files.front()},
          {"files", files},
          {"ids", ids}};
}

std::string describe(const std::string& name) {
  for (const DefectKind& kind : defect_kinds())
    if (kind.name == name) return kind.what;
  return name;
}

}  // namespace

void synth_adversarial(const Config& config, double size, OutputFolder& out, StepClock& clock,
                       Report& report) {
  const AdversarialCity city = clock.run("0.1", "invent the city", [&](const Progress& progress) {
    AdversarialCityOptions options;
    options.size = size;
    options.seed = static_cast<std::uint64_t>(config.seed);
    options.points_per_m2 = config.point_density;
    options.relief = config.relief < 0 ? options.relief : config.relief;
    options.defects = config.defects;
    return synthetic_adversarial_city(options, progress);
  });
  report.origin = city.origin;
  report.crs = city.crs;
  report.domain = city.domain.moved(city.origin);
  InputFacts& input = report.input.emplace();
  for (const PointTile& tile : city.tiles) {
    input.points_kept += static_cast<std::int64_t>(tile.points.size());
    for (const std::uint8_t code : tile.points.classification) ++input.points_by_class[code];
  }
  input.points_read = input.points_kept;
  input.footprints_read = static_cast<std::int64_t>(city.features.size());
  for (const Defect& defect : city.defects)
    report.warnings.push_back({defect.name, defect.count, describe(defect.name)});
  clock.run("0.2", "write footprints and points", [&](const Progress&) {
    const std::vector<std::string> written = write_files(city, out);
    AtomicFile file(out.result(results::kManifest));
    file.write(manifest_of(city, written, report).dump(1) + "\n");
    file.commit();
  });
}

}  // namespace tetropolis
