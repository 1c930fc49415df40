#include "adversarial_city.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/is_among.h"
#include "defects.h"
#include "scan.h"
#include "seeded_random.h"
#include "village.h"

namespace tetropolis {

namespace {

constexpr std::uint64_t kChoiceStream = 1;
constexpr std::uint64_t kAdversarialTerrainStream = 2;
constexpr std::uint64_t kVillageStream = 3;
constexpr std::uint64_t kFurnitureStream = 4;
constexpr std::uint64_t kFileStream = 5;
constexpr std::uint64_t kDefectStream = 100;  // The first of one stream per kind of defect.
constexpr std::uint64_t kAdversarialScanSeed = 0x616476;

// In the order of application: terrain and buildings before the laser, outlines and clouds after.
constexpr DefectKind kKinds[] = {
    {"slope_45", "terrain", "a slope of 45 degrees", false},
    {"quarry_wall", "terrain", "a rock wall of 20 m through the city", false},
    {"canals", "terrain", "canals around islands", false},
    {"below_sea", "terrain", "elevations around -5 m", false},
    {"high_mountains", "terrain", "elevations around 2,500 m", false},
    {"roof_below_terrain", "building", "roofs lower than the terrain uphill", false},
    {"nested_courtyard", "building", "a courtyard in a courtyard, and a hut in it", false},
    {"tjunction_micrometre", "building", "walls that end a micrometre beside a wall", false},
    {"crack_1cm", "building", "a crack of 1 cm between buildings", false},
    {"wall_5cm", "building", "walls of 5 cm", false},
    {"shed_2cm", "building", "sheds of 2 cm", false},
    {"massive_overlaps", "building", "many buildings across each other", false},
    {"checkerboard", "building", "buildings that touch at corners", false},
    {"circle_4000", "building", "a circle of 4,000 vertices", false},
    {"needle_half_degree", "building", "needles of half a degree", false},
    {"tower_300", "domain", "a tower of up to 300 m among sheds", false},
    {"building_twice", "building", "buildings given twice", false},
    {"domain_sized", "domain", "a building as large as the domain", false},
    {"on_boundary", "domain", "buildings across, on or near the domain's boundary", false},
    {"on_corner", "domain", "a building on the domain's corner", false},
    {"offset_centimetres", "scale", "an origin some centimetres off whole metres", false},
    {"far_north", "scale", "northings of 7.6 million", false},
    {"small_numbers", "scale", "coordinates near zero", false},
    {"larger_than_domain", "domain", "an outline larger than the domain", false},
    {"multipolygon", "outline", "buildings far apart as one feature", false},
    {"zero_width_spike", "outline", "spikes without width", false},
    {"bow_tie", "outline", "outlines that cross themselves", false},
    {"hole_outside", "outline", "holes outside the outline", false},
    {"hole_equal", "outline", "holes equal to the outline", false},
    {"hole_touching", "outline", "holes that touch the outline", false},
    {"hole_sharing_edge", "outline", "holes that share an edge with the outline", false},
    {"duplicate_vertices", "outline", "vertices given several times", false},
    {"near_duplicate_vertices", "outline", "vertices picometres to millimetres apart", false},
    {"clockwise", "outline", "rings the wrong way round", false},
    {"unclosed", "outline", "rings that do not close", false},
    {"huge_coordinate", "outline", "coordinates up to 1e300", false},
    {"nan_coordinate", "outline", "coordinates that are not finite", false},
    {"two_vertices", "outline", "polygons of two vertices", false},
    {"null_shape", "outline", "features without geometry", false},
    {"z_values", "outline", "vertices with elevations", false},
    {"points_twice", "cloud", "every point twice", false},
    {"birds_classed", "cloud", "birds, classified as noise", false},
    {"birds_unclassed", "cloud", "birds, classified as what lies below them", false},
    {"pits_classed", "cloud", "pits, classified as noise", false},
    {"pits_unclassed", "cloud", "pits, classified as what lies above them", false},
    {"void_25m", "cloud", "voids of 25 m", false},
    {"half_without_ground", "domain", "no ground points in half of the domain", false},
    {"class_above_31", "cloud", "user-defined classes", false},
    {"tiles_overlap", "cloud", "tiles that overlap", false},
    {"tiles_gap", "cloud", "tiles with a gap between them", false},
    {"withheld_points", "cloud", "wrong points with the withheld flag", false},
    {"synthetic_points", "cloud", "points with the synthetic flag", false},
    {"overlap_points", "cloud", "points with the overlap flag", false},
    {"no_classes", "cloud", "no point is classified", false},
    {"only_ground", "cloud", "ground points only", false},
    {"only_buildings", "cloud", "points on buildings only", true},
};
constexpr std::size_t kKindCount = std::size(kKinds);

void check(const AdversarialCityOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::kUsage, "cannot make an adversarial city: " + what);
  };
  if (!(options.size >= 100 && options.size <= 1000)) refuse("the size must be in [100, 1000] m");
  if (!(options.points_per_m2 > 0 && options.points_per_m2 <= 1000))
    refuse("the point density must be in (0, 1000] per m2");
  if (!(options.relief >= 0 && options.relief <= 2000)) refuse("the relief must be in [0, 2000] m");
  for (const std::string& name : options.defects)
    if (std::none_of(std::begin(kKinds), std::end(kKinds),
                     [&](const DefectKind& kind) { return kind.name == name; }))
      refuse(fmt::format("there is no defect '{}'", name));
}

