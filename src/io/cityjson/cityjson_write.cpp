#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"

#include "extension.h"
#include "io/file/atomic_file.h"
#include "roof_solid.h"

namespace tetropolis {

namespace {

using Text = fmt::memory_buffer;

void put(Text& out, std::string_view text) { out.append(text.data(), text.data() + text.size()); }

/// The shortest text that reads back as the same double. Precondition: finite.
void put_number(Text& out, double value) {
  assert(std::isfinite(value));
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  assert(error == std::errc{});
  put(out, {text.data(), static_cast<std::size_t>(end - text.data())});
}

/// Bytes that are no UTF-8 become the replacement character.
void put_string(Text& out, const std::string& text) {
  put(out, nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

template <typename List, typename Put>
void put_list(Text& out, const List& list, const Put& put_item) {
  out.push_back('[');
  bool first = true;
  for (const auto& item : list) {
    if (!first) out.push_back(',');
    first = false;
    put_item(item);
  }
  out.push_back(']');
}

/// Numbers vertices in the order of their first use.
class VertexTable {
 public:
  std::int64_t index(double x, double y, double z) {
    const Key key = {steps(x), steps(y), steps(z)};
    const auto [at, is_new] =
        indices_.try_emplace(key, static_cast<std::int64_t>(vertices_.size()));
    if (is_new) {
      vertices_.push_back(key);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        min_[axis] = std::min(min_[axis], key[axis]);
        max_[axis] = std::max(max_[axis], key[axis]);
      }
    }
    return at->second;
  }
  using Key = std::array<std::int64_t, 3>;
  const std::vector<Key>& vertices() const { return vertices_; }
  const Key& min() const { return min_; }
  const Key& max() const { return max_; }

 private:
  static std::int64_t steps(double metres) { return std::llround(metres * kStepsPerMetre); }
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0;
      for (const std::int64_t v : key)
        h = (h ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ULL + (h >> 29);
      return static_cast<std::size_t>(h ^ (h >> 32));
    }
  };
  std::unordered_map<Key, std::int64_t, Hash> indices_;
  std::vector<Key> vertices_;
  Key min_{INT64_MAX, INT64_MAX, INT64_MAX};
  Key max_{INT64_MIN, INT64_MIN, INT64_MIN};
};

/// Vertex numbers of one ring at the two heights, in the direction of a cleaned footprint.
struct RingIndices {
  std::vector<std::int64_t> ground;
  std::vector<std::int64_t> roof;
};

RingIndices index_ring(VertexTable& vertices, const Ring& ring, bool counter_clockwise,
                       const Building& building) {
  // The first vertex stays the first when a ring is turned around.
  const bool turn = (signed_area(ring) > 0) != counter_clockwise;
  RingIndices result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2& p = ring[turn && i > 0 ? ring.size() - i : i];
    result.ground.push_back(vertices.index(p.x, p.y, building.h_ground));
  }
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point2& p = ring[turn && i > 0 ? ring.size() - i : i];
    result.roof.push_back(vertices.index(p.x, p.y, building.h_roof));
  }
  return result;
}

/// The footprint between h_ground and h_roof.
void put_block(Text& out, const Building& building, VertexTable& vertices) {
  std::vector<RingIndices> rings = {index_ring(vertices, building.footprint.outer, true, building)};
  for (const Ring& hole : building.footprint.holes)
    rings.push_back(index_ring(vertices, hole, false, building));
  const auto put_index = [&](std::int64_t v) { fmt::format_to(std::back_inserter(out), "{}", v); };
  put(out, "{\"type\":\"Solid\",\"lod\":\"1.2\",\"boundaries\":[[");
  put_list(out, rings, [&](const RingIndices& ring) {  // Looks down: the other way round.
    std::vector<std::int64_t> reversed(ring.ground.rbegin(), ring.ground.rend());
    std::rotate(reversed.begin(), reversed.end() - 1, reversed.end());
    put_list(out, reversed, put_index);
  });
  out.push_back(',');
  put_list(out, rings, [&](const RingIndices& ring) { put_list(out, ring.roof, put_index); });
  std::size_t walls = 0;
  for (const RingIndices& ring : rings)
    for (std::size_t i = 0; i < ring.ground.size(); ++i, ++walls) {
      const std::size_t next = (i + 1) % ring.ground.size();
      fmt::format_to(std::back_inserter(out), ",[[{},{},{},{}]]", ring.ground[i], ring.ground[next],
                     ring.roof[next], ring.roof[i]);
    }
  put(out,
      "]],\"semantics\":{\"surfaces\":[{\"type\":\"GroundSurface\"},{\"type\":\"RoofSurface\"},"
      "{\"type\":\"WallSurface\"}],\"values\":[[0,1");
  for (std::size_t i = 0; i < walls; ++i) put(out, ",2");
  put(out, "]]}}");
}

