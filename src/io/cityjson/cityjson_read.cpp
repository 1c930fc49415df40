#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tetropolis/city/roof_summary.h"
#include "tetropolis/core/error.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/io/cityjson/cityjson.h"
#include "tetropolis/io/crs/crs.h"

#include "body_footprint.h"
#include "body_parts.h"
#include "city/part_tiling.h"
#include "cityjson_geometry.h"
#include "core/infinity.h"
#include "extension.h"
#include "io/file/json_place.h"
#include "is_prism.h"
#include "model_document.h"
#include "model_metres.h"
#include "object_attributes.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

/// Attributes of our own files; members that are missing keep their defaults.
void read_attributes(const Place& attributes, Building& building) {
  const auto integer = [&](const char* key) -> std::int64_t {
    return attributes.has(key) ? std::llround(std::clamp(attributes.at(key).number(), 0.0, 9e15))
                               : 0;
  };
  building.id = attributes.at("tetropolis_id").text();
  building.source_ids.clear();
  const Place ids = attributes.at("source_ids");
  for (std::size_t i = 0; i < ids.size(); ++i) building.source_ids.push_back(ids.at(i).text());
  if (ids.size() == 0) ids.fail("is empty");
  building.h_ground = attributes.at("h_ground").number();
  building.h_roof = attributes.at("h_roof").number();
  building.n_ground_points = integer("n_ground_points");
  building.n_roof_points = integer("n_roof_points");
  if (attributes.has("attribute_height"))
    building.attribute_height = attributes.at("attribute_height").number();
  if (!attributes.has("flags")) return;
  std::vector<std::string> names;
  const Place flags = attributes.at("flags");
  for (std::size_t i = 0; i < flags.size(); ++i) names.push_back(flags.at(i).text());
  building.flags = flags_from_names(names);
}

/// What a roof of our own files stands for.
RoofPart read_part(const Face& face, Point2 origin) {
  constexpr double kRounding = 0.05;  // metres: other programs may round coordinates
  const Place& semantics = *face.semantics;
  const Place plane = semantics.at("roof_plane");
  if (plane.size() != 5) plane.fail("is not x, y, z, slope_x, slope_y");
  RoofPart part;
  part.roof = {{plane.at(0).number() - origin.x, plane.at(1).number() - origin.y},
               plane.at(2).number(),
               plane.at(3).number(),
               plane.at(4).number()};
  part.source_id = semantics.at("source_id").text();
  const std::string& lod = semantics.at("lod").text();
  constexpr std::array kLods = {Lod::kBlock, Lod::k1_2, Lod::k1_3, Lod::k2_2};
  const auto level =
      std::find_if(kLods.begin(), kLods.end(), [&](Lod l) { return name_of(l) == lod; });
  if (level == kLods.end()) semantics.at("lod").fail("is not block, 1.2, 1.3 or 2.2");
  part.lod = *level;
  part.n_points = std::llround(std::clamp(semantics.at("n_points").number(), 0.0, 9e15));
  part.rmse = semantics.has("rmse") ? semantics.at("rmse").number()
                                    : std::numeric_limits<double>::quiet_NaN();
  std::vector<double> crossings;
  if (semantics.has("crossings"))
    for (std::size_t i = 0; i < semantics.at("crossings").size(); ++i)
      crossings.push_back(semantics.at("crossings").at(i).number());
  double position = 0;
  for (std::size_t r = 0; r < face.rings.size(); ++r) {
    Ring& ring = r == 0 ? part.outline.outer : part.outline.holes.emplace_back();
    for (const Point3& p : face.rings[r]) {
      if (std::find(crossings.begin(), crossings.end(), position++) != crossings.end()) continue;
      ring.push_back({p[0], p[1]});
      if (!(std::abs(part.roof(ring.back()) - p[2]) <= kRounding))
        plane.fail(fmt::format("is {:.3f} m above a corner of the roof; write the file again",
                               part.roof(ring.back()) - p[2]));
    }
  }
  return part;
}

/// The parts of a building of ours; none if its roof is one flat face.
std::vector<RoofPart> read_parts(const std::vector<Face>& faces, Point2 origin) {
  std::vector<RoofPart> parts;
  for (const Face& face : faces)
    if (face.semantics && face.semantics->has("roof_plane"))
      parts.push_back(read_part(face, origin));
  return parts;
}

bool is_ours(const Place& object, const std::string& key) {
  if (!object.has("attributes")) return false;
  const Json& attributes = object.at("attributes").value();
  if (!attributes.is_object()) return false;
  const auto id = attributes.find("tetropolis_id");
  return id != attributes.end() && id->is_string() && *id == key;
}

