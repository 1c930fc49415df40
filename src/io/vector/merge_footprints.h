// Footprints of several files as one. Private to src.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "tetropolis/io/vector/vector.h"

#include "io/file/input_paths.h"

namespace tetropolis {

/// What folders of footprints are looked through for.
inline constexpr std::array<std::string_view, 22> kVectorEndings{
    ".shp",        ".gpkg", ".gdb",       ".geojson",   ".geojsonl", ".geojsons",
    ".geojsonseq", ".fgb",  ".ndjson",    ".gml",       ".kml",      ".sqlite",
    ".tab",        ".mif",  ".osm",       ".osm.gz",    ".pbf",      ".osm.bz2",
    ".parquet",    ".dxf",  ".city.json", ".city.jsonl"};
inline constexpr FileKind kVectorFiles{"vector files", kVectorEndings};

/// Puts it before the ids of all features.
void prefix_ids(const std::string& prefix, FootprintsInput& input);

/// Ids that `others` have, too, get "~2", "~3", ... added.
void tell_ids_apart(const FootprintsInput& others, FootprintsInput& input);

/// Adds features, attributes (of one name and type: one column) and warnings to those of `all`, and
/// reprojects them to its system if both are known. Precondition: no ids in common.
void append_footprints(FootprintsInput input, FootprintsInput& all);

/// All features in the order of the inputs, with ids "FILE:ID", where FILE is the name of the file
/// without its ending (with "~2", ... where two have the same). Attributes of one name and type are
/// one column. Systems other than that of the first are reprojected to it.
FootprintsInput merge_footprints(std::vector<FootprintsInput> inputs,
                                 const std::vector<std::filesystem::path>& paths);

}  // namespace tetropolis
