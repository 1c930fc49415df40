// CityGML 1.0, 2.0 and 3.0 as the CityJSON document that says the same. Private to src/io.
//
// Source: OGC City Geography Markup Language (CityGML) 2.0, OGC 12-019; CityGML 3.0, OGC 20-010.
#pragma once

#include <filesystem>

#include "model_document.h"

namespace tetropolis {

/// By its first bytes.
bool is_citygml(const std::filesystem::path& path);

/// Every Building and BuildingPart with its polygons of each level of detail and their semantics
/// (GroundSurface, RoofSurface, WallSurface, ...); of outlines alone (lod0FootPrint, lod0RoofEdge)
/// the prism of measuredHeight, else of storeysAboveGround times 3 m. Terrain, roads, plants,
/// installations, rooms, openings and addresses are passed over. Coordinates in degrees or
/// feet become metres (model_metres.h). Errors, kInput with the path: not XML (with the line), no
/// building, a system nobody knows.
ModelDocument read_citygml(const std::filesystem::path& path);

}  // namespace tetropolis
