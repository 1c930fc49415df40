// City models as CityJSON (paper steps 1.7 and 2.4): version 2.0 out, 1.0, 1.1 and 2.0 in.
//
// Source: Ledoux, Ohori, Kumar, Dukai, Labetski, Vitalis: CityJSON: a compact and easy-to-use
// encoding of the CityGML data model, Open Geospatial Data, Software and Standards 4(4), 2019; the
// specification 2.0 of OGC, 2023.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tetropolis/city/attribute_column.h"
#include "tetropolis/city/city_model.h"
#include "tetropolis/city/stated_roof.h"
#include "tetropolis/core/warning.h"

namespace tetropolis {

/// Writes one CityObject of type Building per building, in the model's order, keyed by its id, with
/// one Solid per level of detail: outward faces with semantics, holes as inner rings and inner
/// walls. Of a building without parts that is LoD 1.2, the block. Of one with parts it is the
/// highest level of any part, and the block as LoD 1.2 unless that is the parts' level.
///
/// A solid of parts has a RoofSurface per part and WallSurfaces; faces share edges whole. Where two
/// roofs cross along a common line, roofs and walls have a vertex. Elevations of corners are in
/// whole millimetres; those less than a millimetre apart are one. A RoofSurface has source_id,
/// lod, slope and azimuth (degrees; azimuth, where the roof looks, clockwise from north, not of
/// flat roofs), n_points, rmse (m, where there are points), roof_plane (x, y, z, slope_x, slope_y
/// of RoofPlane, in the CRS) and crossings (positions, counted from 0 through its rings, of
/// vertices that are no corners of the part); a WallSurface `wall`: outer or step.
///
/// Attributes: tetropolis_id, source_ids, h_ground, h_roof, n_ground_points, n_roof_points, flags
/// (names), attribute_height where it is positive, and of buildings with parts n_parts, lod (the
/// highest of any part), volume (m3) and rmse (m), which are not read. Numbers read back as the
/// same doubles.
/// Vertices are integers in steps of 0.1 mm from the model's origin and not repeated.
/// metadata.referenceSystem is set if the system has an EPSG code. The model's domain (CRS
/// coordinates), origin, crs and dropped features go into the root member "+tetropolis" of the
/// extension Tetropolis, which the file declares and docs/tetropolis.ext.json describes.
///
/// Precondition: unique ids; coordinates of footprints and domain are multiples of kCoordinateStep,
/// origin in whole metres; h_ground < h_roof; rings of >= 3 vertices; parts as RoofPart says, their
/// roofs above h_ground.
/// Guarantees: the same model gives the same bytes; the file appears complete or not at all.
/// Errors: kInput if it cannot be written.
void write_city(const std::filesystem::path& path, const CityModel& model,
                const std::string& title = "");

/// What becomes of objects that contradict the format in files of other programs.
enum class BrokenObjects { kRefuse, kDrop };

/// What a file states of its buildings beyond CityModel, one per building, in the order of these.
struct CityDetails {
  /// What is above each, in the model's frame, also where it does not tile the ground: one roof per
  /// RoofSurface (of a geometry without semantics: per surface that is not vertical, so that the
  /// highest counts), none of LoD 0 to 1.2.
  std::vector<std::vector<StatedRoof>> roofs;
  /// Numbers, booleans and text, by name; a part has those of its building, too, unless it has its
  /// own. None of files of write_city.
  std::vector<AttributeColumn> attributes;
};

/// Reads a city model.
///
/// Files of write_city come back as they were: same order, same bits in coordinates and heights
/// (outer rings counter-clockwise, holes clockwise, first vertex kept; crs as normalise_crs has
/// it). Heights are those of the attributes h_ground and h_roof, outlines those of the ground
/// faces, planes of parts those of roof_plane; `warnings`, if given, gets "city_solids_differ"
/// where a solid is not closed or is more than a centimetre off them.
///
/// Of other files every Building and BuildingPart with a surface or solid becomes a building of its
/// own, in the order of the file: id "b1", "b2", ..., its key as source id, footprint = union of
/// the GroundSurfaces of its most detailed geometry (without semantics: of the faces that look
/// down in the lower half of the body, or up at its very bottom; where these are less than 0.6 of
/// what is above them, and walls do not stand around them: of all that are not vertical), h_ground
/// = lowest vertex, h_roof = the height that nine tenths of the area of its RoofSurfaces do not
/// exceed, seen from above (without such semantics over most of the footprint: above which surfaces
/// that look up have a tenth of the footprint's area; highest vertex where these are not known
/// either, or where that is less than 2 m up). A footprint in k pieces becomes k buildings with the
/// source ids KEY, KEY#2, ... and heights of their own, from the surfaces that are in the plan of
/// each, or nearest to it. Objects without usable geometry go to `dropped` (a solid without a level
/// of detail counts as LoD 1).
///
/// Its RoofSurfaces become parts, one each, with the plane nearest to its vertices (no points, rmse
/// NaN), and what they cover the footprint, if they tile one piece that is the ground's plan (what
/// is within a centimetre is the same) and none is more than 5 cm off its plane, or reaches the
/// ground. Otherwise the building is a block. Parts may come closer to each other than a mesh
/// allows.
///
/// Buildings that only hold parts and other types of object are no input features. Origin:
/// `translate` if that is whole metres and no more than 100 km away, else the south-west corner of
/// the vertices, rounded down. Domain: as stored, or empty (xmin > xmax) if there is none.
/// `warnings`, if given, gets "city_objects_dropped", "city_types_unknown" where objects have types
/// of an extension, "city_terrain_unread" where it has a TINRelief, and "city_roofs_flattened"
/// where roofs of blocks reach more than half a metre above that height and `details` are not asked
/// for.
///
/// Errors, kInput with the path and the place in it ("/CityObjects/a/geometry/0/boundaries"):
/// missing, not JSON (with the byte), not CityJSON, unknown version, wrong types, indices out of
/// range, two objects with the same key, coordinates that are not finite; in files of write_city
/// parts that do not tile the ground, are off their planes or not above h_ground. With
/// BrokenObjects::kDrop an object of another file that is one of these goes to `dropped`, with the
/// place in its reason, and costs nothing else.
CityModel read_city(const std::filesystem::path& path, std::vector<Warning>* warnings = nullptr,
                    BrokenObjects broken = BrokenObjects::kRefuse, CityDetails* details = nullptr);

}  // namespace tetropolis