/// Of the kinds that exclude each other, one at most.
bool excluded(std::string_view name, const std::vector<std::string_view>& chosen) {
  static constexpr std::string_view kRivals[][4] = {
      {"no_classes", "only_ground", "only_buildings", "half_without_ground"},
      {"tiles_overlap", "tiles_gap", "", ""},
      {"domain_sized", "larger_than_domain", "", ""},
      {"below_sea", "high_mountains", "", ""},
      {"far_north", "small_numbers", "", ""},
      {"slope_45", "tower_300", "", ""}};
  for (const auto& rivals : kRivals) {
    if (std::find(std::begin(rivals), std::end(rivals), name) == std::end(rivals)) continue;
    for (const std::string_view other : rivals)
      if (!other.empty() && is_among(other, chosen)) return true;
  }
  return false;
}

/// Those that leave little of the rest to see are rarer.
double odds(std::string_view name) {
  for (const std::string_view drastic :
       {"domain_sized", "larger_than_domain", "only_ground", "only_buildings", "no_classes"})
    if (name == drastic) return 0.2;
  return 1;
}

/// One to fourteen, fewer more often.
std::vector<std::string_view> choose(const AdversarialCityOptions& options) {
  std::vector<std::string_view> chosen;
  if (!options.defects.empty()) {
    chosen.assign(options.defects.begin(), options.defects.end());
    return chosen;
  }
  SeededRandom random(options.seed, kChoiceStream);
  const double few = random.unit();
  const auto wanted = static_cast<std::size_t>(1 + 14 * few * few);
  for (int tries = 0; tries < 1000 && chosen.size() < wanted; ++tries) {
    const std::string_view name = kKinds[random.bits() % kKindCount].name;
    if (!random.chance(odds(name)) || excluded(name, chosen) || is_among(name, chosen)) continue;
    chosen.push_back(name);
  }
  return chosen;
}

bool change_terrain(std::string_view name, double size, SyntheticTerrain& terrain,
                    SeededRandom& random) {
  if (name == "slope_45") {
    // From gentle at a distance to 45 degrees: the hills come on top.
    terrain.slope = direction(random.uniform(-1, 1));
    if (random.chance(0.5)) terrain.slope = {-terrain.slope.x, -terrain.slope.y};
  } else if (name == "quarry_wall") {
    terrain.step_normal = direction(random.uniform(-1, 1));
    const double x = size * random.uniform(0.35, 0.65);
    const double y = size * random.uniform(0.35, 0.65);
    terrain.step_offset = terrain.step_normal.x * x + terrain.step_normal.y * y;
    terrain.step_height = 20;
  } else if (name == "canals") {
    terrain.canal_spacing = random.uniform(45, 90);
    terrain.canal_half_width = random.uniform(1.5, 6);
    terrain.canal_depth = random.uniform(0.8, 3);
  } else if (name == "below_sea") {
    terrain.base = -5 - terrain.relief / 2;
  } else if (name == "high_mountains") {
    terrain.base = 2500;
  } else {
    return false;
  }
  return true;
}

