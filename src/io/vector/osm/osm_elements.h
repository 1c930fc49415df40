// The elements of OpenStreetMap files, one after the other: XML (plain, gzip, bzip2), PBF and the
// JSON of the Overpass API. Private to src/io.
//
// Source of the layouts: the OpenStreetMap wiki, OSM XML, PBF Format, Overpass API/OSM JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

enum class OsmKind : std::uint8_t { kNode, kWay, kRelation };

struct OsmMember {
  OsmKind kind = OsmKind::kWay;
  std::int64_t id = 0;
  std::string role;
  std::vector<Point2> places;  ///< Of a way, where the file has them there (Overpass: out geom).
};

struct OsmElement {
  OsmKind kind = OsmKind::kNode;
  std::int64_t id = 0;
  bool is_deleted = false;  ///< In an editor's file, where it stays until it is uploaded.
  Point2 place;             ///< Of a node: longitude, latitude.
  std::vector<std::pair<std::string, std::string>> tags;
  std::vector<std::int64_t> nodes;  ///< Of a way.
  std::vector<Point2> places;       ///< Of the nodes of a way, where the file has them there.
  std::vector<OsmMember> members;   ///< Of a relation.

  /// "" if there is none.
  std::string_view tag(std::string_view key) const;
};

/// Whether a file is of OpenStreetMap, by its name and its first bytes.
bool is_osm_file(const std::filesystem::path& path);

/// Calls `visit` with every element of a kind, in the order of the file; of nodes without tags.
/// Throws Error(kInput) with the path and the place for a file that is cut or broken.
void read_osm(const std::filesystem::path& path, OsmKind kind,
              const std::function<void(const OsmElement&)>& visit);

}  // namespace tetropolis
