// The reference system of a LAS file from its GeoTIFF keys or its WKT.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tetropolis/io/crs/crs.h"

#include "io/crs/gdal_support.h"
#include "io/deferred/gdal_functions.h"
#include "las_header.h"

namespace tetropolis {

namespace {

constexpr int kGeoKeys = 34735;
constexpr int kGeoDoubles = 34736;
constexpr int kGeoAscii = 34737;
constexpr int kWkt = 2112;

template <typename Number>
void append(std::string& bytes, Number value) {
  char raw[sizeof(Number)];
  std::memcpy(raw, &value, sizeof(Number));
  bytes.append(raw, sizeof(Number));
}

/// A TIFF of one pixel (Aldus, TIFF 6.0, 1992) whose tags are built up in ascending order.
class TinyTiff {
 public:
  void add(int tag, int type, std::size_t count, std::string_view data) {
    append(directory_, static_cast<std::uint16_t>(tag));
    append(directory_, static_cast<std::uint16_t>(type));
    append(directory_, static_cast<std::uint32_t>(count));
    if (data.size() <= 4) {
      std::string inline_data(data);
      inline_data.resize(4, '\0');
      directory_ += inline_data;
    } else {
      append(directory_, static_cast<std::uint32_t>(kDataStart + data_.size()));
      data_ += data;
      if (data_.size() % 2 != 0) data_ += '\0';
    }
    ++tags_;
  }
  void add_short(int tag, std::uint16_t value) {
    std::string data;
    append(data, value);
    add(tag, 3, 1, data);
  }
  void add_doubles(int tag, std::initializer_list<double> values) {
    std::string data;
    for (const double value : values) append(data, value);
    add(tag, 12, values.size(), data);
  }
  /// Header, data from byte 8 on, directory at the end.
  std::string finish() const {
    std::string file = "II";
    append(file, std::uint16_t{42});
    append(file, static_cast<std::uint32_t>(kDataStart + data_.size()));
    file += data_;
    append(file, tags_);
    file += directory_;
    append(file, std::uint32_t{0});
    return file;
  }

