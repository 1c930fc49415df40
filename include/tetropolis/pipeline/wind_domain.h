// The domain that guidelines for wind around buildings ask for.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tetropolis/city/city_model.h"
#include "tetropolis/core/warning.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

enum class DomainShape : std::uint8_t {
  kData,      ///< Where there are data: nothing is added.
  kBox,       ///< Along the wind.
  kCylinder,  ///< For all directions of the wind.
  kGiven,
};

/// Coordinates of the CRS.
struct GivenDomain {
  Domain sides;                                           ///< And the patches on them.
  double top = std::numeric_limits<double>::quiet_NaN();  ///< Elevation; NaN: by the guidelines.
};

struct WindDomainOptions {
  DomainShape shape = DomainShape::kData;
  double wind_from_deg = 270;  ///< Where the wind comes from, clockwise from north (+y); not of a
                               ///< cylinder.
  int sectors = 36;            ///< Of a cylinder: patches, 4 to 360.
  GivenDomain given = {};
};

/// What a domain was made of. Lengths in metres; all 0 for DomainShape::kData.
struct WindDomainFacts {
  double building_height =
      0;                ///< H: from its own ground to the highest roof of the tallest building.
  std::string tallest;  ///< Its id.
  double guideline_length = 0, guideline_width = 0, guideline_height = 0;  ///< Before widening.
  double guideline_blockage = 0;  ///< Frontal area of all buildings over width times height.
  double length = 0, width = 0;   ///< Along the wind and across, as made.
  double guideline_radius = 0, radius = 0;  ///< Of a cylinder, before widening and as made.
  double blockage = 0;                      ///< As made.
  std::string inlet;                        ///< Patch that the wind blows in through; of a box.
  Bounds2 data = {};                        ///< Where there are data, CRS coordinates.
  double area_outside_data = 0;             ///< Share of the domain.
  double rim_height = 0;  ///< Mean height of the data's rim, to which terrain fades.
};

/// A polygon as a domain, its sides "side_1" and on. Throws Error(kInput) unless it is simple.
Domain polygon_domain(const Polygon& polygon);

/// A domain in CRS coordinates, in the local frame of `origin`; corners are snapped.
Domain in_local_frame(const Domain& domain, Point2 origin);

/// Frontal area of the buildings for wind along the unit vector `along`: the area of the union of
/// the shadows of their roofs, square metres, each shadow widened to whole half metres.
double frontal_area(const CityModel& city, Point2 along);

/// Where the top of a domain should be, metres: 5 times the height of the tallest building above
/// the highest roof. Precondition: there are buildings.
double guideline_top(const CityModel& city);

/// Puts a domain around the buildings of `city`, and terrain under it. COST action 732 (Franke et
/// al. 2007) and AIJ (Tominaga et al. 2008): with H the height of the tallest building, 5 H from
/// the buildings to the inlet, to the sides and from the tallest roof to the top, 15 H to the
/// outlet; a box is then widened until buildings block at most 3 % of its cross-section (of width
/// times 6 H). A cylinder has 15 H on all sides of the circle around the buildings' box, and is
/// widened likewise for the winds from its sectors, its diameter being the width. A box
/// along the x or y axis keeps the patches xmin to ymax; another one has "inlet", "outlet",
/// "side_left" and "side_right" (looking downwind), a cylinder "sector_000" and on by where they
/// lie from the centre, in degrees clockwise from north; all from number 9.
///
/// In the box of the buildings (along the wind) terrain stays as it is. Beyond, it fades to the
/// mean height of the rim of `terrain` by a smoothstep over 5 H, so that inlet, sides and outlet
/// are level. `terrain` gets as many nodes as cover the domain. Where `wider` is known terrain,
/// that is kept instead. "terrain_levelled" if known terrain moves by more than 2 m.
///
/// Precondition: `terrain` covers `city.domain`. Buildings outside of a domain that is given, or
/// closer than `min_distance` to its sides, move to `city.dropped`. Sets city.domain and
/// city.domain_top. Throws Error(kInput): no building, but for a domain that is given.
WindDomainFacts fit_wind_domain(const WindDomainOptions& options, double min_distance,
                                CityModel& city, Raster& terrain, std::vector<Warning>& warnings,
                                const Raster* wider = nullptr);

}  // namespace tetropolis