constexpr double kLeastHeight = 2;  ///< Metres: a roof lower than that is a floor.
constexpr double kFlat = 0.5;       ///< Metres: as far as roofs are flat anyway.

struct Heights {
  double low = kInfinity, high = -kInfinity;  ///< Of ground and roof.
  bool is_flattened = false;                  ///< The roof reaches higher.
};

/// Of a body of another program, whose footprint these are.
Heights heights_of(std::span<const Face> faces, std::span<const Polygon> footprint) {
  Heights heights;
  for (const Face& face : faces) {
    const auto [low, high] = elevations(face);
    heights.low = std::min(heights.low, low);
    heights.high = std::max(heights.high, high);
  }
  double whole = 0;
  for (const Polygon& polygon : footprint) whole += area(polygon);
  const std::optional<double> roof = roof_height_of(faces, whole);
  if (roof && *roof >= heights.low + kLeastHeight) {
    heights.is_flattened = heights.high - *roof > kFlat;
    heights.high = *roof;
  }
  return heights;
}

/// Whether what semantics call a roof is that far below it.
bool has_roof_below(std::span<const Face> faces, double level) {
  return std::any_of(faces.begin(), faces.end(), [&](const Face& face) {
    return face.is_roof && elevations(face).first < level - kFlat;
  });
}

/// Of roofs of another program.
Lod lod_of(double level) { return level >= 2 ? Lod::k2_2 : level >= 1.25 ? Lod::k1_3 : Lod::k1_2; }

class CityReader {
 public:
  /// `objects`: all of the file, with these `keys`. `details`, if given: see read_city.
  CityReader(const CityFrame& frame, const Json& objects, std::span<const std::string> keys,
             CityModel& model, CityDetails* details)
      : frame_(frame),
        objects_(objects),
        keys_(keys.begin(), keys.end()),
        model_(model),
        details_(details) {}

  void add(const Place& object, const std::string& key) {
    const std::string& type = object.at("type").text();
    if (type != "Building" && type != "BuildingPart") {
      if (type.starts_with('+')) extension_types_.push_back(type);
      if (type == "TINRelief") ++reliefs_;
      return;
    }
    ObjectFaces geometry = read_faces(object, frame_);
    if (geometry.faces.empty()) {
      const bool holds_parts = object.has("children") && object.at("children").size() > 0;
      if (!holds_parts) model_.dropped.push_back({key, geometry.reason});
      return;
    }
    FootprintResult footprint = footprint_of(geometry.faces);
    if (footprint.polygons.empty()) {
      model_.dropped.push_back({key, footprint.reason});
      return;
    }
    if (is_ours(object, key))
      add_ours(object, geometry.faces, std::move(footprint));
    else
      add_foreign(key, geometry, std::move(footprint));
  }