 private:
  static constexpr std::size_t kDataStart = 8;
  std::string data_;
  std::string directory_;
  std::uint16_t tags_ = 0;
};

const Vlr* find(const std::vector<Vlr>& vlrs, int record_id) {
  for (const Vlr& vlr : vlrs)
    if (vlr.user_id == "LASF_Projection" && vlr.record_id == record_id) return &vlr;
  // libLAS wrote WKT under its own name before the standard had it.
  for (const Vlr& vlr : vlrs)
    if (record_id == kWkt && vlr.user_id == "liblas" && vlr.record_id == record_id) return &vlr;
  return nullptr;
}

/// The directory without the keys that have no bearing on x and y or name no known unit: PROJ,
/// asked for one by way of GDAL, complains on the error stream.
std::string sift_keys(std::string_view directory) {
  const auto number = [&](std::size_t entry, std::size_t field) {
    std::uint16_t value;
    std::memcpy(&value, directory.data() + entry * 8 + field * 2, sizeof value);
    return value;
  };
  std::string kept;
  std::uint16_t count = 0;
  const std::size_t entries = std::min<std::size_t>(number(0, 3), directory.size() / 8 - 1);
  for (std::size_t e = 1; e <= entries; ++e) {
    const int key = number(e, 0);
    const int value = number(e, 3);
    const bool unit = key == 2052 || key == 2054 || key == 2060 || key == 3076;
    const bool known = value == 32767 || (value >= 9001 && value <= 9122);
    if (key >= 4096 || (unit && !known)) continue;
    kept += directory.substr(e * 8, 8);
    ++count;
  }
  std::string result(directory.substr(0, 6));
  append(result, count);
  return result + kept;
}

/// The code of a projected system, if the keys (sifted) say nothing but that: as most files do, and
/// to ask for it is ten times as fast. 0 otherwise.
int stated_code(std::string_view directory) {
  int code = 0;
  bool is_projected = false;
  for (std::size_t at = 8; at + 8 <= directory.size(); at += 8) {
    std::array<std::uint16_t, 4> key{};  // its number, where the value is, how many, value
    std::memcpy(key.data(), directory.data() + at, 8);
    constexpr int kModelType = 1024, kRasterType = 1025, kProjectedSystem = 3072;
    if (key[1] != 0 || key[2] != 1) return 0;
    if (key[0] == kModelType)
      is_projected = key[3] == 1;
    else if (key[0] == kProjectedSystem)
      code = key[3];
    else if (key[0] != kRasterType)
      return 0;
  }
  return is_projected && code >= 1024 && code < 32767 ? code : 0;
}

/// LAS keeps the three GeoTIFF tags as they are in a TIFF, so GDAL may interpret them there: it
/// knows user-defined projections, units and the many ways in which keys are abused.
std::string crs_of_keys(const std::vector<Vlr>& vlrs) {
  const Vlr* keys = find(vlrs, kGeoKeys);
  if (keys == nullptr || keys->data.size() < 8) return "";
  const std::string directory = sift_keys(keys->data);
  if (const int code = stated_code(directory); code > 0) {
    const std::string name = fmt::format("EPSG:{}", code);
    const gdal::Srs srs = gdal::parse_srs(name);
    // Of a deprecated system, GDAL may return another one.
    if (srs != nullptr && OSRIsProjected(srs.get()) != 0 && gdal::canonical_name(srs.get()) == name)
      return name;
  }
  TinyTiff tiff;
  tiff.add_short(256, 1);  // Width.
  tiff.add_short(257, 1);  // Height.
  tiff.add_short(258, 8);  // Bits per sample.
  tiff.add_short(259, 1);  // No compression.
  tiff.add_short(262, 1);  // Black is zero.
  tiff.add_short(273, 8);  // The strip: one byte anywhere.
  tiff.add_short(277, 1);  // Samples per pixel.
  tiff.add_short(278, 1);  // Rows per strip.
  tiff.add_short(279, 1);  // Bytes of the strip.
  tiff.add_doubles(33550, {1, 1, 0});
  tiff.add_doubles(33922, {0, 0, 0, 0, 0, 0});
  tiff.add(kGeoKeys, 3, directory.size() / 2, directory);
  if (const Vlr* doubles = find(vlrs, kGeoDoubles); doubles != nullptr && doubles->data.size() >= 8)
    tiff.add(kGeoDoubles, 12, doubles->data.size() / 8,
             doubles->data.substr(0, doubles->data.size() / 8 * 8));
  if (const Vlr* ascii = find(vlrs, kGeoAscii); ascii != nullptr && !ascii->data.empty())
    tiff.add(kGeoAscii, 2, ascii->data.size(), ascii->data);
  std::string bytes = tiff.finish();
  const gdal::MemoryFolder folder;
  const std::string name = folder.path("keys.tif");
  VSIFCloseL(VSIFileFromMemBuffer(name.c_str(), reinterpret_cast<GByte*>(bytes.data()),
                                  bytes.size(), FALSE));
  constexpr const char* kDrivers[] = {"GTiff", nullptr};
  const gdal::Dataset dataset(GDALOpenEx(name.c_str(), GDAL_OF_RASTER, kDrivers, nullptr, nullptr));
  return dataset == nullptr ? "" : gdal::canonical_name(GDALGetSpatialRef(dataset.get()));
}

std::string crs_of_wkt(const std::vector<Vlr>& vlrs) {
  const Vlr* vlr = find(vlrs, kWkt);
  if (vlr == nullptr) return "";
  std::string wkt = vlr->data;
  wkt.resize(std::min(wkt.size(), wkt.find('\0')));
  return gdal::canonical_name(gdal::parse_srs(wkt).get());
}

std::string crs_of(const std::vector<Vlr>& vlrs, bool prefer_wkt) {
  if (find(vlrs, kGeoKeys) == nullptr && find(vlrs, kWkt) == nullptr) return "";
  gdal::initialise();
  const gdal::QuietErrors errors;
  const gdal::ConfigOption no_side_car("GDAL_PAM_ENABLED", "NO");
  const std::string first = prefer_wkt ? crs_of_wkt(vlrs) : crs_of_keys(vlrs);
  if (!first.empty()) return first;
  return prefer_wkt ? crs_of_keys(vlrs) : crs_of_wkt(vlrs);
}

/// Sets what a system says of heights.
void add_vertical(const std::vector<Vlr>& vlrs, bool prefer_wkt, LasSystems::System& system) {
  const gdal::QuietErrors errors;
  const auto read_vertical = [&](const std::string& text) {
    const gdal::Srs srs = gdal::parse_whole_srs(text);
    system.vertical_unit = gdal::vertical_unit_metres(srs.get());
    system.vertical_crs = gdal::vertical_name(srs.get());
  };
  const Vlr* wkt = find(vlrs, kWkt);
  const Vlr* keys = find(vlrs, kGeoKeys);
  if (wkt != nullptr && (prefer_wkt || keys == nullptr)) {
    read_vertical(wkt->data.substr(0, wkt->data.find('\0')));
    return;
  }
  if (keys == nullptr) return;
  // Of the keys, the unit (4099) counts more than that of the vertical system (4096).
  std::optional<double> unit;
  bool says_heights = false;
  for (std::size_t at = 8; at + 8 <= keys->data.size(); at += 8) {
    std::array<std::uint16_t, 4> key{};
    std::memcpy(key.data(), keys->data.data() + at, 8);
    says_heights = says_heights || key[0] == 4096 || key[0] == 4099;
    // What GeoTIFF 1.0 (6.3.4.1) has for heights above one of 33 ellipsoids is no code of EPSG's.
    if (key[0] == 4096 && key[3] >= 5001 && key[3] <= 5033)
      system.vertical_crs = gdal::kEllipsoidal;
    else if (key[0] == 4096 && key[3] > 1000 && key[3] < 32767)
      read_vertical(fmt::format("EPSG:{}", key[3]));
    if (key[0] == 4099 && key[3] == 9001) unit = 1;
    if (key[0] == 4099 && key[3] == 9002) unit = 0.3048;
    if (key[0] == 4099 && key[3] == 9003) unit = 1200.0 / 3937;
  }
  if (unit) system.vertical_unit = std::copysign(*unit, system.vertical_unit);
  // The keys rule, but where they say nothing of heights, feet of the WKT are not metres.
  if (!says_heights && wkt != nullptr) read_vertical(wkt->data.substr(0, wkt->data.find('\0')));
}

}  // namespace

LasSystems::System LasSystems::of(const std::vector<Vlr>& vlrs, bool prefer_wkt) {
  std::string records(1, prefer_wkt ? 'w' : 'k');
  for (const int id : {kGeoKeys, kGeoDoubles, kGeoAscii, kWkt})
    if (const Vlr* vlr = find(vlrs, id))
      records += fmt::format("{}:{}:", id, vlr->data.size()) + vlr->data;
  const std::lock_guard lock(mutex_);
  auto known = known_.find(records);
  if (known == known_.end()) {
    System system;
    system.crs = crs_of(vlrs, prefer_wkt);
    add_vertical(vlrs, prefer_wkt, system);
    known = known_.try_emplace(std::move(records), std::move(system)).first;
  }
  return known->second;
}

}  // namespace tetropolis
