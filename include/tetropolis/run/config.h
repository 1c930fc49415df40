// The settings of a run and the one list that describes them: options of the command line, keys of
// the TOML file, defaults, validation, help and the table in the documentation all come from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tetropolis/io/file/compression.h"
#include "tetropolis/pipeline/build_city.h"
#include "tetropolis/pipeline/mesh_city.h"

namespace tetropolis {

// Settings that are one of a few words; what each means is told in config_fields().
enum class Coordinates { kLocal, kAbsolute };
enum class HeightUnit { kMetre, kFoot, kSurveyFoot };
enum class SynthKind { kRandom, kBlocks, kAdversarial };
enum class SynthRoofs { kFlat, kSloped };

/// Lengths in metres, angles in degrees. Empty strings and lists mean "not given".
struct Config {
  // Input.
  std::vector<std::string> footprints;
  std::vector<std::string> planned;
  std::vector<std::string> points;
  std::string city;
  std::vector<std::string> dtm;
  std::vector<std::string> dsm;
  double ground_level = 0;
  std::vector<double> bounds;
  std::string points_crs;
  std::string footprints_crs;
  std::string raster_crs;
  std::string layer;
  std::string where;
  std::string id_attribute;
  std::string height_attribute;
  HeightUnit height_unit = HeightUnit::kMetre;
  std::string floors_attribute;
  double floor_height = 3;
  double default_height = 6;
  bool require_grids = false;
  bool terrain_only = false;

  // Output.
  std::string out;
  bool overwrite = false;
  std::vector<std::string> formats{"vtu"};
  bool building_patches = false;
  bool building_zones = false;
  Coordinates coordinates = Coordinates::kLocal;
  Compression compression = Compression::kNone;
  bool no_html = false;

  // City model.
  double domain_margin = 40;
  std::string domain = "data";
  double wind_from = 270;
  int sectors = 36;
  std::vector<double> origin;
  double dtm_step = 1;
  GroundFilter ground_filter = GroundFilter::kAuto;
  double ground_filter_window = 20;
  double ground_filter_slope = 0.15;
  double parallel_tolerance = 0.01;
  double ground_margin = 1;
  double outlier_sigma = 2;
  double ground_percentile = 10;
  double roof_percentile = 70;
  Lod lod = Lod::k2_2;
  double min_building_height = 2.5;
  double min_building_distance = 1;
  double close_gaps = 0;
  int merge_growths = 3;
  double min_building_area = 15;
  MeasuredGround measured_ground = MeasuredGround::kDrop;
  BoundaryBuildings boundary_buildings = BoundaryBuildings::kDrop;

  // Mesh.
  double mesh_size = 10;
  double far_size = 0;
  double ground_size = 0;
  double size_growth = 1.2;
  std::vector<std::string> refine;
  std::vector<std::string> surface_layers;
  std::vector<std::string> canopies;
  double leaf_area_density = kLeafAreaDensity;
  double target_cells = 0;
  double min_angle = 25;
  double domain_height = 0;
  Cells cells = Cells::kTets;
  Layering layering = Layering::kGraded;
  double layer_height = 0;
  int boundary_layers = 0;
  double first_layer = 0.5;
  double layer_growth = 1.2;
  Top top = Top::kFlat;
  double min_wall_height = 1;
  double cut_slope = 56;
  double min_gap_share = 0.25;
  double solver_tolerance = 1e-3;
  int solver_iterations = 1000;

  // Synthetic city.
  SynthKind kind = SynthKind::kRandom;
  int buildings = 0;
  double size = 0;
  int seed = 1;
  double point_density = 2;
  double relief = -1;
  SynthRoofs roofs = SynthRoofs::kFlat;
  std::vector<std::string> defects;

  // Run.
  std::string max_memory;  ///< As "8G"; empty: nine tenths of what the process may use.
  int threads = 0;
  bool quiet = false;
  bool verbose = false;
  std::string log;
};

/// The commands that take settings, as bits.
enum Command : unsigned {
  kBuild = 1U << 0,
  kCity = 1U << 1,
  kMesh = 1U << 2,
  kSynth = 1U << 3,
  kCheck = 1U << 4,
};

/// A setting that is one of a few words: an enumeration that counts the words of the field.
struct ChoiceMember {
  std::size_t (*get)(const Config&);
  void (*set)(Config&, std::size_t);
};

/// One setting.
struct ConfigField {
  using Member =
      std::variant<bool Config::*, int Config::*, double Config::*, std::string Config::*,
                   std::vector<std::string> Config::*, std::vector<double> Config::*, ChoiceMember>;

  std::string_view name;        ///< Key in TOML; the option is "--" with '-' for '_'.
  std::string_view group = "";  ///< Heading in help and documentation.
  Member member;
  unsigned commands = 0;  ///< Command bits that take it.
  std::string_view help;  ///< One line without a full stop.
  std::string_view unit = "";
  std::string_view value = "";  ///< Of texts: what its value is called: "FILE", "DIR", "CRS".
  char letter = 0;              ///< The option's short form is "-" with it; 0: none.
  bool common = false;          ///< Shown by --help, not only by --help-all.
  double min = -std::numeric_limits<double>::infinity();  ///< Of numbers, inclusive
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;                      ///< unless only greater ones are allowed.
  std::vector<std::string_view> choices = {};  ///< Of texts; empty: anything.
  /// Of texts: throws an Error for one that is none; nullptr: nothing to ask.
  void (*require)(const std::string& text) = nullptr;
};

/// All settings, in the order in which they are documented.
std::span<const ConfigField> config_fields();

/// The setting of this name; nullptr: there is none.
const ConfigField* find_field(std::string_view name);

/// The option's spelling: "--mesh-size".
std::string option_name(const ConfigField& field);

/// The value as TOML text: 10.0, "flat", ["vtu"].
std::string value_text(const ConfigField& field, const Config& config);

/// Sets one field from texts (one per list element). `origin` names where they come from in errors
/// ("--mesh-size", "city.toml:7"). Throws Error(kUsage): not a number, out of range, not a choice.
void set_field(Config& config, const ConfigField& field, std::span<const std::string> values,
               const std::string& origin);

/// That every setting that `commands` take is one that set_field would take: in its range, among
/// its choices. Throws Error(kUsage) naming the option.
void require_in_range(const Config& config, unsigned commands);

/// Sets every field that the TOML file has. Throws Error(kUsage) naming file and line: not TOML, an
/// unknown key (with the nearest known one), a wrong type or value.
void load_config(Config& config, const std::filesystem::path& path);

/// A TOML file with every setting of `commands`, its default and meaning, commented out.
std::string config_template(unsigned commands);

/// All settings as one Markdown table per group.
std::string config_markdown();

/// A message of the library with its settings as a caller spells them. They are told by their
/// names, those of a single word in backquotes. `marks`: what may stand beside a name, besides
/// spaces, brackets, backquotes and a full stop. `spell` returns what stands for a setting; `rest`,
/// what follows it, may be shortened by what that stands for, too.
std::string respell_settings(
    std::string_view message, std::string_view marks,
    const std::function<std::string(const ConfigField& field, std::string_view& rest)>& spell);

/// The name among `known` closest to `name` by edit distance, or an empty string if none is close.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace tetropolis