  /// The same; an object that contradicts the format is dropped.
  void add_or_drop(const Place& object, const std::string& key) {
    try {
      add(object, key);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kInput) throw;
      model_.dropped.push_back({key, object.without_file(error.what())});
    }
  }

  /// Ids of buildings of ours whose solid is not what their ground and attributes make.
  const std::vector<std::string>& other_solids() const { return other_solids_; }

  /// Of objects of extensions.
  const std::vector<std::string>& extension_types() const { return extension_types_; }

  /// Objects of terrain.
  std::size_t reliefs() const { return reliefs_; }

  /// How many roofs of others reach higher than the height they get, and the first, with why.
  std::size_t flattened() const { return flattened_; }
  const std::string& first_flattened() const { return first_flattened_; }

  /// Foreign buildings get their numbers last, apart from the ids that files of ours brought.
  void finish() {
    std::unordered_set<std::string> taken;
    for (const Building& building : model_.buildings)
      if (!building.id.empty()) taken.insert(building.id);
    std::size_t number = 1;
    for (Building& building : model_.buildings) {
      while (building.id.empty()) {
        std::string id = "b" + std::to_string(number++);
        if (taken.insert(id).second) building.id = std::move(id);
      }
    }
    if (details_ != nullptr) details_->attributes = attribute_columns(attributes_);
  }

 private:
  void add_ours(const Place& object, const std::vector<Face>& faces, FootprintResult footprint) {
    const Place attributes = object.at("attributes");
    Building building;
    read_attributes(attributes, building);
    if (footprint.polygons.size() != 1) object.at("geometry").fail("has several ground faces");
    if (!(building.h_ground < building.h_roof)) attributes.fail("has h_roof below h_ground");
    building.footprint = std::move(footprint.polygons[0]);
    building.parts = read_parts(faces, frame_.origin);
    if (building.parts.empty()) {
      if (!is_prism(faces, building)) other_solids_.push_back(building.id);
    } else {
      require_parts(object, building);
      if (!is_roofed(faces, building)) other_solids_.push_back(building.id);
    }
    if (details_ != nullptr) {
      attributes_.push_back(Json::object());
      std::vector<StatedRoof>& roofs = details_->roofs.emplace_back();
      for (const RoofPart& part : building.parts)
        roofs.push_back(stated_roof(part.outline, part.roof, building.h_ground));
    }
    model_.buildings.push_back(std::move(building));
  }

  static void require_parts(const Place& object, const Building& building) {
    const std::string fault = tiling_fault(building.footprint, building.parts);
    if (!fault.empty())
      object.at("geometry").fail(fmt::format("has roofs that {}; write the file again", fault));
    for (const RoofPart& part : building.parts)
      if (!(range_of(part).low > building.h_ground))
        object.at("geometry").fail("has a roof below h_ground");
  }

  void add_foreign(const std::string& key, const ObjectFaces& geometry, FootprintResult footprint) {
    const std::vector<Face>& faces = geometry.faces;
    const Heights whole = heights_of(faces, footprint.polygons);
    if (!(whole.low < whole.high)) {
      model_.dropped.push_back({key, "a geometry without height"});
      return;
    }
    std::vector<std::vector<Face>> parts;
    if (footprint.polygons.size() > 1) parts = share_out(faces, footprint.polygons);
    std::string flattened;  // why
    std::size_t number = 1;
    for (std::size_t k = 0; k < footprint.polygons.size(); ++k) {
      Heights heights = whole;
      if (!parts.empty()) heights = heights_of(parts[k], {&footprint.polygons[k], 1});
      // What is lower than a storey has lost its roof to another piece.
      if (heights.high - heights.low < kLeastHeight) heights = whole;
      const std::vector<Face>& own = parts.empty() ? faces : parts[k];
      BodyParts body = parts_of(own, footprint.polygons[k], heights.low, lod_of(geometry.lod));
      if (flattened.empty() && (heights.is_flattened || has_roof_below(own, heights.high)))
        flattened = body.reason;
      Building building;
      std::string id = key;
      while (k > 0 && keys_.contains(id)) id = fmt::format("{}#{}", key, ++number);
      building.source_ids = {std::move(id)};
      building.footprint = std::move(footprint.polygons[k]);
      building.h_ground = heights.low;
      building.h_roof = heights.high;
      if (!body.parts.empty()) {
        for (RoofPart& part : body.parts) part.source_id = building.source_ids[0];
        building.footprint = std::move(body.footprint);
        building.parts = std::move(body.parts);
      }
      if (details_ != nullptr) {
        attributes_.push_back(attributes_of(objects_, key));
        details_->roofs.push_back(lod_of(geometry.lod) > Lod::k1_2 ? stated_roofs(own, heights.low)
                                                                   : std::vector<StatedRoof>{});
      }
      model_.buildings.push_back(std::move(building));
    }
    if (!flattened.empty() && flattened_++ == 0) first_flattened_ = key + ": " + flattened;
  }

  const CityFrame& frame_;
  const Json& objects_;
  std::unordered_set<std::string> keys_;
  CityModel& model_;
  CityDetails* details_;
  std::vector<Json> attributes_;  ///< Per building.
  std::vector<std::string> other_solids_;
  std::vector<std::string> extension_types_;
  std::size_t reliefs_ = 0;
  std::size_t flattened_ = 0;
  std::string first_flattened_;
};

void check_type(const Place& root) {
  if (root.value().is_object() && !root.has("type"))
    root.fail("has no member 'type', so it is not CityJSON; give a .city.json");
  if (root.at("type").text() != "CityJSON") root.at("type").fail("is not \"CityJSON\"");
  const std::string& version = root.at("version").text();
  for (const std::string_view known : {"1.0", "1.1", "2.0"})
    if (version.starts_with(known)) return;
  root.at("version").fail(fmt::format("is \"{}\"; only 1.0, 1.1 and 2.0 can be read", version));
}

std::string crs_at(const Place& system) {
  if (vertical_unit_metres(system.text()) < 0)
    system.fail("has depths instead of heights; convert them to heights in metres");
  try {
    return normalise_crs(system.text());
  } catch (const Error& error) {
    system.fail(error.what());
  }
}

