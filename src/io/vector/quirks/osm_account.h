// Buildings of OpenStreetMap XML that GDAL drops without a word: clipped extracts (osmium,
// Overpass, the API) lack nodes of ways and ways of relations, and JOSM keeps what was deleted. See
// also OSM2World#158, sumo#14598. Private to src/io.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tetropolis/city/city_model.h"

namespace tetropolis {

/// An area of OpenStreetMap: whether it is a relation, and its number.
using OsmId = std::pair<bool, std::int64_t>;

struct OsmAccount {
  std::vector<Dropped> lost;            ///< "way/204", "relation/300", in the order of the file.
  std::vector<std::string> incomplete;  ///< Ways read, of which nodes are not in the file.
};

/// Compares the ways and relations of an OSM XML file that are tagged as buildings with those that
/// have been read. Clipped extracts lack nodes of ways, and ways of relations. Ways without the tag
/// of their own, and those of relations that have been read, are none of the account. Time and
/// memory: linear in the file, 8 bytes per node. Throws Error(kInput) if it cannot be read.
OsmAccount account_of_osm(const std::filesystem::path& path, const std::set<OsmId>& read);

}  // namespace tetropolis
