#include "options_of.h"

#include "memory_limit.h"

namespace tetropolis {

DomainShape domain_shape(const Config& config) {
  if (config.domain == "data") return DomainShape::kData;
  if (config.domain == "auto") return DomainShape::kBox;
  return config.domain == "cylinder" ? DomainShape::kCylinder : DomainShape::kGiven;
}

BuildCityOptions city_options(const Config& config) {
  BuildCityOptions options;
  if (!config.bounds.empty())
    options.bounds = {config.bounds[0], config.bounds[1], config.bounds[2], config.bounds[3]};
  options.domain_margin = config.domain_margin;
  options.terrain_only = config.terrain_only;
  options.domain.shape = domain_shape(config);
  options.domain.wind_from_deg = config.wind_from;
  options.domain.sectors = config.sectors;
  if (!config.origin.empty()) options.origin = Point2{config.origin[0], config.origin[1]};
  options.boundary_buildings = config.boundary_buildings;
  options.measured_ground = config.measured_ground;
  options.ground_filter = config.ground_filter;
  options.filter.window = config.ground_filter_window;
  options.filter.slope = config.ground_filter_slope;
  options.dtm.step = config.dtm_step;
  options.extract.margin = config.ground_margin;
  options.extract.sigma = config.outlier_sigma;
  options.heights = {config.ground_percentile, config.roof_percentile, config.min_building_height};
  options.default_height = config.default_height;
  options.lod = config.lod;
  options.simplify.min_distance = config.min_building_distance;
  options.simplify.close_gaps = config.close_gaps;
  options.simplify.growths = config.merge_growths;
  options.simplify.min_area = config.min_building_area;
  options.simplify.parallel_tolerance = config.parallel_tolerance;
  options.max_bytes = memory_limit(config);
  return options;
}

MeshCityOptions mesh_options(const Config& config) {
  MeshCityOptions options;
  options.mesh_size = config.mesh_size;
  options.grading.far_size = config.far_size;
  options.grading.ground_size = config.ground_size;
  options.grading.growth = config.size_growth;
  options.surface_clearance = config.min_building_distance;
  options.target_cells = config.target_cells;
  options.min_angle_deg = config.min_angle;
  if (config.domain_height > 0) options.domain_height = config.domain_height;
  options.own_top = config.domain_height == 0;
  options.cells = config.cells;
  options.layering = config.layering;
  options.layer_height = config.layer_height;
  options.boundary_layers = {config.boundary_layers, config.first_layer, config.layer_growth};
  options.top = config.top;
  options.min_wall_height = config.min_wall_height;
  options.cut_slope_deg = config.cut_slope;
  options.min_gap_share = config.min_gap_share;
  options.solver_tolerance = config.solver_tolerance;
  options.solver_iterations = config.solver_iterations;
  options.max_bytes = memory_limit(config);
  return options;
}

}  // namespace tetropolis
