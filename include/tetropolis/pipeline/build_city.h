// Steps 1.3 to 2.3 in memory: from points and footprints to terrain and city models.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/city/heights.h"
#include "tetropolis/city/roofs.h"
#include "tetropolis/city/simplify/simplify.h"
#include "tetropolis/core/steps.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/io/las/las.h"
#include "tetropolis/io/vector/vector.h"
#include "tetropolis/pipeline/wind_domain.h"
#include "tetropolis/terrain/dtm.h"
#include "tetropolis/terrain/ground_filter.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

/// Whether ground points are found by filter_ground: where no point of the cloud, or of some of its
/// files, has the ground class; never; always.
enum class GroundFilter { kAuto, kNever, kAlways };

/// What becomes of footprints that cross the domain's boundary.
enum class BoundaryBuildings { kDrop, kClip };

/// Terrain that is known, instead of that of ground points.
struct TerrainInput {
  std::string source = "terrain";  ///< What messages call it.
  Raster raster;                   ///< Of elevations, metres. One node: level ground everywhere.
  Point2 origin;                   ///< Of the raster's frame, CRS coordinates.
  std::string crs;                 ///< Of the coordinates; "" if unknown.
  bool is_of_bases = false;        ///< It is made of the bases that buildings state.
};

/// What a city is made of. Roofs are those of the points, else the heights that footprints state;
/// ground is the terrain, else that of the points.
struct CitySources {
  PointsInput points;  ///< May be empty if there is a terrain.
  FootprintsInput footprints;
  std::optional<TerrainInput> terrain = {};
  bool has_surface = false;  ///< The points are cells of a surface: their class says nothing.
};

/// What becomes of footprints in which the points measure ground and no roof.
enum class MeasuredGround { kDrop, kKeep };

/// Messages call options as settings are called (docs/settings.md), of which these have other
/// names: `wind_from` (domain), `ground_filter_window` and `ground_filter_slope` (filter),
/// `dtm_step` (dtm), `ground_margin` and `outlier_sigma` (extract), `ground_percentile`,
/// `roof_percentile` and `min_building_height` (heights), `min_building_distance`, `merge_growths`
/// and `min_building_area` (simplify), `max_memory` (max_bytes).
struct BuildCityOptions {
  /// The domain, CRS coordinates. None: the box of the footprints within that of the points, grown
  /// by `domain_margin` as far as there are points; without footprints the box of the points. With
  /// BoundaryBuildings::kDrop it reaches up to `domain_margin` (and 10 m or that around a building)
  /// beyond the points to keep buildings whole that lie mostly within the points' box; those in it
  /// that do not are dropped.
  std::optional<Bounds2> bounds = {};
  double domain_margin = 40;      ///< Metres, >= 0.
  WindDomainOptions domain = {};  ///< What is put around the domain above, which then says where
                                  ///< there are data and buildings.
  std::optional<Point2> origin = {};  ///< Of the local frame, CRS coordinates in whole metres.
                                      ///< None: a corner of the data.
  bool terrain_only = false;          ///< A city without buildings is no error.
  BoundaryBuildings boundary_buildings = BoundaryBuildings::kDrop;
  GroundFilter ground_filter = GroundFilter::kAuto;
  MeasuredGround measured_ground = MeasuredGround::kDrop;
  GroundFilterOptions filter = {};
  DtmOptions dtm = {};
  ExtractOptions extract = {};  ///< `no_buildings` is found, not taken from here.
  HeightOptions heights = {};
  double default_height = 6;  ///< Metres, > 0: of footprints that state no height, without points.
  SimplifyOptions simplify =
      {};               ///< min_distance, min_area and parallel_tolerance hold for 1.4, too.
  Lod lod = Lod::k2_2;  ///< Of roofs; RoofOptions follow from it and the options above.
  bool canopy_heights = false;  ///< Whether they are measured.
  double max_bytes = 0;         ///< Memory of the process, >= 0; 0: nine tenths of usable_memory().
};

/// What went in.
struct InputFacts {
  std::string ground = "points";  ///< What the terrain is made of: "points", "raster",
                                  ///< "bases" (of buildings), "level".
  std::string roofs = "points";   ///< The same of roofs: "points", "raster", "attributes".
  std::int64_t point_files = 0;
  std::int64_t point_files_skipped = 0;
  std::int64_t points_read = 0;
  std::int64_t points_kept = 0;
  std::map<int, std::int64_t> points_by_class;
  std::int64_t ground_filtered = 0;      ///< Points that the ground filter found to be ground.
  std::int64_t ground_outliers = 0;      ///< Ground points left out as birds or pits.
  std::int64_t footprints_read = 0;      ///< Features of the file.
  std::int64_t footprint_parts = 0;      ///< The same with multipolygons, and what the domain or
                                         ///< planned buildings cut, split: what is accounted for.
  std::int64_t footprints_unlisted = 0;  ///< FootprintsInput::unlisted.
};

