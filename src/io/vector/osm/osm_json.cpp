#include <vector>

#include <nlohmann/json.hpp>

#include "io/file/input_file.h"
#include "osm_input.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

/// Empty if some are left out, as of ways that leave the box of a query.
std::vector<Point2> places_of(const Json& geometry) {
  std::vector<Point2> places;
  for (const Json& at : geometry)
    if (at.is_object()) places.push_back({at.value("lon", 0.0), at.value("lat", 0.0)});
  if (places.size() != geometry.size()) places.clear();
  return places;
}

OsmElement element_of(const Json& json, OsmKind kind) {
  OsmElement element;
  element.kind = kind;
  element.id = json.value("id", std::int64_t{0});
  element.place = {json.value("lon", 0.0), json.value("lat", 0.0)};
  if (json.contains("tags"))
    for (const auto& [key, value] : json["tags"].items())
      if (value.is_string()) element.tags.emplace_back(key, value.get<std::string>());
  if (json.contains("nodes")) element.nodes = json["nodes"].get<std::vector<std::int64_t>>();
  if (json.contains("geometry") && kind == OsmKind::kWay)
    element.places = places_of(json["geometry"]);
  if (json.contains("members"))
    for (const Json& part : json["members"]) {
      OsmMember member;
      if (!is_kind(part.value("type", ""), member.kind)) continue;
      member.id = part.value("ref", std::int64_t{0});
      member.role = part.value("role", "");
      if (part.contains("geometry")) member.places = places_of(part["geometry"]);
      element.members.push_back(std::move(member));
    }
  return element;
}

}  // namespace

void read_osm_json(const fs::path& path, OsmKind kind, const OsmVisit& visit) {
  OsmBytes file(path);
  std::string text, block(std::size_t{1} << 20, '\0');
  while (const std::size_t size = file.read(block.data(), block.size()))
    text.append(block, 0, size);
  const Json whole = Json::parse(text, nullptr, false);
  if (!whole.is_object() || !whole.contains("elements") || !whole["elements"].is_array())
    fail_input(path, "is no whole answer of Overpass; get it again");
  try {
    for (const Json& json : whole["elements"]) {
      OsmKind of{};
      if (is_kind(json.value("type", ""), of) && of == kind) visit(element_of(json, kind));
    }
  } catch (const Json::exception&) {
    fail_input(path, "holds an element that is none of OpenStreetMap; get it again");
  }
}

}  // namespace tetropolis
