#include "citygml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/crs/crs.h"
#include "tetropolis/io/crs/geo_place.h"

#include "core/files.h"
#include "io/crs/gdal_support.h"
#include "io/file/input_file.h"
#include "io/file/positioned_file.h"
#include "io/file/xml_reader.h"
#include "model_metres.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

struct GmlPolygon {
  std::string id;
  std::string semantics;  ///< "GroundSurface", ...; "" if none.
  int lod = 0;
  std::vector<std::vector<Point3>> rings;
};

struct GmlObject {
  std::string id;
  bool is_part = false;
  bool has_parts = false;
  double height = 0;   ///< measuredHeight; 0 if there is none.
  double storeys = 0;  ///< storeysAboveGround.
  std::string parent;  ///< Id of the object that it is a part of.
  Json attributes = Json::object();
  std::vector<GmlPolygon> polygons;
};

std::string_view local(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

std::string_view attribute(const XML_Char** attributes, std::string_view wanted) {
  for (; *attributes != nullptr; attributes += 2)
    if (local(attributes[0]) == wanted) return attributes[1];
  return {};
}

bool is_object(std::string_view name) { return name == "Building" || name == "BuildingPart"; }

bool is_surface(std::string_view name) {
  for (const std::string_view known :
       {"GroundSurface", "RoofSurface", "WallSurface", "ClosureSurface", "OuterFloorSurface",
        "OuterCeilingSurface", "FloorSurface", "CeilingSurface", "InteriorWallSurface"})
    if (name == known) return true;
  return false;
}

/// What is in a building but none of its shell.
bool is_beside(std::string_view name) {
  for (const std::string_view known :
       {"BuildingInstallation", "IntBuildingInstallation", "Room", "BuildingRoom", "BuildingUnit",
        "BuildingFurniture", "Door", "Window", "DoorSurface", "WindowSurface", "Address",
        "BuildingConstructiveElement", "appearance", "appearanceMember"})
    if (name == known) return true;
  return false;
}

class GmlReader : public XmlReader {
 public:
  explicit GmlReader(const fs::path& path) : path_(path) {}

  void read() {
    const PositionedFile file(path_);
    std::int64_t at = 0;
    parse(path_, [&](char* data, std::size_t size) {
      const std::size_t read = file.read(at, data, size);
      at += static_cast<std::int64_t>(read);
      return read;
    });
  }

  std::vector<GmlObject> objects;                   ///< In the order in which they begin.
  std::string srs;                                  ///< The first that is named.
  std::map<std::string, std::string> semantics_of;  ///< Of polygons that surfaces refer to.

 private:
  void start(std::string_view element, Attributes attributes) override {
    const std::string_view name = local(element);
    if (srs.empty())
      if (const std::string_view named = attribute(attributes, "srsName"); !named.empty())
        srs = named;
    if (beside_ > 0 || is_beside(name)) {
      ++beside_;
      is_leaf_ = wants_text_ = false;
      return;
    }
    is_leaf_ = true;
    if (is_object(name)) {
      if (!open_.empty()) objects[open_.back()].has_parts = true;
      std::string parent = open_.empty() ? "" : objects[open_.back()].id;
      open_.push_back(objects.size());
      levels_.push_back(0);
      GmlObject& object = objects.emplace_back();
      object.parent = std::move(parent);
      object.id = attribute(attributes, "id");
      object.is_part = name == "BuildingPart";
      return;
    }
    if (open_.empty()) return;
    if (++levels_.back() == 1) generic_ = attribute(attributes, "name");
    if (name.size() > 4 && name.starts_with("lod") && name[3] >= '0' && name[3] <= '4') {
      lod_ = name[3] - '0';
      is_roof_edge_ = name == "lod0RoofEdge";
    }
    if (name == "Height") in_height_ = true;  // of CityGML 3.0
    if (is_surface(name)) semantics_ = name;
    if (name == "surfaceMember" && !semantics_.empty())
      if (const std::string_view link = attribute(attributes, "href"); link.starts_with('#'))
        semantics_of[std::string(link.substr(1))] = semantics_;
    if (name == "Polygon" || name == "Triangle" || name == "Rectangle" || name == "PolygonPatch") {
      polygon_ = {};
      polygon_.id = attribute(attributes, "id");
      polygon_.semantics = semantics_;
      polygon_.lod = lod_;
      in_polygon_ = true;
    }
    if (in_polygon_ && name == "LinearRing") {
      polygon_.rings.emplace_back();
      dimension_ = 3;
    }
    if (const std::string_view given = attribute(attributes, "srsDimension"); !given.empty())
      dimension_ = given == "2" ? 2 : 3;
    wants_text_ = (in_polygon_ && (name == "posList" || name == "pos")) || levels_.back() == 1 ||
                  name == "measuredHeight" || name == "storeysAboveGround" || name == "value";
    text_.clear();
  }

  void end(std::string_view element) override {
    const std::string_view name = local(element);
    if (beside_ > 0) {
      --beside_;
      return;
    }
    if (open_.empty()) return;
    GmlObject& object = objects[open_.back()];
    if (std::exchange(is_leaf_, false)) add_attribute(object, name);
    if (in_polygon_ && (name == "posList" || name == "pos")) {
      add_positions();
    } else if (name == "measuredHeight" || (name == "value" && in_height_)) {
      object.height = number_of(text_, object.height);
    } else if (name == "storeysAboveGround") {
      object.storeys = number_of(text_, object.storeys);
    } else if (name == "Polygon" || name == "Triangle" || name == "Rectangle" ||
               name == "PolygonPatch") {
      if (!(is_roof_edge_ && has_footprint(object))) object.polygons.push_back(std::move(polygon_));
      in_polygon_ = false;
    } else if (name == "Height") {
      in_height_ = false;
    } else if (is_surface(name)) {
      semantics_.clear();
    } else if (is_object(name)) {
      open_.pop_back();
      levels_.pop_back();
    }
    if (!is_object(name)) --levels_.back();
    wants_text_ = false;
  }

  void text(std::string_view piece) override {
    if (wants_text_) text_.append(piece);
  }

  /// Of an element without others in it: one of the object's own, or the value of a generic one.
  void add_attribute(GmlObject& object, std::string_view name) {
    const bool is_generic = levels_.back() == 2 && name == "value" && !generic_.empty();
    if (levels_.back() != 1 && !is_generic) return;
    const std::size_t first = text_.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return;
    const std::size_t last = text_.find_last_not_of(" \t\r\n");
    object.attributes.emplace(is_generic ? generic_ : std::string(name),
                              value_of(std::string_view(text_).substr(first, last - first + 1)));
  }

  /// A number, unless it begins with zeros as codes do.
  static Json value_of(std::string_view text) {
    const char* const end = text.data() + text.size();
    const std::string_view digits = text.substr(text.starts_with('-') ? 1 : 0);
    const auto is_digit = [&](std::size_t i) {
      return i < digits.size() && digits[i] >= '0' && digits[i] <= '9';
    };
    const auto is_whole = [&](const std::from_chars_result& result) {
      return result.ec == std::errc{} && result.ptr == end;
    };
    std::int64_t integer = 0;
    double real = 0;
    if (is_digit(0) && !(digits[0] == '0' && is_digit(1))) {
      if (is_whole(std::from_chars(text.data(), end, integer))) return integer;
      if (is_whole(std::from_chars(text.data(), end, real, std::chars_format::fixed))) return real;
    }
    return std::string(text);
  }

  static bool has_footprint(const GmlObject& object) {
    return std::any_of(object.polygons.begin(), object.polygons.end(),
                       [](const GmlPolygon& polygon) { return polygon.lod == 0; });
  }

  static double number_of(std::string_view text, double otherwise) {
    while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
    double value = otherwise;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }

  void add_positions() {
    if (polygon_.rings.empty()) return;
    std::vector<double> numbers;
    const char* at = text_.data();
    const char* const stop = at + text_.size();
    while (at != stop) {
      while (at != stop && (static_cast<unsigned char>(*at) <= ' ' || *at == ',' || *at == '+'))
        ++at;
      if (at == stop) break;
      double value = 0;
      const auto [next, error] = std::from_chars(at, stop, value);
      if (error != std::errc{} || !std::isfinite(value))
        fail_input(path_, fmt::format("line {}: a position that is no number; get the file again",
                                      line()));
      numbers.push_back(value);
      at = next;
    }
    const auto step = static_cast<std::size_t>(dimension_);
    for (std::size_t k = 0; k + step <= numbers.size(); k += step)
      polygon_.rings.back().push_back(
          {numbers[k], numbers[k + 1], step == 3 ? numbers[k + 2] : 0.0});
  }

  const fs::path& path_;
  std::vector<std::size_t> open_;  ///< Buildings and parts around the place, the innermost last.
  std::vector<int> levels_;        ///< How many elements are open in each of these.
  int beside_ = 0;                 ///< Depth within something to pass over.
  int lod_ = 0;
  int dimension_ = 3;
  bool is_roof_edge_ = false;
  bool in_polygon_ = false;
  bool in_height_ = false;
  bool wants_text_ = false;
  bool is_leaf_ = false;  ///< Nothing has begun or ended in the element that began last.
  std::string generic_;   ///< Name of the attribute around, if it is a generic one.
  std::string semantics_;
  std::string text_;
  GmlPolygon polygon_;
};

/// What the names of the German surveys stand for.
std::string german_system(const std::string& srs) {
  constexpr std::pair<std::string_view, const char*> kNames[] = {
      {"ETRS89_UTM31", "EPSG:25831"}, {"ETRS89_UTM32", "EPSG:25832"},
      {"ETRS89_UTM33", "EPSG:25833"}, {"DHDN_3GK2", "EPSG:31466"},
      {"DHDN_3GK3", "EPSG:31467"},    {"DHDN_3GK4", "EPSG:31468"},
      {"DHDN_3GK5", "EPSG:31469"}};
  for (const auto& [name, code] : kNames)
    if (srs.find(name) != std::string::npos) return code;
  return {};
}

/// Whether names of that kind mean the authority's own order of axes, which is the northing first.
bool is_north_first(const std::string& srs) {
  if (!srs.starts_with("urn:ogc:") && srs.find("opengis.net/def/crs") == std::string::npos)
    return false;
  const gdal::Srs whole = gdal::parse_whole_srs(srs);
  if (whole == nullptr) return false;
  OSRSetAxisMappingStrategy(whole.get(), OAMS_AUTHORITY_COMPLIANT);
  OGRAxisOrientation towards = OAO_Other;
  OSRGetAxis(whole.get(), nullptr, 0, &towards);
  return towards == OAO_North;
}

/// Whether points lie where their system is used only with the easting first: 3DCityDB writes what
/// is in its database, whatever the name of the system means.
bool lie_east_first(const std::string& crs, std::span<const Point3> points) {
  Bounds2 box = Bounds2::nothing();
  for (const Point3& p : points) box.extend(Point2{p[0], p[1]});
  const auto is_used = [&](const Bounds2& where) {
    const auto place = place_of(crs, where);
    return place && place->is_in_area;
  };
  return is_used(box) && !is_used({box.ymin, box.xmin, box.ymax, box.xmax});
}

/// All coordinates of all polygons.
template <typename Visit>
void for_each_point(std::vector<GmlObject>& objects, const Visit& visit) {
  for (GmlObject& object : objects)
    for (GmlPolygon& polygon : object.polygons)
      for (std::vector<Point3>& ring : polygon.rings)
        for (Point3& p : ring) visit(p);
}

/// Puts coordinates into a system in metres, x first; no system if nobody says which.
ModelMetres settle_system(const fs::path& path, const std::string& srs,
                          std::vector<GmlObject>& objects, ModelDocument& document) {
  gdal::initialise();
  std::string crs = german_system(srs);
  if (crs.empty() && !srs.empty()) {
    try {
      crs = normalise_crs(srs);
    } catch (const Error&) {
      fail_input(path, fmt::format("states the CRS '{}', which PROJ does not know; replace srsName "
                                   "by an EPSG code",
                                   srs.substr(0, 80)));
    }
  }
  std::vector<Point3> points;
  for_each_point(objects, [&](Point3& p) { points.push_back(p); });
  {
    const gdal::QuietErrors errors;
    if (is_north_first(srs)) {
      document.is_east_first = lie_east_first(crs, points);
      if (!document.is_east_first)
        for (Point3& p : points) std::swap(p[0], p[1]);
    }
  }
  ModelMetres metres = put_into_metres(path, srs, crs, points);
  std::size_t next = 0;
  for_each_point(objects, [&](Point3& p) { p = points[next++]; });
  return metres;
}

class JsonWriter {
 public:
  JsonWriter(std::array<double, 3> translate) : translate_(translate) {}

  Json surface(const GmlPolygon& polygon, double lift = 0, bool turned = false) {
    Json rings = Json::array();
    for (std::vector<Point3> ring : polygon.rings) {
      if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
      if (turned) std::reverse(ring.begin(), ring.end());
      Json indices = Json::array();
      for (Point3 p : ring) {
        p[2] += lift;
        indices.push_back(vertex(p));
      }
      rings.push_back(std::move(indices));
    }
    return rings;
  }

  Json vertices = Json::array();
  static constexpr double kScale = 0.001;

 private:
  std::size_t vertex(const Point3& p) {
    std::array<std::int64_t, 3> key{};
    for (std::size_t c = 0; c < 3; ++c) key[c] = std::llround((p[c] - translate_[c]) / kScale);
    const auto [place, is_new] = known_.try_emplace(key, known_.size());
    if (is_new) vertices.push_back({key[0], key[1], key[2]});
    return place->second;
  }

  std::array<double, 3> translate_;
  std::map<std::array<std::int64_t, 3>, std::size_t> known_;
};

Json geometry_of(std::span<const GmlPolygon* const> polygons, int lod, JsonWriter& writer) {
  Json surfaces = Json::array(), values = Json::array(), boundaries = Json::array();
  std::map<std::string, std::size_t> indices;
  for (const GmlPolygon* polygon : polygons) {
    boundaries.push_back(writer.surface(*polygon));
    if (polygon->semantics.empty()) {
      values.push_back(nullptr);
      continue;
    }
    const auto [place, is_new] = indices.try_emplace(polygon->semantics, indices.size());
    if (is_new) surfaces.push_back({{"type", polygon->semantics}});
    values.push_back(place->second);
  }
  Json geometry{{"type", "MultiSurface"},
                {"lod", std::to_string(lod)},
                {"boundaries", std::move(boundaries)}};
  if (!surfaces.empty()) geometry["semantics"] = {{"surfaces", surfaces}, {"values", values}};
  return geometry;
}

/// Of outlines alone: a ground and a roof.
Json prism_of(std::span<const GmlPolygon* const> polygons, double height, JsonWriter& writer) {
  Json boundaries = Json::array(), values = Json::array();
  for (const GmlPolygon* polygon : polygons) {
    boundaries.push_back(writer.surface(*polygon));
    values.push_back(0);
    boundaries.push_back(writer.surface(*polygon, height));
    values.push_back(1);
  }
  return {{"type", "MultiSurface"},
          {"lod", "1"},
          {"boundaries", std::move(boundaries)},
          {"semantics",
           {{"surfaces", {{{"type", "GroundSurface"}}, {{"type", "RoofSurface"}}}},
            {"values", std::move(values)}}}};
}

Json geometries_of(const GmlObject& object, JsonWriter& writer, bool& is_without_height) {
  std::map<int, std::vector<const GmlPolygon*>> by_lod;
  for (const GmlPolygon& polygon : object.polygons)
    if (!polygon.rings.empty() && polygon.rings.front().size() >= 3)
      by_lod[polygon.lod].push_back(&polygon);
  Json geometries = Json::array();
  for (const auto& [lod, polygons] : by_lod)
    if (lod > 0) geometries.push_back(geometry_of(polygons, lod, writer));
  if (!geometries.empty() || !by_lod.contains(0)) return geometries;
  constexpr double kStorey = 3, kUnknown = 6;
  double height = object.height > 0 ? object.height : object.storeys * kStorey;
  is_without_height = !(height > 0);
  if (is_without_height) height = kUnknown;
  geometries.push_back(prism_of(by_lod[0], height, writer));
  return geometries;
}

}  // namespace