/// A domain that is no box: the corner that each side starts at, its patch and that one's name.
Domain read_sides(const Place& sides, Point2 origin) {
  constexpr int kFirst = 9, kMost = 1'000'000;  // numbers of patches that not every city has
  Ring ring;
  std::vector<Patch> patches;
  std::vector<PatchInfo> own;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Place side = sides.at(i);
    const Place from = side.at("from");
    ring.push_back(
        snap_coordinate(Point2{from.at(0).number() - origin.x, from.at(1).number() - origin.y}));
    const double number = side.at("patch").number();
    if (!(number >= kFirst && number <= kMost)) side.at("patch").fail("is not a number from 9 on");
    patches.push_back(static_cast<Patch>(static_cast<int>(number)));
    const auto is_known = [&](const PatchInfo& info) { return info.patch == patches.back(); };
    if (std::none_of(own.begin(), own.end(), is_known))
      own.push_back({patches.back(), side.at("name").text(), PatchKind::kSide});
  }
  std::sort(own.begin(), own.end(),
            [](const PatchInfo& a, const PatchInfo& b) { return a.patch < b.patch; });
  if (ring.size() < 3 || !(signed_area(ring) > 0))
    sides.fail("are not the corners of a polygon, counter-clockwise");
  return {std::move(ring), std::move(patches), std::move(own)};
}

/// What write_city puts beside the objects.
void read_account(const Place& root, CityModel& model) {
  model.domain = Bounds2::nothing();
  if (!root.has(kExtensionMember)) return;
  const Place account = root.at(kExtensionMember);
  if (account.has("crs") && !account.at("crs").text().empty()) {
    const std::string crs = crs_at(account.at("crs"));
    if (model.crs.empty())
      model.crs = crs;
    else if (crs != model.crs && !same_horizontal_crs(crs, model.crs))
      account.at("crs").fail(
          fmt::format("is {}, but /metadata/referenceSystem {}; correct one, or remove the member "
                      "'+tetropolis' "
                      "if another program has moved the model",
                      crs_name(crs), crs_name(model.crs)));
  }
  if (account.has("domain")) {
    const Place box = account.at("domain");
    if (box.size() != 4) box.fail("is not an array of four numbers");
    const auto side = [&](std::size_t i) {
      return snap_coordinate(box.at(i).number() - (i % 2 == 0 ? model.origin.x : model.origin.y));
    };
    model.domain = {side(0), side(1), side(2), side(3)};
    if (model.domain.empty())
      box.fail("is not XMIN, YMIN, XMAX, YMAX with XMIN < XMAX, YMIN < YMAX");
  }
  if (account.has("domainSides"))
    model.domain = read_sides(account.at("domainSides"), model.origin);
  if (account.has("domainTop")) model.domain_top = account.at("domainTop").number();
  if (!account.has("dropped")) return;
  const Place dropped = account.at("dropped");
  for (std::size_t i = 0; i < dropped.size(); ++i)
    model.dropped.push_back(
        {dropped.at(i).at("source_id").text(), dropped.at(i).at("reason").text()});
}

/// As the file spells it; "" if it has none.
std::string system_stated(const Place& root) {
  const bool is_stated = root.has("metadata") && root.at("metadata").has("referenceSystem");
  return is_stated ? root.at("metadata").at("referenceSystem").text() : "";
}

std::string read_crs(const Place& root) {
  const std::string stated = system_stated(root);
  if (stated.empty()) return "";
  const Place system = root.at("metadata").at("referenceSystem");
  if (const double unit = vertical_unit_metres(stated);
      root.has(kExtensionMember) && unit > 0 && !is_metre(unit))
    system.fail(fmt::format("has heights in units of {} m, but this program's are metres", unit));
  return crs_at(system);
}

/// Ours are, and those without a system are taken to be.
bool is_in_metres(const Place& root, const std::string& crs) {
  return root.has(kExtensionMember) || crs.empty() ||
         (!is_geographic(crs) && is_metre(linear_unit_metres(crs)) &&
          is_metre(vertical_unit_metres(system_stated(root))));
}

/// Of our own files: whether the extent stated is that of the vertices, to a centimetre.
bool states_its_extent(const Place& root, const CityFrame& frame) {
  constexpr double kRounding = 0.01;  // metres
  if (!root.has(kExtensionMember) || !root.has("metadata") || frame.vertices.empty()) return true;
  const Place metadata = root.at("metadata");
  if (!metadata.has("geographicalExtent")) return true;
  const Place extent = metadata.at("geographicalExtent");
  if (extent.size() != 6) return false;
  const std::array<double, 3> origin{frame.origin.x, frame.origin.y, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto below = [axis](const Point3& p, const Point3& q) { return p[axis] < q[axis]; };
    const auto [low, high] =
        std::minmax_element(frame.vertices.begin(), frame.vertices.end(), below);
    if (!(std::abs(extent.at(axis).number() - origin[axis] - (*low)[axis]) <= kRounding &&
          std::abs(extent.at(axis + 3).number() - origin[axis] - (*high)[axis]) <= kRounding))
      return false;
  }
  return true;
}