/// What the roof of a part rests on, as a semantic surface.
void put_roof_surface(Text& out, const RoofPart& part, const SolidFace& face, Point2 origin) {
  put(out, "{\"type\":\"RoofSurface\",\"source_id\":");
  put_string(out, part.source_id);
  fmt::format_to(std::back_inserter(out), ",\"lod\":\"{}\",\"slope\":", name_of(part.lod));
  put_number(out, slope_degrees(part.roof));
  if (const std::optional<double> azimuth = azimuth_degrees(part.roof)) {
    put(out, ",\"azimuth\":");
    put_number(out, *azimuth);
  }
  if (std::isfinite(part.rmse)) {
    put(out, ",\"rmse\":");
    put_number(out, part.rmse);
  }
  fmt::format_to(std::back_inserter(out), ",\"n_points\":{},\"roof_plane\":", part.n_points);
  const RoofPlane& plane = part.roof;
  put_list(out,
           std::array{origin.x + plane.at.x, origin.y + plane.at.y, plane.elevation, plane.slope_x,
                      plane.slope_y},
           [&](double v) { put_number(out, v + 0.0); });  // -0 would come back as 0
  if (!face.crossings.empty()) {
    put(out, ",\"crossings\":");
    put_list(out, face.crossings,
             [&](std::size_t at) { fmt::format_to(std::back_inserter(out), "{}", at); });
  }
  out.push_back('}');
}

/// The prisms below the roofs of the parts, as one body.
void put_parts(Text& out, const Building& building, Lod lod, Point2 origin, VertexTable& vertices) {
  const std::vector<SolidFace> faces = roof_solid(building);
  put(out, fmt::format("{{\"type\":\"Solid\",\"lod\":\"{}\",\"boundaries\":[", name_of(lod)));
  put_list(out, faces, [&](const SolidFace& face) {
    put_list(out, face.rings, [&](const std::vector<Point3>& ring) {
      put_list(out, ring, [&](const Point3& p) {
        fmt::format_to(std::back_inserter(out), "{}", vertices.index(p[0], p[1], p[2]));
      });
    });
  });
  put(out, "],\"semantics\":{\"surfaces\":[{\"type\":\"GroundSurface\"},");
  for (const SolidFace& face : faces) {
    if (face.kind != SolidFaceKind::kRoof) continue;
    put_roof_surface(out, building.parts[face.part], face, origin);
    out.push_back(',');
  }
  put(out,
      "{\"type\":\"WallSurface\",\"wall\":\"outer\"},{\"type\":\"WallSurface\",\"wall\":\"step\"}],"
      "\"values\":[");
  put_list(out, faces, [&](const SolidFace& face) {
    const std::size_t roofs = building.parts.size();
    const std::size_t value = face.kind == SolidFaceKind::kGround      ? 0
                              : face.kind == SolidFaceKind::kRoof      ? 1 + face.part
                              : face.kind == SolidFaceKind::kOuterWall ? 1 + roofs
                                                                       : 2 + roofs;
    fmt::format_to(std::back_inserter(out), "{}", value);
  });
  put(out, "]}}");
}

void put_geometry(Text& out, const Building& building, Point2 origin, VertexTable& vertices) {
  out.push_back('[');
  // The parts' solid has the highest level of any part, and is the only one of its level.
  const Lod lod = std::max(Lod::k1_2, highest_lod(building.parts));
  const bool has_parts = !building.parts.empty();
  if (!has_parts || lod != Lod::k1_2) put_block(out, building, vertices);
  if (has_parts) {
    if (lod != Lod::k1_2) out.push_back(',');
    put_parts(out, building, lod, origin, vertices);
  }
  out.push_back(']');
}

/// Attributes that are computed from the parts, and not read.
void put_summary(Text& out, const Building& building) {
  const auto put_thousandths = [&](double v) { put_number(out, std::nearbyint(v * 1000) / 1000); };
  fmt::format_to(std::back_inserter(out),
                 ",\"n_parts\":{},\"lod\":\"{}\",\"volume\":", building.parts.size(),
                 name_of(highest_lod(building.parts)));
  put_thousandths(volume_of(building));
  if (const double rmse = rmse_of(building.parts); std::isfinite(rmse)) {
    put(out, ",\"rmse\":");
    put_thousandths(rmse);
  }
}

void put_building(Text& out, const Building& building, Point2 origin, VertexTable& vertices) {
  const auto put_text = [&](const std::string& text) { put_string(out, text); };
  put_string(out, building.id);
  put(out, ":{\"type\":\"Building\",\"attributes\":{\"tetropolis_id\":");
  put_string(out, building.id);
  put(out, ",\"source_ids\":");
  put_list(out, building.source_ids, put_text);
  put(out, ",\"h_ground\":");
  put_number(out, building.h_ground);
  put(out, ",\"h_roof\":");
  put_number(out, building.h_roof);
  fmt::format_to(std::back_inserter(out), ",\"n_ground_points\":{},\"n_roof_points\":{},\"flags\":",
                 building.n_ground_points, building.n_roof_points);
  put_list(out, flag_names(building.flags), put_text);
  if (building.attribute_height > 0 && std::isfinite(building.attribute_height)) {
    put(out, ",\"attribute_height\":");
    put_number(out, building.attribute_height);
  }
  if (!building.parts.empty()) put_summary(out, building);
  put(out, "},\"geometry\":");
  put_geometry(out, building, origin, vertices);
  out.push_back('}');
}