bool is_citygml(const fs::path& path) {
  constexpr std::size_t kSize = std::size_t{1} << 16;
  if (!is_file(path)) return false;
  std::string block(kSize, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(block.data(), static_cast<std::streamsize>(kSize));
  block.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  const std::size_t first = block.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  return first != std::string::npos && block[first] == '<' &&
         block.find("CityModel") != std::string::npos && block.find("citygml") != std::string::npos;
}

ModelDocument read_citygml(const fs::path& path) {
  GmlReader reader(path);
  reader.read();
  std::vector<GmlObject>& objects = reader.objects;
  if (objects.empty())
    fail_input(path,
               "is CityGML without a building (Building, BuildingPart); name the file of the "
               "buildings");
  for (GmlObject& object : objects)
    for (GmlPolygon& polygon : object.polygons)
      if (const auto named = reader.semantics_of.find(polygon.id);
          polygon.semantics.empty() && !polygon.id.empty() && named != reader.semantics_of.end())
        polygon.semantics = named->second;
  ModelDocument document;
  const ModelMetres metres = settle_system(path, reader.srs, objects, document);
  Bounds2 box = Bounds2::nothing();
  for_each_point(objects, [&](Point3& p) { box.extend(Point2{p[0], p[1]}); });
  std::array<double, 3> translate{};
  if (!box.empty()) translate = {std::floor(box.xmin), std::floor(box.ymin), 0};
  JsonWriter writer(translate);
  Json list = Json::object();
  std::set<std::string> taken;
  std::size_t number = 0;
  for (const GmlObject& object : objects) {
    ++number;
    std::string key = object.id.empty() ? fmt::format("building {}", number) : object.id;
    for (int k = 2; !taken.insert(key).second; ++k) key = fmt::format("{}~{}", object.id, k);
    bool is_without_height = false;
    Json json{{"type", object.is_part ? "BuildingPart" : "Building"},
              {"geometry", geometries_of(object, writer, is_without_height)}};
    if (is_without_height) document.without_height.push_back(key);
    if (!object.attributes.empty()) json["attributes"] = object.attributes;
    if (object.is_part) json["parents"] = {object.parent};
    if (object.has_parts) json["children"] = {""};
    list[key] = std::move(json);
    document.keys.push_back(std::move(key));
  }
  constexpr double kScale = JsonWriter::kScale;
  document.root = {{"type", "CityJSON"},
                   {"version", "2.0"},
                   {"transform", {{"scale", {kScale, kScale, kScale}}, {"translate", translate}}},
                   {"CityObjects", std::move(list)},
                   {"vertices", std::move(writer.vertices)}};
  document.height_unit = metres.height_unit;
  if (!metres.crs.empty()) document.root["metadata"] = {{"referenceSystem", metres.crs}};
  return document;
}

}  // namespace tetropolis
