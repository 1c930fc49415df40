#include "osm_buildings.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/city/city_model.h"
#include "tetropolis/geometry/polygon.h"
#include "tetropolis/geometry/types.h"

#include "core/is_among.h"
#include "core/text.h"
#include "io/file/input_file.h"
#include "io/vector/polygon_geometry.h"
#include "osm_elements.h"

namespace tetropolis {

namespace fs = std::filesystem;

namespace {

constexpr std::array kColumns{"osm_id",     "osm_way_id",
                              "name",       "type",
                              "building",   "building:part",
                              "height",     "building:levels",
                              "min_height", "building:levels:underground",
                              "layer",      "location"};
constexpr const char* kOtherTags = "other_tags";

bool is_yes(std::string_view value) {
  return !value.empty() && lower_case(std::string(value)) != "no";
}

bool is_building(const OsmElement& element) {
  return is_yes(element.tag("building")) || is_yes(element.tag("building:part"));
}

bool is_area_relation(const OsmElement& relation) {
  const std::string_view type = relation.tag("type");
  return type == "multipolygon" || type == "boundary";
}

bool is_group(const OsmElement& relation) { return relation.tag("type") == "building"; }

/// Whether nothing but its members tells what it is.
bool says_nothing(const OsmElement& relation) {
  return std::all_of(relation.tags.begin(), relation.tags.end(), [](const auto& tag) {
    return tag.first == "type" || tag.first == "source" || tag.first == "created_by" ||
           tag.first == "note";
  });
}

std::string name_of(const OsmElement& element) {
  return fmt::format("{}/{}", element.kind == OsmKind::kRelation ? "relation" : "way", element.id);
}

/// The ways of a relation that make its outline.
std::vector<std::int64_t> outline_of(const OsmElement& relation) {
  std::vector<std::int64_t> ways;
  for (const OsmMember& member : relation.members) {
    if (member.kind != OsmKind::kWay) continue;
    if (is_group(relation) && member.role != "outline" && member.role != "outer" &&
        member.role != "inner")
      continue;
    ways.push_back(member.id);
  }
  return ways;
}

bool has_parts(const OsmElement& relation) {
  return std::any_of(relation.members.begin(), relation.members.end(),
                     [](const OsmMember& member) { return member.role == "part"; });
}

/// What of a file matters: the relations, the ways that they or tags name, the nodes of these.
class OsmSource {
 public:
  explicit OsmSource(const fs::path& path) {
    read_osm(path, OsmKind::kRelation, [&](const OsmElement& relation) {
      if (relation.is_deleted || relation.tag("type") == "site") return;
      const bool area = is_area_relation(relation), group = is_group(relation);
      if (is_building(relation) || group || (area && says_nothing(relation)))
        if (seen_.insert({true, relation.id}).second) relations_.push_back(relation);
    });
    std::unordered_set<std::int64_t> wanted;
    for (const OsmElement& relation : relations_)
      for (const OsmMember& member : relation.members)
        if (member.kind == OsmKind::kWay) wanted.insert(member.id);
    read_osm(path, OsmKind::kWay, [&](const OsmElement& way) {
      if (way.is_deleted || (!is_building(way) && !wanted.contains(way.id))) return;
      if (!seen_.insert({false, way.id}).second) return;  // merged extracts may hold one twice
      add_way(way);
    });
    for (const OsmElement& relation : relations_)
      for (const OsmMember& member : relation.members) {
        if (member.kind != OsmKind::kWay || member.places.empty()) continue;
        if (!seen_.insert({false, member.id}).second) continue;
        OsmElement way;
        way.kind = OsmKind::kWay;
        way.id = member.id;
        way.places = member.places;
        add_way(way);
      }
    std::unordered_set<std::int64_t> nodes;
    for (const OsmElement& way : ways_) nodes.insert(way.nodes.begin(), way.nodes.end());
    read_osm(path, OsmKind::kNode, [&](const OsmElement& node) {
      if (!node.is_deleted && nodes.contains(node.id)) places_[node.id] = node.place;
    });
  }

