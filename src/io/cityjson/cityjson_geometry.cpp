#include "cityjson_geometry.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"

#include "extension.h"

namespace tetropolis {

namespace {

Point3 read_triple(const Place& place) {
  if (place.size() != 3) place.fail("is not an array of three numbers");
  return {place.at(0).number(), place.at(1).number(), place.at(2).number()};
}

constexpr double kMostMetres = 1e12;  ///< Of coordinates.

bool is_whole(double value) { return std::floor(value) == value && std::abs(value) < 1e15; }

/// Whether single precision has room for millimetres of what is in `box`.
bool is_near(Point2 origin, const Bounds2& box) {
  constexpr double kFarthest = 1e5;  // metres
  return box.empty() || box.grown(kFarthest).contains(origin);
}

/// Reads boundaries of any depth into faces.
class FaceReader {
 public:
  FaceReader(const CityFrame& frame, const Place& geometry) : frame_(frame) {
    if (!geometry.has("semantics")) return;
    const Place semantics = geometry.at("semantics");
    if (!semantics.has("surfaces") || !semantics.has("values")) return;
    const Place surfaces = semantics.at("surfaces");
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      surfaces_.push_back(surfaces.at(i));
      types_.push_back(surfaces_.back().at("type").text());
    }
    values_ = &semantics.at("values").value();
  }

  /// `depth`: levels of arrays above a surface's own (0: `boundaries` is a list of surfaces).
  std::vector<Face> read(const Place& boundaries, int depth) {
    std::vector<Face> faces;
    collect(boundaries, depth, values_, faces);
    return faces;
  }

 private:
  /// The part of the semantics that belongs to item i; null where semantics are shorter or null.
  static const Json* item(const Json* values, std::size_t i) {
    return values != nullptr && values->is_array() && i < values->size() ? &(*values)[i] : nullptr;
  }

  void collect(const Place& list, int depth, const Json* values, std::vector<Face>& faces) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (depth > 0)
        collect(list.at(i), depth - 1, item(values, i), faces);
      else
        faces.push_back(read_face(list.at(i), item(values, i)));
    }
  }

  Face read_face(const Place& surface, const Json* value) {
    Face face;
    for (std::size_t r = 0; r < surface.size(); ++r) {
      const Place ring = surface.at(r);
      std::vector<Point3> points;
      for (std::size_t i = 0; i < ring.size(); ++i) points.push_back(vertex(ring, i));
      face.rings.push_back(std::move(points));
    }
    if (value != nullptr && value->is_number_unsigned()) {
      const auto index = value->get<std::uint64_t>();
      if (index >= types_.size())
        surface.fail(fmt::format("has semantics {} of {}", index, types_.size()));
      const std::string& type = types_[static_cast<std::size_t>(index)];
      face.is_ground = type == "GroundSurface";
      face.is_roof = type == "RoofSurface";
      if (face.is_roof) face.semantics = surfaces_[static_cast<std::size_t>(index)];
    }
    return face;
  }

  const Point3& vertex(const Place& ring, std::size_t i) const {
    const Json& value = ring.value()[i];
    if (!value.is_number_unsigned()) ring.at(i).fail("is not a vertex number");
    const auto index = value.get<std::uint64_t>();
    if (index >= frame_.vertices.size())
      ring.at(i).fail(fmt::format("is vertex {} of {}", index, frame_.vertices.size()));
    return frame_.vertices[static_cast<std::size_t>(index)];
  }

  const CityFrame& frame_;
  std::vector<Place> surfaces_;     ///< The semantic surfaces.
  std::vector<std::string> types_;  ///< Of these.
  const Json* values_ = nullptr;
};

/// Array levels above the surfaces, or -1 for geometry without surfaces.
int surface_depth(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 0;
  if (type == "Solid") return 1;
  if (type == "MultiSolid" || type == "CompositeSolid") return 2;
  return -1;
}

