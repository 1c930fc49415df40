#include "raw_vector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/file/write_file.h"

#include "core/infinity.h"
#include "io/crs/gdal_support.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "shapefiles are written as they lie");

struct Content {
  std::span<const RawFeature> features;
  Point2 origin;
  bool with_z;
};

// --- GeoJSON ---

/// JSON has no numbers that are not finite; these spellings are what writers emit and readers know.
std::string json_number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  return fmt::format("{}", value);
}

std::string json_polygon(const RawPolygon& polygon, const Content& content) {
  std::string text = "[";
  for (const RawRing& ring : polygon) {
    text += &ring == &polygon.front() ? "[" : ",[";
    for (const RawVertex& p : ring) {
      text += &p == &ring.front() ? "[" : ",[";
      text += json_number(p.x + content.origin.x) + "," + json_number(p.y + content.origin.y);
      if (content.with_z) text += "," + json_number(p.z);
      text += "]";
    }
    text += "]";
  }
  return text + "]";
}

std::string json_geometry(const RawFeature& feature, const Content& content) {
  if (feature.polygons.empty()) return "null";
  if (feature.polygons.size() == 1)
    return R"({"type":"Polygon","coordinates":)" + json_polygon(feature.polygons[0], content) + "}";
  std::string parts;
  for (const RawPolygon& polygon : feature.polygons)
    parts += (parts.empty() ? "" : ",") + json_polygon(polygon, content);
  return R"({"type":"MultiPolygon","coordinates":[)" + parts + "]}";
}

void write_geojson(const fs::path& path, const Content& content, const std::string& crs) {
  std::string text = R"({"type":"FeatureCollection",)";
  if (crs.starts_with("EPSG:"))
    text += fmt::format(
        R"("crs":{{"type":"name","properties":{{"name":"urn:ogc:def:crs:EPSG::{}"}}}},)",
        crs.substr(5));
  text += "\"features\":[\n";
  for (const RawFeature& feature : content.features) {
    if (&feature != &content.features.front()) text += ",\n";
    text += fmt::format(R"({{"type":"Feature","properties":{{"id":"{}","height":{}}},"geometry":)",
                        feature.id,
                        std::isfinite(feature.height) ? json_number(feature.height) : "null");
    text += json_geometry(feature, content) + "}";
  }
  write_file(path, text + "\n]}\n");
}

// --- Shapefile ---

constexpr std::int32_t kPolygonShape = 5;
constexpr std::int32_t kPolygonZShape = 15;
constexpr std::size_t kIdWidth = 40;
constexpr std::size_t kHeightWidth = 24;

class Bytes {
 public:
  template <typename Number>
  void little(Number value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    text_.append(bytes.data(), bytes.size());
  }
  void big(std::int32_t value) {
    auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.size());
  }
  void text(std::string_view value, std::size_t width, char fill) {
    text_ += value.substr(0, width);
    if (value.size() < width) text_.append(width - value.size(), fill);
  }
  const std::string& str() const { return text_; }
  std::int32_t words() const { return static_cast<std::int32_t>(text_.size() / 2); }

 private:
  std::string text_;
};

/// Least and greatest of the finite values; 0 and 0 without any.
struct Range {
  double low = kInfinity;
  double high = -kInfinity;
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double least() const { return low <= high ? low : 0; }
  double greatest() const { return low <= high ? high : 0; }
};

struct Box {
  Range x, y, z;
  void add(const RawFeature& feature, Point2 origin) {
    for (const RawPolygon& polygon : feature.polygons)
      for (const RawRing& ring : polygon)
        for (const RawVertex& p : ring) {
          x.add(p.x + origin.x);
          y.add(p.y + origin.y);
          z.add(p.z);
        }
  }
  void put(Bytes& bytes) const {
    for (const double value : {x.least(), y.least(), x.greatest(), y.greatest()})
      bytes.little(value);
  }
};

std::string shape_record(const RawFeature& feature, const Content& content) {
  Bytes bytes;
  if (feature.polygons.empty()) {
    bytes.little(std::int32_t{0});
    return bytes.str();
  }
  std::vector<const RawRing*> rings;
  for (const RawPolygon& polygon : feature.polygons)
    for (const RawRing& ring : polygon) rings.push_back(&ring);
  Box box;
  box.add(feature, content.origin);
  bytes.little(content.with_z ? kPolygonZShape : kPolygonShape);
  box.put(bytes);
  std::int32_t vertices = 0;
  for (const RawRing* ring : rings) vertices += static_cast<std::int32_t>(ring->size());
  bytes.little(static_cast<std::int32_t>(rings.size()));
  bytes.little(vertices);
  std::int32_t first = 0;
  for (const RawRing* ring : rings) {
    bytes.little(first);
    first += static_cast<std::int32_t>(ring->size());
  }
  for (const RawRing* ring : rings)
    for (const RawVertex& p : *ring) {
      bytes.little(p.x + content.origin.x);
      bytes.little(p.y + content.origin.y);
    }
  if (content.with_z) {
    bytes.little(box.z.least());
    bytes.little(box.z.greatest());
    for (const RawRing* ring : rings)
      for (const RawVertex& p : *ring) bytes.little(p.z);
  }
  return bytes.str();
}