/// What became of objects otherwise than one might think; `dropped` are no buildings.
void warn_of_objects(const fs::path& path, const CityReader& reader,
                     std::span<const Dropped> dropped, bool has_roofs,
                     std::vector<Warning>& warnings) {
  const auto warn = [&](const char* code, std::size_t count, std::string message) {
    if (count > 0)
      warnings.push_back({code, static_cast<std::int64_t>(count),
                          fmt::format("{}: {}", path.string(), std::move(message))});
  };
  if (!dropped.empty())
    warn("city_objects_dropped", dropped.size(),
         fmt::format("{} buildings or parts without usable geometry were dropped (first: {}, {})",
                     dropped.size(), dropped.front().source_id, dropped.front().reason));
  if (!has_roofs)
    warn("city_roofs_flattened", reader.flattened(),
         fmt::format("{} roofs became flat at the height that nine tenths of their area do not "
                     "exceed (first: {})",
                     reader.flattened(), reader.first_flattened()));
  const std::vector<std::string>& unknown = reader.extension_types();
  warn("city_types_unknown", unknown.size(),
       fmt::format("{} objects of extension types were left out (first: {}); change their type to "
                   "Building if they are buildings",
                   unknown.size(), unknown.empty() ? "" : unknown.front()));
  warn("city_terrain_unread", reader.reliefs(),
       "its terrain (TINRelief) is not read; the terrain is that of `dtm`");
  const std::vector<std::string>& other = reader.other_solids();
  warn("city_solids_differ", other.size(),
       fmt::format(
           "{} solids differ from their ground extruded from h_ground to h_roof (first: {}); "
           "the ground and these attributes are used",
           other.size(), other.empty() ? "" : other.front()));
}

}  // namespace

CityModel read_city(const fs::path& path, std::vector<Warning>* warnings, BrokenObjects broken,
                    CityDetails* details) {
  const ModelDocument document = read_document(path);
  const Place root(path, document.root);
  check_type(root);
  // A file of ours that contradicts itself has been damaged, and who knows where else.
  const bool drop_broken = broken == BrokenObjects::kDrop && !root.has(kExtensionMember);
  CityModel model;
  model.crs = read_crs(root);
  double height_unit = document.height_unit;
  const auto into_metres = [&](std::vector<Point3>& vertices) {
    const ModelMetres metres = put_into_metres(path, system_stated(root), model.crs, vertices);
    model.crs = metres.crs;
    height_unit = metres.height_unit;
  };
  const CityFrame frame =
      is_in_metres(root, model.crs) ? read_vertices(root) : read_vertices(root, into_metres);
  model.origin = frame.origin;
  read_account(root, model);
  const std::size_t dropped_before = model.dropped.size();
  const Place objects = root.at("CityObjects");
  if (!objects.value().is_object()) objects.fail("is not an object");
  CityReader reader(frame, objects.value(), document.keys, model, details);
  for (const std::string& key : document.keys) {
    if (drop_broken)
      reader.add_or_drop(objects.at(key), key);
    else
      reader.add(objects.at(key), key);
  }
  reader.finish();
  if (warnings != nullptr) {
    if (!is_metre(height_unit))
      warnings->push_back(
          {"model_units", 1,
           fmt::format("{}: heights are in units of {:.10g} m, as its coordinates or its vertical "
                       "system are, and are converted to metres",
                       path.string(), height_unit)});
    if (document.is_east_first)
      warnings->push_back(
          {"model_axes", 1,
           path.string() + ": coordinates have the easting first, as only so they lie where their "
                           "system is used; its name means the northing first"});
    if (const auto& guessed = document.without_height; !guessed.empty())
      warnings->push_back(
          {"city_heights_unknown", static_cast<std::int64_t>(guessed.size()),
           fmt::format("{}: {} outlines state neither height nor storeys and are raised by 6 m "
                       "(first: {})",
                       path.string(), guessed.size(), guessed.front())});
    warn_of_objects(path, reader, std::span(model.dropped).subspan(dropped_before),
                    details != nullptr, *warnings);
    if (!states_its_extent(root, frame))
      warnings->push_back(
          {"city_extent_differs", 1,
           path.string() + ": metadata.geographicalExtent is not the extent of the vertices; it "
                           "is ignored"});
  }
  return model;
}

}  // namespace tetropolis