  const std::vector<OsmElement>& relations() const { return relations_; }
  const std::vector<OsmElement>& ways() const { return ways_; }
  const OsmElement* way(std::int64_t id) const {
    const auto found = index_.find(id);
    return found == index_.end() ? nullptr : &ways_[found->second];
  }
  const Point2* place(std::int64_t node) const {
    const auto found = places_.find(node);
    return found == places_.end() ? nullptr : &found->second;
  }
  std::ptrdiff_t missing_nodes(const OsmElement& way) const {
    return std::count_if(way.nodes.begin(), way.nodes.end(),
                         [&](std::int64_t node) { return !places_.contains(node); });
  }

 private:
  void add_way(const OsmElement& way) {
    index_[way.id] = ways_.size();
    OsmElement& own = ways_.emplace_back(way);
    // Overpass may give places alone; ways that meet share a node there.
    if (way.nodes.empty())
      for (const Point2 p : way.places)
        own.nodes.push_back(
            node_at_.try_emplace({p.x, p.y}, -(std::int64_t{1} << 40) - std::ssize(node_at_))
                .first->second);
    if (way.places.size() != own.nodes.size()) return;
    for (std::size_t k = 0; k < way.places.size(); ++k) {
      node_at_.try_emplace({way.places[k].x, way.places[k].y}, own.nodes[k]);
      places_[own.nodes[k]] = way.places[k];
    }
  }

  std::set<std::pair<bool, std::int64_t>> seen_;
  std::vector<OsmElement> relations_, ways_;
  std::unordered_map<std::int64_t, std::size_t> index_;
  std::unordered_map<std::int64_t, Point2> places_;
  std::map<std::pair<double, double>, std::int64_t> node_at_;  ///< Of ways with places.
};

using Chain = std::vector<std::int64_t>;

/// Closed chains of nodes from ways, joined at their ends; empty if some remain open.
std::vector<Chain> rings_of(std::vector<Chain> chains) {
  std::vector<Chain> rings;
  while (!chains.empty()) {
    Chain ring = std::move(chains.back());
    chains.pop_back();
    while (ring.size() > 1 && ring.front() != ring.back()) {
      const auto next = std::find_if(chains.begin(), chains.end(), [&](const Chain& chain) {
        return chain.front() == ring.back() || chain.back() == ring.back();
      });
      if (next == chains.end()) return {};
      if (next->front() != ring.back()) std::reverse(next->begin(), next->end());
      ring.insert(ring.end(), next->begin() + 1, next->end());
      chains.erase(next);
    }
    if (ring.size() < 4) return {};
    rings.push_back(std::move(ring));
  }
  std::reverse(rings.begin(), rings.end());  // in the order of the members, but for what was joined
  return rings;
}

/// Of rings, each within an even number of others is the outside of a polygon; the others are holes
/// of the smallest around them.
std::vector<Polygon> polygons_of(std::vector<Ring> rings) {
  const std::size_t count = rings.size();
  std::vector<Polygon> alone;
  for (const Ring& ring : rings) alone.push_back({ring, {}});
  const auto within = [&](std::size_t a, std::size_t b) {
    if (a == b || !(area(alone[a]) < area(alone[b]))) return false;
    return std::all_of(rings[a].begin(), rings[a].end(), [&](const Point2& p) {
      return contains(alone[b], p) || is_among(p, rings[b]);
    });
  };
  std::vector<Polygon> polygons;
  std::map<std::size_t, std::size_t> of_ring;
  std::vector<std::vector<std::size_t>> around(count);
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b)
      if (within(a, b)) around[a].push_back(b);
  for (std::size_t a = 0; a < count; ++a)
    if (around[a].size() % 2 == 0) {
      of_ring[a] = polygons.size();
      polygons.push_back({rings[a], {}});
    }
  for (std::size_t a = 0; a < count; ++a) {
    if (around[a].size() % 2 == 0) continue;
    const std::size_t holder = *std::min_element(
        around[a].begin(), around[a].end(),
        [&](std::size_t x, std::size_t y) { return area(alone[x]) < area(alone[y]); });
    if (const auto found = of_ring.find(holder); found != of_ring.end())
      polygons[found->second].holes.push_back(rings[a]);
  }
  return polygons;
}

class Writer {
 public:
  Writer(const fs::path& path, GDALDatasetH dataset) : path_(path) {
    const gdal::Srs degrees = gdal::parse_srs("EPSG:4326");
    layer_ = GDALDatasetCreateLayer(dataset, "multipolygons", degrees.get(), wkbUnknown, nullptr);
    if (layer_ == nullptr) fail_input(path, "GDAL cannot hold its buildings in memory");
    for (const char* name : kColumns) add_column(name);
    add_column(kOtherTags);
  }

