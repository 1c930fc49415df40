#include "tetropolis/io/page/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/version.h"
#include "tetropolis/geometry/polygon.h"

#include "core/parallel.h"
#include "io/file/deflate.h"
#include "page_columns.h"
#include "page_template.h"

namespace tetropolis {

namespace {

using Json = nlohmann::ordered_json;

/// Level 4 takes twice as long to save 7 %.
constexpr int kLevel = 1;

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (std::size_t i = 0, at = 0; i < bytes.size(); i += 3, at += 4) {
    const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k <= count; ++k) text[at + k] = digits[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

/// The lowest bytes of all numbers first, then the second ones, and so on; small numbers of either
/// sign have small bytes (zigzag).
std::string shuffled(std::span<const std::int32_t> values) {
  std::string bytes(values.size() * 4, '\0');
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<std::uint32_t>(values[i]);
    const std::uint32_t zigzag = value << 1U ^ (values[i] < 0 ? ~0U : 0U);
    for (std::size_t b = 0; b < 4; ++b)
      bytes[b * values.size() + i] = static_cast<char>(zigzag >> 8 * b & 255U);
  }
  return bytes;
}

/// Named blocks of bytes, compressed and written as members of a JSON object, texts.
class Payload {
 public:
  void add(const char* name, std::span<const std::int32_t> values) {
    blocks_.push_back({name, shuffled(values)});
  }
  void add(const char* name, std::span<const std::uint8_t> bytes) {
    blocks_.push_back({name, {bytes.begin(), bytes.end()}});
  }
  void add(const char* name, std::string text) { blocks_.push_back({name, std::move(text)}); }
  void add_packed(const char* name, std::string_view text) {
    blocks_.push_back({name, std::string(text), true});
  }

  std::string text() {
    parallel_chunks(blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (!blocks_[i].is_packed) blocks_[i].bytes = base64(deflated(blocks_[i].bytes, kLevel));
    });
    std::string text;
    for (const Block& block : blocks_)
      text.append(text.empty() ? "\"" : ",\n\"").append(block.name).append("\":\"") +=
          block.bytes + '"';
    return text;
  }

 private:
  struct Block {
    const char* name;
    std::string bytes;
    bool is_packed = false;
  };
  std::vector<Block> blocks_;
};

/// Four arrays that polygons make: rings of each, points of each ring, coordinates in steps less
/// those of the point before.
class PolygonWriter {
 public:
  void add(const Polygon& polygon) {
    rings_.push_back(1 + static_cast<std::int32_t>(polygon.holes.size()));
    for_each_ring(polygon, [&](const Ring& ring) { add(ring); });
  }
  void write(Payload& payload, const std::array<const char*, 4>& names) const {
    const std::array arrays{&rings_, &points_, &x_, &y_};
    for (std::size_t i = 0; i < 4; ++i) payload.add(names[i], *arrays[i]);
  }

 private:
  void add(const Ring& ring) {
    points_.push_back(static_cast<std::int32_t>(ring.size()));
    for (const Point2 p : ring) {
      const std::int32_t x = page_steps(p.x), y = page_steps(p.y);
      x_.push_back(x - std::exchange(last_x_, x));
      y_.push_back(y - std::exchange(last_y_, y));
    }
  }

