// A few buildings on hills, meshed: what the volume tests work on.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "tetropolis/ground/mesh_ground.h"
#include "tetropolis/terrain/raster.h"
#include "tetropolis/volume/column_mesh.h"
#include "tetropolis/volume/ground_heights.h"
#include "tetropolis/volume/smooth.h"

namespace tetropolis::testing {

struct SmallCity {
  Bounds2 domain{0, 0, 120, 90};
  std::vector<Polygon> footprints;
  std::vector<double> roofs;  ///< Elevations.
  Raster dtm;
};

inline Polygon rectangle(double x0, double y0, double x1, double y1) {
  return {{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, {}};
}

inline Raster raster_of(const Bounds2& domain,
                        const std::function<double(double, double)>& height) {
  Raster raster{static_cast<std::int32_t>(domain.width()) + 1,
                static_cast<std::int32_t>(domain.height()) + 1,
                domain.xmin,
                domain.ymin,
                1.0,
                {}};
  for (std::int32_t j = 0; j < raster.ny; ++j)
    for (std::int32_t i = 0; i < raster.nx; ++i)
      raster.values.push_back(height(domain.xmin + i, domain.ymin + j));
  return raster;
}

/// Five buildings, one with a courtyard, one low and one a tower, on `height`.
inline SmallCity small_city(const std::function<double(double, double)>& height) {
  SmallCity city;
  city.footprints = {rectangle(20, 15, 38, 27), rectangle(39.5, 15, 55, 40),
                     rectangle(70, 20, 105, 60), rectangle(15, 50, 22, 56),
                     Polygon{{{30, 50}, {58, 48}, {60, 75}, {44, 66}, {30, 76}}, {}}};
  city.footprints[2].holes = {{{80, 30}, {80, 50}, {95, 50}, {95, 30}}};
  city.dtm = raster_of(city.domain, height);
  const std::vector<double> above{12, 31, 18, 3, 64};
  for (std::size_t i = 0; i < city.footprints.size(); ++i)
    city.roofs.push_back(height(city.footprints[i].outer[0].x, city.footprints[i].outer[0].y) +
                         above[i]);
  return city;
}

inline double hills(double x, double y) {
  // A hill of 20 m with slopes of up to 40 degrees.
  const double dx = (x - 60) / 30, dy = (y - 45) / 30;
  return 100 + 20 / (1 + dx * dx + dy * dy);
}

struct MeshedCity {
  SmallCity city;
  ColumnMesh mesh;
  std::vector<BuildingIndex> owner;
  GroundHeights heights;
};

/// Steps 3.1 to 3.5.
inline MeshedCity meshed(const SmallCity& city, double mesh_size = 8, bool fixed_top = true,
                         double layer_height = 0) {
  MeshedCity result;
  result.city = city;
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {mesh_size, 25});
  result.owner = vertex_buildings(ground);
  result.heights = ground_heights(ground, result.owner, city.roofs, city.dtm, 1.0);
  double highest = city.dtm.values[0];
  for (const double z : city.dtm.values) highest = std::max(highest, z);
  const LayerPlan plan = plan_layers(result.heights.z, city.roofs, highest, 80,
                                     layer_height > 0 ? layer_height : mesh_size);
  result.mesh = make_columns(std::move(ground), plan.layers, plan.bottom, plan.top);
  SmoothOptions options;
  options.laplace.fixed_top = fixed_top;
  smooth_to_ground(result.mesh, result.heights.z, options);
  trim(result.mesh, result.owner, city.roofs);
  smooth_to_roofs(result.mesh, result.owner, city.roofs, options);
  return result;
}

}  // namespace tetropolis::testing