  void write(const OsmElement& element, const std::vector<Polygon>& polygons) {
    OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer_);
    const gdal::Feature feature(OGR_F_Create(definition));
    const bool is_relation = element.kind == OsmKind::kRelation;
    OGR_F_SetFieldString(feature.get(), is_relation ? 0 : 1, std::to_string(element.id).c_str());
    std::string others;
    for (const auto& [key, value] : element.tags) {
      const auto column = std::find(kColumns.begin() + 2, kColumns.end(), key);
      if (column != kColumns.end()) {
        OGR_F_SetFieldString(feature.get(), static_cast<int>(column - kColumns.begin()),
                             value.c_str());
        continue;
      }
      others +=
          fmt::format("{}\"{}\"=>\"{}\"", others.empty() ? "" : ",", escaped(key), escaped(value));
    }
    if (!others.empty())
      OGR_F_SetFieldString(feature.get(), static_cast<int>(kColumns.size()), others.c_str());
    OGRGeometryH geometry = OGR_G_CreateGeometry(wkbMultiPolygon);
    for (const Polygon& polygon : polygons)
      OGR_G_AddGeometryDirectly(geometry, polygon_geometry(polygon));
    OGR_F_SetGeometryDirectly(feature.get(), geometry);
    if (OGR_L_CreateFeature(layer_, feature.get()) != OGRERR_NONE)
      fail_input(path_, name_of(element) + ": GDAL cannot hold it in memory");
  }

 private:
  void add_column(const char* name) {
    OGRFieldDefnH field = OGR_Fld_Create(name, OFTString);
    OGR_L_CreateField(layer_, field, TRUE);
    OGR_Fld_Destroy(field);
  }
  static std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
      if (c == '"' || c == '\\') result += '\\';
      result += c;
    }
    return result;
  }

  const fs::path& path_;
  OGRLayerH layer_ = nullptr;
};

class Assembly {
 public:
  Assembly(const OsmSource& source, Writer& writer, OsmBuildings& result)
      : source_(source), writer_(writer), result_(result) {}

  void run() {
    for (const OsmElement& relation : source_.relations()) add_relation(relation);
    for (const OsmElement& way : source_.ways())
      if (is_building(way) && !consumed_.contains(way.id)) add_way(way);
  }

 private:
  void lose(const OsmElement& element, std::string reason, DropCause cause = DropCause::kUnusable) {
    result_.lost.push_back({name_of(element), std::move(reason), cause});
  }