  std::vector<std::int32_t> rings_, points_, x_, y_;
  std::int32_t last_x_ = 0, last_y_ = 0;
};

double rounded(double metres) { return std::round(metres / kPageStep) * kPageStep; }

Json buildings_json(const CityModel& city) {
  Json buildings = Json::array();
  for (const Building& b : city.buildings) {
    buildings.push_back({{"id", b.id},
                         {"sources", b.source_ids},
                         {"ground", rounded(b.h_ground)},
                         {"roof", rounded(b.h_roof)},
                         {"top", rounded(highest_roof(b))},
                         {"groundPoints", b.n_ground_points},
                         {"roofPoints", b.n_roof_points},
                         {"flags", flag_names(b.flags)},
                         {"area", std::round(area(b.footprint) * 10) / 10}});
    if (b.parts.empty()) continue;
    buildings.back()["parts"] = b.parts.size();
    buildings.back()["lod"] = name_of(highest_lod(b.parts));
    if (const double rmse = rmse_of(b.parts); std::isfinite(rmse))
      buildings.back()["rmse"] = std::round(rmse * 1000) / 1000;
  }
  return buildings;
}

Json footprints_json(std::span<const PageFootprint> footprints) {
  Json list = Json::array();
  for (const PageFootprint& f : footprints) {
    list.push_back({{"source", f.source_id}, {"building", f.building.value()}});
    if (!f.reason.empty()) list.back()["reason"] = f.reason;
  }
  return list;
}

std::string facts_text(const PageContents& contents, const PageMesh& mesh) {
  const CityModel& city = contents.city;
  const Bounds2& domain = city.domain.bounds();
  Json outline = Json::array();
  for (const Point2 p : city.domain.outline().outer)
    for (const double coordinate : {p.x, p.y}) outline.push_back(rounded(coordinate));
  const Json facts{{"version", kVersion},
                   {"step", kPageStep},
                   {"origin", {city.origin.x, city.origin.y}},
                   {"crs", city.crs},
                   {"domain", {domain.xmin, domain.ymin, domain.xmax, domain.ymax}},
                   {"outline", outline},
                   {"mesh", mesh.is_shown},
                   {"volume", mesh.has_volume},
                   {"cells", mesh.cells},
                   {"layers", mesh.layers},
                   {"whole", mesh.is_whole},
                   {"buildings", buildings_json(city)},
                   {"footprints", footprints_json(contents.footprints)},
                   {"dropped", contents.dropped},
                   {"repeat", contents.repeat}};
  std::string text = facts.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (contents.report.empty()) return text;
  text.pop_back();
  return text + ",\"report\":" + contents.report + "}";
}

void add_columns(const ColumnMesh& mesh, bool floors_only, Payload& payload) {
  const PageColumns columns = page_columns(mesh, floors_only);
  payload.add("x", columns.x);
  payload.add("y", columns.y);
  payload.add("corners", columns.corners);
  payload.add("region", columns.region);
  payload.add("regionBuilding", columns.building);
  payload.add("roof", columns.roof);
  payload.add("count", columns.count);
  payload.add("floor", columns.floor);
  payload.add("z", columns.z);
  payload.add("odd", columns.odd);
  payload.add("steps", columns.steps);
  payload.add("upperCount", columns.upper.count);
  payload.add("upperRise", columns.upper.rise);
  payload.add("upperWait", columns.upper.wait);
  payload.add("upperSplits", columns.upper.splits);
}

}  // namespace

PageMesh page_mesh(const ColumnMesh& mesh, std::int64_t most_cells) {
  PageMesh page;
  page.cells = cell_offsets(mesh).back().value() + mesh.layers.cells();
  page.is_shown = std::ssize(mesh.ground.triangles) <= kMostPageTriangles;
  if (!page.is_shown) return page;
  page.has_volume = page.cells <= most_cells;
  if (page.has_volume) {
    page.layers = mesh.layers.count;
    page.is_whole = mesh.layers.whole;
  }
  Payload payload;
  add_columns(mesh, !page.has_volume, payload);
  page.blocks = payload.text();
  return page;
}

std::string page_html(const PageContents& contents) {
  const PageMesh none;
  const PageMesh& mesh = contents.mesh == nullptr ? none : *contents.mesh;
  Payload payload;
  payload.add("facts", facts_text(contents, mesh));
  PolygonWriter after, before;
  for (const Building& building : contents.city.buildings) after.add(building.footprint);
  for (const PageFootprint& footprint : contents.footprints) before.add(footprint.polygon);
  after.write(payload, {"afterRings", "afterPoints", "afterX", "afterY"});
  before.write(payload, {"beforeRings", "beforePoints", "beforeX", "beforeY"});

  constexpr std::string_view data_mark = "@@TETROPOLIS@@", program_mark = "@@PROGRAM@@\n";
  const std::string_view page = page_template();
  const std::size_t data = page.find(data_mark), program = page.find(program_mark);
  payload.add_packed("program", page.substr(program + program_mark.size()));
  std::string html(page.substr(0, data));
  html.append("{").append(payload.text());
  if (!mesh.blocks.empty()) html.append(",\n").append(mesh.blocks);
  html += '}';
  return html.append(page.substr(data + data_mark.size(), program - data - data_mark.size()));
}

}  // namespace tetropolis
