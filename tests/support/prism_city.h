// The small city with layers of prisms below its tets.
#pragma once

#include <utility>
#include <vector>

#include "small_city.h"
#include "volume/column/ground_heights.h"
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

}  // namespace tetropolis::testing