  /// The places of a ring's nodes that there are, without the repeated last one.
  Ring placed(const Chain& nodes, bool& lacks) const {
    Ring ring;
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      const Point2* place = source_.place(nodes[k]);
      if (place == nullptr)
        lacks = true;
      else
        ring.push_back(*place);
    }
    return ring;
  }

  void add_way(const OsmElement& way) {
    const Chain& nodes = way.nodes;
    const auto missing = source_.missing_nodes(way);
    bool lacks = false;
    if (nodes.size() < 4) return lose(way, "a way of fewer than three corners");
    Ring ring = placed(nodes, lacks);
    if (ring.size() < 3 && missing > 0)
      return lose(way, fmt::format("the file lacks {} of its {} nodes", missing, nodes.size()));
    if (nodes.front() != nodes.back()) return lose(way, "a way that is not closed");
    if (lacks) result_.incomplete.push_back(name_of(way));
    writer_.write(way, {{std::move(ring), {}}});
  }

  void add_relation(const OsmElement& relation) {
    const bool group = is_group(relation);
    if (!is_area_relation(relation) && !group)
      return lose(relation,
                  fmt::format("a relation of type '{}', not an area", relation.tag("type")));
    const std::vector<std::int64_t> members = outline_of(relation);
    std::ptrdiff_t lacking = 0;
    std::vector<Chain> chains;
    for (const std::int64_t id : members) {
      const OsmElement* way = source_.way(id);
      if (way == nullptr || way->nodes.empty())
        ++lacking;
      else
        chains.push_back(way->nodes);
    }
    // The outline of a group is mostly a building by its own tags, or a relation that is.
    const auto outline_is_building = [&] {
      return std::any_of(relation.members.begin(), relation.members.end(),
                         [&](const OsmMember& member) {
                           if (member.role == "part" || member.role == "inner") return false;
                           if (member.kind == OsmKind::kRelation) return member.role == "outline";
                           const OsmElement* way = source_.way(member.id);
                           return way != nullptr && is_yes(way->tag("building"));
                         });
    };
    if (group && outline_is_building()) return;
    const bool tagged = is_building(relation);
    if (group && members.empty()) {
      if (has_parts(relation))
        lose(relation, "has no outline: its parts stand for it", DropCause::kOutlined);
      else if (tagged)
        lose(relation, "a relation without an outline");
      return;
    }
    OsmElement whole = relation;
    std::vector<Ring> rings;
    bool lacks_nodes = false;
    if (lacking == 0) {
      const std::vector<Chain> closed = rings_of(chains);
      for (const Chain& chain : closed) rings.push_back(placed(chain, lacks_nodes));
      std::erase_if(rings, [](const Ring& ring) { return ring.size() < 3; });
    }
    std::vector<Polygon> polygons = polygons_of(std::move(rings));
    const std::vector<std::int64_t> outer = outer_ways(relation, polygons);
    if (!tagged && !group) {
      // Of an older kind: the outer way says what it is.
      const auto speaks = std::find_if(outer.begin(), outer.end(), [&](std::int64_t id) {
        return is_building(*source_.way(id));
      });
      if (speaks == outer.end()) return;
      whole.tags = source_.way(*speaks)->tags;
    }
    if (lacking > 0) {
      if (tagged || group)
        lose(relation, fmt::format("the file lacks {} of its {} ways", lacking, members.size()));
      return;
    }
    if (polygons.empty()) {
      if (tagged || group) lose(relation, "its ways form no outline");
      return;
    }
    consumed_.insert(outer.begin(), outer.end());
    if (lacks_nodes) result_.incomplete.push_back(name_of(relation));
    writer_.write(whole, polygons);
  }

  /// The member ways all of whose nodes are on the outside of a polygon: others touch it.
  std::vector<std::int64_t> outer_ways(const OsmElement& relation,
                                       const std::vector<Polygon>& polygons) const {
    std::vector<std::int64_t> outer;
    for (const std::int64_t id : outline_of(relation)) {
      const OsmElement* way = source_.way(id);
      if (way == nullptr || way->nodes.empty()) continue;
      const auto is_around = [&](const Polygon& polygon) {
        return std::all_of(way->nodes.begin(), way->nodes.end(), [&](std::int64_t node) {
          const Point2* place = source_.place(node);
          return place == nullptr ||  // missing in the outline, too
                 is_among(*place, polygon.outer);
        });
      };
      if (std::any_of(polygons.begin(), polygons.end(), is_around)) outer.push_back(id);
    }
    return outer;
  }

  const OsmSource& source_;
  Writer& writer_;
  OsmBuildings& result_;
  std::unordered_set<std::int64_t> consumed_;  ///< Ways that are the outside of a relation.
};

}  // namespace

OsmBuildings read_osm_buildings(const fs::path& path) {
  const OsmSource source(path);
  OsmBuildings result;
  GDALDriverH driver = GDALGetDriverByName("Memory");
  if (driver == nullptr) driver = GDALGetDriverByName("MEM");
  result.dataset.reset(driver == nullptr ? nullptr
                                         : GDALCreate(driver, "", 0, 0, 0, GDT_Unknown, nullptr));
  if (result.dataset == nullptr) fail_input(path, "GDAL cannot hold its buildings in memory");
  Writer writer(path, result.dataset.get());
  Assembly(source, writer, result).run();
  return result;
}

}  // namespace tetropolis