void put_metadata(Text& out, const CityModel& model, const std::string& title,
                  const std::string& crs, const VertexTable& vertices) {
  const char* separator = "\"metadata\":{";
  const auto name = [&](const std::string& key) {
    put(out, separator);
    put_string(out, key);
    out.push_back(':');
    separator = ",";
  };
  if (!title.empty()) {
    name("title");
    put_string(out, title);
  }
  if (crs.starts_with("EPSG:")) {
    name("referenceSystem");
    put_string(out, "https://www.opengis.net/def/crs/EPSG/0/" + crs.substr(5));
  }
  if (!vertices.vertices().empty()) {
    name("geographicalExtent");
    const std::array<double, 3> origin = {model.origin.x, model.origin.y, 0};
    std::vector<double> extent;
    for (const VertexTable::Key& corner : {vertices.min(), vertices.max()})
      for (std::size_t axis = 0; axis < 3; ++axis)
        extent.push_back(origin[axis] + static_cast<double>(corner[axis]) / kStepsPerMetre);
    put_list(out, extent, [&](double v) { put_number(out, v); });
  }
  put(out, *separator == ',' ? "},\n" : "\"metadata\":{},\n");
}

void put_account(Text& out, const CityModel& model, const std::string& crs) {
  const auto put_value = [&](double v) { put_number(out, v); };
  put_string(out, kExtensionMember);
  put(out, ":{\"origin\":");
  put_list(out, std::array{model.origin.x, model.origin.y, 0.0}, put_value);
  put(out, ",\"crs\":");
  put_string(out, crs);
  if (!model.domain.empty()) {
    put(out, ",\"domain\":");
    const Bounds2 box = model.domain.moved(model.origin).bounds();
    put_list(out, std::array{box.xmin, box.ymin, box.xmax, box.ymax}, put_value);
  }
  if (!model.domain.is_box()) {
    put(out, ",\"domainSides\":");
    put_list(out, model.domain.moved(model.origin).sides(), [&](const Domain::Side& side) {
      const auto& own = model.domain.own_patches();
      const auto info = std::find_if(own.begin(), own.end(), [&](const PatchInfo& patch) {
        return patch.patch == side.patch;
      });
      put(out, "{\"from\":");
      put_list(out, std::array{side.from.x, side.from.y}, put_value);
      put(out, fmt::format(",\"patch\":{},\"name\":", static_cast<int>(side.patch)));
      put_string(out, info->name);
      put(out, "}");
    });
  }
  if (std::isfinite(model.domain_top)) {
    put(out, ",\"domainTop\":");
    put_value(model.domain_top);
  }
  put(out, ",\"dropped\":");
  put_list(out, model.dropped, [&](const Dropped& dropped) {
    put(out, "{\"source_id\":");
    put_string(out, dropped.source_id);
    put(out, ",\"reason\":");
    put_string(out, dropped.reason);
    out.push_back('}');
  });
  put(out, "},\n");
}

}  // namespace

void write_city(const std::filesystem::path& path, const CityModel& model,
                const std::string& title) {
  const std::string crs = normalise_crs(model.crs);
  VertexTable vertices;
  Text objects;
  for (const Building& building : model.buildings) {
    if (objects.size() > 0) put(objects, ",\n");
    put_building(objects, building, model.origin, vertices);
  }
  Text out;
  put(out, "{\"type\":\"CityJSON\",\"version\":\"2.0\",\n");
  put(out, fmt::format("\"extensions\":{{\"Tetropolis\":{{\"url\":\"{}\",\"version\":\"{}\"}}}},\n",
                       kExtensionUrl, kExtensionVersion));
  put(out, "\"transform\":{\"scale\":[0.0001,0.0001,0.0001],\"translate\":");
  put_list(out, std::array{model.origin.x, model.origin.y, 0.0},
           [&](double v) { put_number(out, v); });
  put(out, "},\n");
  put_metadata(out, model, title, crs, vertices);
  put_account(out, model, crs);
  put(out, "\"CityObjects\":{\n");
  AtomicFile file(path);
  file.write({out.data(), out.size()});
  file.write({objects.data(), objects.size()});
  out.clear();
  put(out, "\n},\n\"vertices\":[\n");
  for (std::size_t i = 0; i < vertices.vertices().size(); ++i) {
    const VertexTable::Key& v = vertices.vertices()[i];
    fmt::format_to(std::back_inserter(out), "{}[{},{},{}]", i == 0 ? "" : ",\n", v[0], v[1], v[2]);
  }
  put(out, "\n]}\n");
  file.write({out.data(), out.size()});
  file.commit();
}

}  // namespace tetropolis
