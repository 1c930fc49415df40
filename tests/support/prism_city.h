// The small city with layers of prisms below its tets.
#pragma once

#include <utility>
#include <vector>

#include "small_city.h"
#include "volume/column/ground_heights.h"
#include "volume/layered/ladder.h"
#include "volume/layered/smooth.h"
#include "volume/layers/prism_layers.h"
#include "volume/upper/grow_upper.h"
#include "volume/upper/lid.h"

namespace tetropolis::testing {

/// With graded columns, and an upper part.
inline MeshedCity prism_city(const SmallCity& city, double mesh_size, const LayerHeights& heights) {
  MeshedCity result;
  result.city = city;
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {mesh_size, 25});
  EdgeGraph edges = build_edge_graph(ground);
  const RoofHeights roofs = city.roofs;
  const std::vector<double> lift = layer_lift(ground, edges, terrain_under(ground, city.dtm),
                                              lowest_roofs(ground, roofs), roofs, heights, 1);
  ColumnPlanOptions options;
  options.domain_height = 80;
  options.layer_height = mesh_size;
  options.lift = lift;
  result.plan = plan_columns(ground, city.dtm, roofs, column_spacing(ground), options);
  lower_tops(ground, edges, result.plan);
  result.mesh = divide_columns(std::move(ground), std::move(edges), result.plan);
  place_nodes(result.mesh, result.plan);
  result.mesh.upper = grow_upper(result.mesh, result.plan.layers.top);
  lay_prisms(lift, heights, result.mesh);
  require_valid(result.mesh);
  return result;
}

/// Prisms alone, on a ladder of layers; without boundary layers if there are none in `heights`.
inline MeshedCity city_of_prisms(const SmallCity& city, double mesh_size,
                                 const LayerHeights& heights) {
  MeshedCity result;
  result.city = city;
  GroundMesh ground = mesh_ground(city.footprints, city.domain, {mesh_size, 25});
  const RoofHeights roofs = city.roofs;
  const std::vector<double> lift =
      layer_lift(ground, build_edge_graph(ground), terrain_under(ground, city.dtm),
                 lowest_roofs(ground, roofs), roofs, heights, 1);
  ColumnPlanOptions options;
  options.fit_lowered_walls = false;
  options.domain_height = 80;
  options.layer_height = mesh_size;
  options.lift = lift;
  result.plan = plan_columns(ground, city.dtm, roofs, column_spacing(ground), options);
  const LayerPlan& plan = result.plan.layers;
  LayeredMesh layered =
      make_layers(std::move(ground), make_ladder(plan.bottom, plan.highest_ground + 20, plan.top,
                                                 {1.2, 1.2, mesh_size / 2, 2 * mesh_size}));
  smooth_to_ground(layered, result.plan.ground, {});
  trim(layered, result.plan.lowest_roof, city.roofs);
  smooth_to_roofs(layered, result.plan.lowest_roof, city.roofs, {});
  result.mesh = columns_of_layers(std::move(layered));
  if (heights.count > 0) lay_prisms(lift, heights, result.mesh);
  make_whole(result.mesh);
  require_valid(result.mesh);
  return result;
}

}  // namespace tetropolis::testing
