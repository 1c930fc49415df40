#include "vector_open.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/is_among.h"
#include "core/text.h"
#include "io/deferred/gdal_functions.h"
#include "io/file/input_file.h"
#include "io/vector/osm/osm_buildings.h"
#include "io/vector/osm/osm_elements.h"
#include "io/vector/quirks/csv_tables.h"
#include "io/vector/quirks/json_lines.h"
#include "io/vector/quirks/shapefile_members.h"
#include "vector_geometry.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// What a member of an archive is by its name: 0 for a vector file, 1 and 2 for what may be one or
/// describe one, 3 for neither.
int rank_of_member(const std::string& name) {
  constexpr std::array<std::string_view, 14> kVector{
      ".shp", ".gpkg", ".geojson", ".geojsonl", ".geojsons", ".fgb", ".gdb",
      ".gml", ".kml",  ".sqlite",  ".tab",      ".mif",      ".osm", ".pbf"};
  constexpr std::array<std::string_view, 5> kPerhaps{".xml", ".csv", ".tsv", ".dxf", ".ndjson"};
  const std::string extension = lower_case(fs::path(name).extension().string());
  if (is_among(extension, kVector)) return 0;
  if (extension == ".json") return 1;
  return is_among(extension, kPerhaps) ? 2 : 3;
}

/// The name for GDAL of the only vector file in a ZIP archive, wherever it lies in there.
std::string vector_in_archive(const fs::path& path, const gdal::QuietErrors& errors) {
  const std::string archive = "/vsizip/" + path.string();
  char** const members = VSIReadDirRecursive(archive.c_str());
  std::vector<std::string> found;
  bool holds_points = false;
  int best = 2;
  for (char** member = members; member != nullptr && *member != nullptr; ++member) {
    std::string name = *member;
    // What macOS adds to archives bears the names of real members.
    if (name.starts_with("__MACOSX/")) continue;
    // A geodatabase is a folder, which archives may list or not.
    if (const std::size_t end = lower_case(name).find(".gdb/"); end != std::string::npos)
      name.resize(end + 4);
    const std::string extension = lower_case(fs::path(name).extension().string());
    holds_points = holds_points || extension == ".las" || extension == ".laz";
    const int rank = rank_of_member(name);
    if (rank > best) continue;
    if (rank < best) found.clear();
    best = rank;
    if (!is_among(name, found)) found.push_back(name);
  }
  CSLDestroy(members);
  if (members == nullptr)
    fail_input(path, "cannot be read as a ZIP archive" + errors.reason() + "; get it again");
  if (found.empty())
    fail_input(path, holds_points ? "has point files, which are not read from archives; unpack it"
                                  : "has no vector file; name another archive, or a file");
  if (found.size() > 1)
    fail_input(path, fmt::format("has several vector files ({}); unpack it and name those of "
                                 "the buildings",
                                 fmt::join(found, ", ")));
  return archive + "/" + found.front();
}

/// City models and OpenStreetMap have readers here, of files that are not packed. GDAL's lose
/// buildings and heights.
void require_no_own_format(const fs::path& path, const std::string& name) {
  std::string block(std::size_t{1} << 16, '\0');
  VSILFILE* const file = VSIFOpenL(name.c_str(), "rb");
  if (file == nullptr) return;
  block.resize(VSIFReadL(block.data(), 1, block.size(), file));
  VSIFCloseL(file);
  const auto has = [&](const char* text) { return block.find(text) != std::string::npos; };
  if ((has("CityModel") && has("citygml")) || has("\"CityJSON"))
    fail_input(path, "holds a city model, which is read from a file that is not packed; unpack it");
  if (has("<osm") || has("OSMHeader"))
    fail_input(path,
               "holds OpenStreetMap data, which are read from .osm, .osm.gz, .osm.bz2 and "
               ".pbf; unpack it");
}

/// GDAL opens whatever it finds in a folder, and would wait for a pipe or a terminal.
void require_no_pipes_in(const fs::path& folder) {
  std::error_code error, ignored;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_fifo(ignored) || entry->is_character_file(ignored))
      require_ordinary_file(entry->path());
}

/// What a database of SQLite says of its journal: whether it is written ahead (WAL).
bool is_in_wal_mode(const fs::path& path) {
  constexpr std::size_t kMode = 18;  // of the header
  std::array<char, kMode + 1> header{};
  std::ifstream file(path, std::ios::binary);
  return file.read(header.data(), header.size()) &&
         std::string_view(header.data(), 15) == "SQLite format 3" && header[kMode] == 2;
}

