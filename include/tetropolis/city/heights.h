// Steps 1.6 and 2.3: ground and roof heights of buildings from their points.
#pragma once

#include <span>

#include "tetropolis/city/city_model.h"
#include "tetropolis/city/extract.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/terrain/raster.h"

namespace tetropolis {

struct HeightOptions {
  double ground_percentile = 10;  ///< Of the ground points' heights, in [0, 100].
  double roof_percentile = 70;    ///< Of the roof points' heights, in [0, 100]; the paper's is 90,
                                  ///< above most of a sloped roof.
  double min_height = 2.5;        ///< Least height of a building above its ground, metres, >= 0.
};

/// The p-th percentile (p in [0, 100]) by linear interpolation between the order statistics number
/// floor(q) and floor(q) + 1, q = (n - 1) p / 100, counted from 0: NumPy's default, method 7 of
/// Hyndman & Fan, "Sample quantiles in statistical packages" (1996). Reorders `values`.
/// Precondition: at least one value, none NaN.
double percentile(std::span<double> values, double p);

/// Sets h_ground, h_roof, n_ground_points, n_roof_points and the flags kGroundFromDtm,
/// kRoofFromUnclassified, kRoofFromAttribute, kNoRoofPoints, kMinimumHeight of every building
/// (other flags stay):
/// - h_ground: the percentile of the building's ground points; without any, the DTM at the
///   footprint's interior_point (kGroundFromDtm).
/// - h_roof: the percentile of its roof points (kRoofFromUnclassified if these are by exclusion);
///   without any, h_ground plus attribute_height where that is finite and positive
///   (kRoofFromAttribute), otherwise h_ground plus min_height (kNoRoofPoints).
/// - h_roof below h_ground + min_height is raised to it (kMinimumHeight).
/// Both are whole millimetres (snap_height).
/// Preconditions: points.roof and points.ground have one list per building, in the same order, with
/// indices into `cloud`; the DTM has no NaN.
/// Guarantees: h_roof >= h_ground + min_height, up to rounding to millimetres; the same bytes for
/// any number of threads. Source: Naserentin & Logg 2022 (arXiv 2210.05250), step 1.6.
void compute_heights(std::span<Building> buildings, const BuildingPoints& points,
                     const PointCloud& cloud, const Raster& dtm, const HeightOptions& options = {});

}  // namespace tetropolis
