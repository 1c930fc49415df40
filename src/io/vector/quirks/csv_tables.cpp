#include "csv_tables.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/deferred/gdal_functions.h"
#include "io/file/input_file.h"
#include "io/vector/vector_open.h"

namespace tetropolis {

namespace {

struct CloseFile {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// Follows the quotes of the lines that GDAL joins to a record.
class QuoteScan {
 public:
  explicit QuoteScan(const std::filesystem::path& path) : path_(path) {}

  void add(char c) {
    if (c == '"') {
      // The first of a field opens it, and one within it closes it, unless it is doubled.
      if (!open_) mistaken_ = !closed_ && !at_start_;
      open_ = !open_;
      closed_ = !open_;
      at_start_ = false;
      return;
    }
    if (c == '\n') {
      ++line_;
      if (!open_) finish();
      if (open_ && mistaken_) fail();
      return;
    }
    if (open_) return;
    const bool separates = std::string_view(",;\t|").find(c) != std::string_view::npos;
    const bool blank = c == ' ' || c == '\r';
    const bool mark = static_cast<unsigned char>(c) >= 0xBB && line_ == 0;  // of byte order
    closed_ = closed_ && blank;
    at_start_ = separates || blank || (at_start_ && mark);
  }

  void end() const {
    if (open_) fail();
  }

 private:
  void finish() {
    first_ = line_;
    closed_ = false;
    at_start_ = true;
  }

  [[noreturn]] void fail() const {
    fail_input(path_,
               fmt::format("line {}: a quote is not closed and swallows further lines; close "
                           "it, or double quotes within a field",
                           first_ + 1));
  }

  const std::filesystem::path& path_;
  bool open_ = false;       // within quotes
  bool mistaken_ = false;   // which opened within a field
  bool closed_ = false;     // just behind the closing one
  bool at_start_ = true;    // of a field
  std::int64_t line_ = 0;   // lines that have ended
  std::int64_t first_ = 0;  // at the beginning of the record
};

}  // namespace

void find_polygons(const std::string& name, gdal::StringList& options, gdal::Dataset& dataset) {
  for (const char* column : {"geometry", "geom", "the_geom", "wkb_geometry", "geom_wkt",
                             "geometry_wkt", "wkb", ".geo", "shape", "polygon", "footprint"}) {
    options.set("GEOM_POSSIBLE_NAMES", column);
    const gdal::QuietErrors errors;
    gdal::Dataset other(GDALOpenEx(name.c_str(), GDAL_OF_VECTOR, nullptr, options.list(), nullptr));
    if (other == nullptr || !first_layer_holds_polygons(other.get())) continue;
    dataset = std::move(other);
    return;
  }
  const gdal::QuietErrors errors;
  gdal::Dataset lines(
      GDALOpenEx(("GeoJSONSeq:" + name).c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr));
  if (lines != nullptr && first_layer_holds_polygons(lines.get())) dataset = std::move(lines);
}

void require_closed_quotes(const std::filesystem::path& path, const std::string& name) {
  QuoteScan scan(path);
  const std::unique_ptr<VSILFILE, CloseFile> file(VSIFOpenL(name.c_str(), "rb"));
  if (file == nullptr) fail_input(path, "cannot be read; check its permissions");
  std::vector<char> block(1 << 20);
  while (const std::size_t count = VSIFReadL(block.data(), 1, block.size(), file.get()))
    for (std::size_t i = 0; i < count; ++i) scan.add(block[i]);
  scan.end();
}

}  // namespace tetropolis