/// SQLite takes over what is written ahead when the last one closes a database, even one who only
/// reads. So a copy is read, with its journal; removed when nobody uses it.
std::shared_ptr<const void> copy_with_journal(const fs::path& path, std::string& name) {
  std::string pattern = (fs::temp_directory_path() / "tetropolis-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr)
    fail_input(path,
               "has a -wal beside it, and there is no room for a copy in the folder for "
               "temporary files; set TMPDIR");
  const fs::path folder = pattern;
  std::shared_ptr<const void> scratch(new int(0), [folder](const int* token) {
    delete token;
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  });
  const fs::path copy = folder / path.filename();
  std::error_code error;
  fs::copy_file(path, copy, error);
  if (!error) fs::copy_file(path.string() + "-wal", copy.string() + "-wal", error);
  if (error) fail_input(path, "has a -wal beside it, and copying both fails: " + error.message());
  name = copy.string();
  return scratch;
}

}  // namespace

bool first_layer_holds_polygons(GDALDatasetH dataset) {
  OGRLayerH layer = GDALDatasetGetLayer(dataset, 0);
  return layer != nullptr && polygon_field(layer) >= 0;
}

bool is_of_format(GDALDatasetH dataset, std::string_view begin) {
  return std::string_view(GDALGetDriverShortName(GDALGetDatasetDriver(dataset))).starts_with(begin);
}

bool drops_geometries(GDALDatasetH dataset) {
  return is_of_format(dataset, "GeoJSON") || is_of_format(dataset, "ESRIJSON") ||
         is_of_format(dataset, "GML");
}

VectorFile open_vector(const fs::path& path, const gdal::QuietErrors& errors, bool any_crs) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    require_no_pipes_in(path);
  } else {
    require_ordinary_file(path);
    if (fs::file_size(path, error) == 0) fail_input(path, "the file is empty; get it again");
  }
  require_whole_shapefile(path);
  VectorFile file;
  if (fs::is_regular_file(path, error) && is_osm_file(path)) {
    OsmBuildings buildings = read_osm_buildings(path);
    file.is_osm = true;
    file.dataset = std::move(buildings.dataset);
    file.osm_lost = std::move(buildings.lost);
    file.osm_incomplete = std::move(buildings.incomplete);
    return file;
  }
  std::string name = path.string();
  if (lower_case(path.extension().string()) == ".zip") {
    name = vector_in_archive(path, errors);
  } else if (lower_case(path.extension().string()) == ".gz") {
    name = "/vsigzip/" + path.string();
  }
  if (name.starts_with("/vsi")) {
    require_no_own_format(path, name);
  } else if (are_lines_of_collections(path)) {
    file.copy = std::make_shared<const gdal::MemoryFolder>();
    name = copy_features_of_lines(path, *file.copy);
  } else if (needs_copy(path)) {
    file.copy = std::make_shared<const gdal::MemoryFolder>();
    name = copy_shapefile(path, *file.copy);
  }
  const gdal::ConfigOption restore("SHAPE_RESTORE_SHX", needs_copy(path) ? "YES" : "NO");
  gdal::StringList options;
  options.set("WRITE_GFS", "NO");
  if (is_in_wal_mode(path)) {
    if (const auto journal = fs::file_size(path.string() + "-wal", error); !error && journal > 0)
      file.scratch = copy_with_journal(path, name);
    else
      options.set("IMMUTABLE", "YES");
  }
  file.dataset.reset(GDALOpenEx(name.c_str(), GDAL_OF_VECTOR | GDAL_OF_VERBOSE_ERROR, nullptr,
                                options.list(), nullptr));
  if (file.dataset == nullptr && lower_case(path.extension().string()).ends_with("parquet"))
    fail_input(path,
               "is GeoParquet, which this GDAL does not read; take the data as GeoJSON or "
               "GeoPackage, or convert it with DuckDB or a GDAL that has the driver Parquet");
  if (file.dataset == nullptr && fs::is_directory(path, error))
    fail_input(path, "is a folder, but no data set; name the files in it");
  const bool unknown = errors.last().find("not recognized as") != std::string::npos;
  if (file.dataset == nullptr)
    fail_input(path, "not a vector file" + (unknown ? "" : errors.reason()) +
                         "; name a shapefile, GeoPackage, GeoJSON or another OGR format");
  if (is_of_format(file.dataset.get(), "CSV") && !first_layer_holds_polygons(file.dataset.get()))
    find_polygons(name, options, file.dataset);
  if (is_of_format(file.dataset.get(), "CSV")) require_closed_quotes(path, name);
  // Some formats are read when they are opened, as far as they go.
  if (!any_crs && errors.failures(gdal::About::kSystem) > 0)
    fail_input(path,
               "states a CRS that PROJ does not know; name the right one with footprints_crs");
  const std::int64_t harmless =
      errors.failures(gdal::About::kSystem) +
      (drops_geometries(file.dataset.get()) ? errors.failures(gdal::About::kGeometry) : 0);
  if (errors.failures() > harmless) {
    const std::string& why = errors.first(gdal::About::kAnything);
    fail_input(path, "cannot be read to its end: " + (why.empty() ? errors.last() : why) +
                         "; the file is cut or broken, get it again");
  }
  file.opening_errors = errors.failures();
  file.first_error = errors.first();
  return file;
}

}  // namespace tetropolis
