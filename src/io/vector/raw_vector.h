// Footprints with defects, written as they are: for tests of readers.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tetropolis/geometry/types.h"

#include "synth/raw_feature.h"

namespace tetropolis {

/// Writes features with the attributes "id" (text) and "height" (real), and repairs nothing: rings
/// keep their vertices, order and gaps, vertices that are not finite stay so, and a feature without
/// polygons becomes one without geometry. The format follows the extension: .shp (with .shx, .dbf,
/// .prj, .cpg) or .geojson. A shapefile does not tell which rings belong together: readers work it
/// out, whatever they make of the defects.
///
/// features: local frame; `origin` is added to x and y. z is written if `with_z`. crs as in
/// write_footprints. Guarantee: the same input gives the same bytes (.prj: with the same PROJ); the
/// .shp or .geojson appears last and complete.
/// Errors: kInput if it cannot be written; kUsage for another extension or a bad crs.
/// Source: ESRI, Shapefile Technical Description, 1998; RFC 7946, with the crs member of 2008.
void write_raw_features(const std::filesystem::path& path, std::span<const RawFeature> features,
                        Point2 origin, const std::string& crs, bool with_z = false);

}  // namespace tetropolis