bool change_scale(std::string_view name, AdversarialCity& city, SeededRandom& random) {
  if (name == "offset_centimetres") {
    city.origin.x += random.uniform(0.001, 0.099);
    city.origin.y += random.uniform(0.001, 0.099);
  } else if (name == "far_north") {
    city.origin = {901234, 7612345};
  } else if (name == "small_numbers") {
    city.origin = {-city.domain.xmax / 2, -city.domain.ymax / 3};
  } else {
    return false;
  }
  return true;
}

RawRing raw(const Ring& ring, bool reversed) {
  RawRing result;
  for (const Point2 p : ring) result.push_back({p.x, p.y, 0});
  if (!result.empty()) result.push_back(result.front());
  if (reversed) std::reverse(result.begin(), result.end());
  return result;
}

/// Rings in the format's own orientation: in shapefiles outer rings are clockwise.
std::vector<RawFeature> raw_features(const SyntheticCity& city, bool clockwise) {
  std::vector<RawFeature> features;
  for (std::size_t b = 0; b < city.footprints.size(); ++b) {
    RawPolygon polygon{raw(city.footprints[b].outer, clockwise)};
    for (const Ring& hole : city.footprints[b].holes) polygon.push_back(raw(hole, clockwise));
    features.push_back({city.ids[b], city.heights[b], {std::move(polygon)}});
  }
  return features;
}

/// The city that is built, with the defects of terrain, buildings, domain and scale.
SyntheticScene build_scene(const AdversarialCityOptions& options,
                           const std::vector<std::string_view>& chosen, AdversarialCity& city) {
  SyntheticScene scene;
  scene.size = options.size;
  scene.details = true;
  scene.terrain.relief = options.relief;
  SeededRandom terrain_random(options.seed, kAdversarialTerrainStream);
  for (double& phase : scene.terrain.phases) phase = terrain_random.unit();
  SeededRandom village_random(options.seed, kVillageStream);
  std::vector<VillagePlot> plots =
      village(options.size, village_random.uniform(4, 20), village_random);
  for (std::size_t k = 0; k < kKindCount; ++k) {
    const DefectKind& kind = kKinds[k];
    if (!is_among(kind.name, chosen)) continue;
    SeededRandom random(options.seed, kDefectStream + k);
    const bool done = change_terrain(kind.name, options.size, scene.terrain, random) ||
                      change_scale(kind.name, city, random);
    const std::int64_t count = done ? 1 : build_defect(kind.name, options.size, plots, random);
    if (count > 0) city.defects.push_back({kind.name, count});
  }
  for (VillagePlot& plot : plots)
    for (SyntheticBuilding& building : plot.buildings)
      scene.buildings.push_back(std::move(building));
  SeededRandom furniture(options.seed, kFurnitureStream);
  furnish(scene, furniture);
  return scene;
}

}  // namespace

std::span<const DefectKind> defect_kinds() { return kKinds; }

AdversarialCity synthetic_adversarial_city(const AdversarialCityOptions& options,
                                           const Progress& progress) {
  check(options);
  const std::vector<std::string_view> chosen = choose(options);
  AdversarialCity city;
  city.domain = {0, 0, options.size, options.size};
  city.origin = SyntheticCity{}.origin;
  SyntheticScene scene = build_scene(options, chosen, city);
  const SyntheticCity sound = city_of_scene(scene);
  city.terrain = scene.terrain;
  SeededRandom file_random(options.seed, kFileStream);
  city.as_geojson = file_random.chance(0.5);
  city.features = raw_features(sound, !city.as_geojson);
  city.tiles.push_back({scan_scene(scene, options.points_per_m2,
                                   mix64(options.seed ^ kAdversarialScanSeed), progress),
                        {}});
  for (std::size_t k = 0; k < kKindCount; ++k) {
    const DefectKind& kind = kKinds[k];
    if (!is_among(kind.name, chosen)) continue;
    city.refusable |= kind.refusable;
    city.needs_bounds |= std::string_view(kind.group) == "domain";
    SeededRandom random(options.seed, kDefectStream + k + kKindCount);
    const std::int64_t count =
        damage_outlines(kind.name, city, random) + damage_cloud(kind.name, city, random);
    if (count > 0) city.defects.push_back({kind.name, count});
  }
  return city;
}

}  // namespace tetropolis