std::string shape_header(const Box& box, std::int32_t words, const Content& content) {
  Bytes bytes;
  bytes.big(9994);
  for (int k = 0; k < 5; ++k) bytes.big(0);
  bytes.big(words);
  bytes.little(std::int32_t{1000});
  bytes.little(content.with_z ? kPolygonZShape : kPolygonShape);
  box.put(bytes);
  bytes.little(content.with_z ? box.z.least() : 0.0);
  bytes.little(content.with_z ? box.z.greatest() : 0.0);
  bytes.little(0.0);
  bytes.little(0.0);
  return bytes.str();
}

/// dBASE III: the attributes "id" and "height", without a date.
std::string attribute_table(const Content& content) {
  Bytes bytes;
  constexpr std::int16_t kFields = 2;
  constexpr auto kRecord = static_cast<std::int16_t>(1 + kIdWidth + kHeightWidth);
  bytes.text("\x03", 1, ' ');
  bytes.text("\x46\x01\x01", 3, ' ');
  bytes.little(static_cast<std::int32_t>(content.features.size()));
  bytes.little(static_cast<std::int16_t>(32 + 32 * kFields + 1));
  bytes.little(kRecord);
  bytes.text("", 20, '\0');
  const auto field = [&](const char* name, char type, std::size_t width, int decimals) {
    bytes.text(name, 11, '\0');
    bytes.text(std::string(1, type), 1, ' ');
    bytes.text("", 4, '\0');
    bytes.little(static_cast<std::uint8_t>(width));
    bytes.little(static_cast<std::uint8_t>(decimals));
    bytes.text("", 14, '\0');
  };
  field("id", 'C', kIdWidth, 0);
  field("height", 'N', kHeightWidth, 6);
  bytes.text("\x0D", 1, ' ');
  for (const RawFeature& feature : content.features) {
    bytes.text(" ", 1, ' ');
    bytes.text(feature.id, kIdWidth, ' ');
    bytes.text(std::isfinite(feature.height) ? fmt::format("{:24.6f}", feature.height) : "",
               kHeightWidth, ' ');
  }
  bytes.text("\x1A", 1, ' ');
  return bytes.str();
}

std::string esri_wkt(const std::string& crs) {
  const gdal::Srs srs = gdal::parse_srs(crs);
  if (srs == nullptr) return {};
  OSRMorphToESRI(srs.get());
  char* wkt = nullptr;
  std::string text;
  if (OSRExportToWkt(srs.get(), &wkt) == OGRERR_NONE && wkt != nullptr) text = wkt;
  CPLFree(wkt);
  return text;
}

void write_shapefile(const fs::path& path, const Content& content, const std::string& crs) {
  Box box;
  Bytes shapes, index;
  constexpr std::int32_t kHeaderWords = 50;
  std::int32_t number = 0;
  for (const RawFeature& feature : content.features) {
    box.add(feature, content.origin);
    const std::string record = shape_record(feature, content);
    const auto words = static_cast<std::int32_t>(record.size() / 2);
    index.big(kHeaderWords + shapes.words());
    index.big(words);
    shapes.big(++number);
    shapes.big(words);
    shapes.text(record, record.size(), ' ');
  }
  const auto put = [&](const char* extension, const std::string& text) {
    write_file(fs::path(path).replace_extension(extension), text);
  };
  put(".shx", shape_header(box, kHeaderWords + index.words(), content) + index.str());
  put(".dbf", attribute_table(content));
  put(".cpg", "UTF-8");
  if (!crs.empty()) put(".prj", esri_wkt(crs));
  put(".shp", shape_header(box, kHeaderWords + shapes.words(), content) + shapes.str());
}

}  // namespace

void write_raw_features(const fs::path& path, std::span<const RawFeature> features, Point2 origin,
                        const std::string& crs, bool with_z) {
  gdal::initialise();
  const gdal::QuietErrors errors;
  const std::string canonical = normalise_crs(crs);
  const Content content{features, origin, with_z};
  if (path.extension() == ".geojson") {
    write_geojson(path, content, canonical);
  } else if (path.extension() == ".shp") {
    write_shapefile(path, content, canonical);
  } else {
    throw Error(ErrorKind::kUsage,
                path.string() + ": raw features are written as .shp or .geojson; choose one");
  }
}

}  // namespace tetropolis