/// Nothing where it is missing or no number.
std::optional<double> level_of_detail(const Place& geometry) {
  if (!geometry.has("lod")) return std::nullopt;
  const Json& lod = geometry.at("lod").value();
  if (lod.is_number()) return lod.get<double>();
  if (!lod.is_string()) return std::nullopt;
  const auto& text = lod.get_ref<const std::string&>();
  double level = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), level);
  return error == std::errc() ? std::optional(level) : std::nullopt;
}

}  // namespace

CityFrame read_vertices(const Place& root,
                        const std::function<void(std::vector<Point3>&)>& settle) {
  Point3 scale{1, 1, 1};
  Point3 translate{0, 0, 0};
  const bool transformed = root.has("transform");
  if (transformed) {
    scale = read_triple(root.at("transform").at("scale"));
    translate = read_triple(root.at("transform").at("translate"));
    // Beyond that metres are lost, and no city is there.
    for (const double t : translate)
      if (!(std::abs(t) <= 1e9)) root.at("transform").at("translate").fail("is beyond 1e9");
  }
  CityFrame frame;
  const Place list = root.at("vertices");
  const std::size_t size = list.size();
  frame.vertices.reserve(size);
  Bounds2 box = Bounds2::nothing();
  for (std::size_t i = 0; i < size; ++i) {
    // The long list of the document: the way to an item is spelt out only where it is wrong.
    const Json& v = list.value()[i];
    if (!v.is_array() || v.size() != 3 || !v[0].is_number() || !v[1].is_number() ||
        !v[2].is_number())
      list.at(i).fail("is not an array of three numbers");
    frame.vertices.push_back({v[0].get<double>(), v[1].get<double>(), v[2].get<double>()});
  }
  if (settle) {
    for (Point3& v : frame.vertices)
      for (std::size_t axis = 0; axis < 3; ++axis)
        v[axis] = translate[axis] + v[axis] * scale[axis];
    settle(frame.vertices);
    scale = {1, 1, 1};
    translate = {0, 0, 0};
  }
  for (const Point3& v : frame.vertices)
    box.extend(Point2{translate[0] + v[0] * scale[0], translate[1] + v[1] * scale[1]});
  const Point2 origin{translate[0], translate[1]};
  if (transformed && !settle && is_whole(origin.x) && is_whole(origin.y) &&
      (root.has(kExtensionMember) || is_near(origin, box)))
    frame.origin = origin;
  else if (!box.empty())
    frame.origin = {std::floor(box.xmin), std::floor(box.ymin)};
  const Point3 shift = {translate[0] - frame.origin.x, translate[1] - frame.origin.y, translate[2]};
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double& v = frame.vertices[i][axis];
      v = snap_coordinate(v * scale[axis] + shift[axis]);
      if (!(std::abs(v) <= kMostMetres)) list.at(i).fail("is not finite or beyond 1e12 m");
    }
  return frame;
}

ObjectFaces read_faces(const Place& object, const CityFrame& frame) {
  ObjectFaces result;
  if (!object.has("geometry") || object.at("geometry").size() == 0) {
    result.reason = "no geometry";
    return result;
  }
  const Place list = object.at("geometry");
  result.reason = "no surface or solid in its geometry";
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Place geometry = list.at(i);
    const int depth = surface_depth(geometry.at("type").text());
    if (depth < 0) continue;
    std::vector<Face> faces = FaceReader(frame, geometry).read(geometry.at("boundaries"), depth);
    // The standard asks for a level; a solid has a height without one, too.
    const std::optional<double> told = level_of_detail(geometry);
    const double lod = told.value_or(depth > 0 ? 1 : 0);
    if (lod < 1)
      result.reason = told ? "only geometry of LoD 0, which has no height"
                           : "its surfaces have no level of detail ('lod')";
    if (lod < 1 || lod <= result.lod) continue;  // LoD 0 is a footprint without height
    result.lod = lod;
    result.faces = std::move(faces);
  }
  if (!result.faces.empty()) result.reason.clear();
  return result;
}

}  // namespace tetropolis