/// What became of the footprints: the counts from `kept` to `replaced` add up to `features` and
/// `further_parts`.
struct FootprintAccount {
  std::int64_t features = 0;       ///< Of the file.
  std::int64_t further_parts = 0;  ///< Of multipolygons and of what the domain or planned buildings
                                   ///< cut, beyond the first of each feature.
  std::int64_t kept = 0;           ///< Buildings of one footprint.
  std::int64_t merged = 0;         ///< Footprints in buildings of several.
  std::array<std::int64_t, kDropCauses> dropped{};  ///< By DropCause.
  std::int64_t unlisted = 0;  ///< Of those outside: those that are not in CityFacts::dropped.

  std::int64_t& of(DropCause cause) { return dropped[static_cast<std::size_t>(cause)]; }
  std::int64_t of(DropCause cause) const { return dropped[static_cast<std::size_t>(cause)]; }
};

/// What the city is.
struct CityFacts {
  std::int64_t raw_buildings = 0;
  std::int64_t buildings = 0;
  std::int64_t merged_groups = 0;  ///< Buildings made of more than one input feature.
  FootprintAccount account;
  double area_at_boundary = 0;  ///< Of footprints dropped at the boundary, within the domain and
                                ///< the points' box, square metres.
  double min_clearance = std::numeric_limits<double>::infinity();  ///< Metres; between all rings.
  double area_before = 0;  ///< Of the union of the footprints, square metres.
  double area_after = 0;
  double volume_before = 0;       ///< Of the footprints times their heights, cubic metres; where
                                  ///< they overlap, twice.
  double volume_after = 0;        ///< Of the buildings, as blocks or below their parts.
  double area_moved = 0;          ///< Of the symmetric difference of both unions.
  double area_changed_share = 0;  ///< area_moved / area_before.
  double max_distance = 0;        ///< Between the input and output of one building, metres.
  std::int64_t hulls = 0;         ///< Buildings that are convex hulls.
  std::map<std::string, std::int64_t> resorts;  ///< Simplification: how often each was needed.
  std::map<std::string, std::int64_t> flags;    ///< Buildings with each flag.
  double dtm_empty_share = 0;  ///< Share of the terrain's nodes without a point of their own.
  double dtm_void_share = 0;   ///< Share of the domain's squares of 20 m without a ground point.
  RoofFacts roofs;             ///< Nothing at Lod::kBlock.
  WindDomainFacts domain;      ///< Nothing at DomainShape::kData.
  std::vector<Dropped> dropped;
};

struct BuiltCity {
  CityModel raw;               ///< After step 1: one building per footprint.
  CityModel city;              ///< After step 2: merged, with the clearance asked for.
  Raster terrain;              ///< Covers the domain; local frame of both models.
  Raster canopy_heights;       ///< The highest point of vegetation (classes 3 to 5) nearest to each
                               ///< node, above the terrain, metres; NaN where there is none. Empty
                               ///< unless asked for, and without such points.
  FootprintsInput footprints;  ///< As given, in the local frame.
  InputFacts input;
  CityFacts facts;
  std::vector<Warning> warnings;  ///< Those of the input first.
  std::vector<StepTime> steps;
};

/// What became of all footprints in one line: "800 footprints make 46 buildings: 751 in 34 blocks
/// closer than 1 m, 12 alone; dropped: 22 at the boundary (`boundary_buildings` clip keeps them),
/// 15 smaller than 15 m2". "" where there were none. `options`: those of build_city.
std::string account_in_words(const CityFacts& facts, const BuildCityOptions& options);

/// Builds terrain and city models (paper steps 1.3 to 2.3).
///
/// `points`: as read_points returns them, or made of arrays: `points` and `origin` are needed, and
/// `extent` (the box of the points); `files` names ranges of the cloud that were classified apart.
/// `footprints`: as read_footprints returns them, CRS coordinates, or made of polygons:
/// `features` are needed, of each its `source_id` and `polygon`, and `height` where there are no
/// points. Where both state a reference system it has to be the same one
/// (ReadFootprintsOptions::target_crs); the city's is that of the points, else that of the
/// footprints. The local frame has its zero at `points.origin`, or, where that is far from the
/// points, at their south-western corner.
///
/// Guarantees: every footprint is in one building or in `dropped` with a reason, in either model;
/// the footprints of `city` keep options.simplify.min_distance from each other and the domain's
/// boundary; the same bytes for any number of threads.
///
/// Throws Error(kInput), naming `points.source` or `footprints.source`: no points, an id that is
/// empty or used twice, degrees, units other than metres, no overlap, no ground, no usable
/// footprint (unless terrain_only); a terrain that is none, or has values that are no elevations
/// (NaN, -9999). Error(kUsage): the points need more than max_bytes. Error(kGuarantee): an account
/// that does not add up. Cancelled.
BuiltCity build_city(PointsInput points, FootprintsInput footprints,
                     const BuildCityOptions& options = {}, const StepHooks& hooks = {});

/// The same of other sources. With a terrain, its heights are sampled on the grid of step 1.3 and
/// under buildings; unclassified points near it are ground. Without points, buildings have the
/// height that their footprints state, else options.default_height, as their flags tell, and
/// `points.extent`, or else the terrain and the footprints, say where the domain is.
BuiltCity build_city(CitySources sources, const BuildCityOptions& options = {},
                     const StepHooks& hooks = {});

}  // namespace tetropolis
