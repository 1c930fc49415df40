#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include "tetropolis/io/crs/crs.h"
#include "tetropolis/run/config.h"

#include "file_and_attribute.h"
#include "memory_limit.h"
#include "read_size_regions.h"
#include "read_surfaces.h"

namespace tetropolis {

namespace {

constexpr unsigned kAll = kBuild | kCity | kMesh | kSynth;
constexpr unsigned kData = kBuild | kCity;
constexpr unsigned kMeshes = kBuild | kMesh;

template <auto member>
ChoiceMember choice() {
  using Value = std::remove_reference_t<decltype(std::declval<Config>().*member)>;
  return {[](const Config& config) { return static_cast<std::size_t>(config.*member); },
          [](Config& config, std::size_t index) { config.*member = static_cast<Value>(index); }};
}

void require_crs(const std::string& text) { normalise_crs(text); }

void require_refine(const std::string& text) { parse_refine(text); }

void require_surface_layer(const std::string& text) { parse_surface_layer(text); }

void require_planned(const std::string& text) { parse_file_and_attribute("planned", text); }

void require_canopies(const std::string& text) { parse_file_and_attribute("canopies", text); }

void require_size(const std::string& text) {
  if (!text.empty()) parse_size(text);
}

std::vector<ConfigField> input_fields() {
  using C = Config;
  return {
      {.name = "footprints",
       .member = &C::footprints,
       .help = "Building footprints: files in any vector format that GDAL reads, folders, patterns",
       .value = "PATH",
       .common = true},
      {.name = "planned",
       .member = &C::planned,
       .help =
           "Planned buildings, with heights above ground in a column `height` or the one named. "
           "Footprints that they cover by half make way, others are cut; of height 0: what is "
           "to be torn down",
       .value = "FILE or FILE:ATTRIBUTE",
       .require = require_planned},
      {.name = "points",
       .member = &C::points,
       .help = "Point clouds, if there are any: LAS or LAZ files, folders, patterns",
       .value = "PATH",
       .common = true},
      {.name = "city",
       .member = &C::city,
       .commands = kMesh,
       .help = "City model in CityJSON, as `city` and `build` write it",
       .value = "FILE",
       .common = true},
      {.name = "dtm",
       .member = &C::dtm,
       .commands = kBuild | kCity | kMesh,
       .help = "Terrain: rasters, folders, patterns; default: of the ground points, else of the "
               "bases of a city model, else level",
       .value = "PATH",
       .common = true},
      {.name = "dsm",
       .member = &C::dsm,
       .help = "Surface with roofs, instead of points: rasters, folders, patterns",
       .value = "PATH",
       .common = true},
      {.name = "ground_level",
       .member = &C::ground_level,
       .commands = kBuild | kCity | kMesh,
       .help = "Elevation of level ground, where there is neither terrain nor ground points; of a "
               "city model, if not 0",
       .unit = "m",
       .min = -1000,
       .max = 9000},
      {.name = "bounds",
       .member = &C::bounds,
       .commands = kBuild | kCity | kMesh,
       .help = "Domain, in the CRS of the points (mesh: of the terrain); default: where footprints "
               "and points overlap, plus a margin (mesh: that of the city model, or the terrain)",
       .unit = "m",
       .value = "XMIN,YMIN,XMAX,YMAX",
       .common = true,
       .min = -1e9,
       .max = 1e9},
      {.name = "origin",
       .member = &C::origin,
       .help = "Origin of the local frame in the CRS of the points, whole metres: runs with the "
               "same one overlay exactly; default: a corner of the data",
       .unit = "m",
       .value = "X,Y",
       .min = -1e9,
       .max = 1e9},
      {.name = "domain",
       .member = &C::domain,
       .help = "data: where there are data, or `bounds`; auto: a box around the buildings by COST "
               "732 and AIJ, widened until they block 3 % of it; cylinder: one for all winds; a "
               "file with a polygon; or a folder of results, whose domain and top it gets. Terrain "
               "beyond the buildings fades to level, but for that of `dtm`",
       .value = "data|auto|cylinder|FILE|FOLDER",
       .common = true},
      {.name = "wind_from",
       .member = &C::wind_from,
       .help = "Where the wind comes from, clockwise from north. With domain = auto, the box turns "
               "with it; "
               "for a polygon, the report says how much buildings block of it",
       .unit = "degrees",
       .common = true,
       .min = 0,
       .max = 360},
      {.name = "sectors",
       .member = &C::sectors,
       .help = "With domain = cylinder, patches around it",
       .min = 4,
       .max = 360},
      {.name = "points_crs",
       .member = &C::points_crs,
       .help = "CRS of the points, overriding the files: a code such as EPSG:28992, or WKT",
       .value = "CRS",
       .common = true,
       .require = require_crs},
      {.name = "footprints_crs",
       .member = &C::footprints_crs,
       .help = "CRS of the footprints, overriding the file: a code such as EPSG:4326, or WKT",
       .value = "CRS",
       .require = require_crs},
      {.name = "raster_crs",
       .member = &C::raster_crs,
       .help = "CRS of dtm and dsm, overriding the files",
       .value = "CRS",
       .require = require_crs},
      {.name = "require_grids",
       .member = &C::require_grids,
       .help = "Refuse to reproject without the grid that makes it accurate"},
      {.name = "layer",
       .member = &C::layer,
       .help = "Layer of the footprint file",
       .value = "NAME"},
      {.name = "where",
       .member = &C::where,
       .help = "Condition on attributes of the footprints, such as \"status = 'built'\" (OGR SQL)",
       .value = "CONDITION"},
      {.name = "id_attribute",
       .member = &C::id_attribute,
       .help = "Attribute with the buildings' ids; default: the feature number",
       .value = "NAME"},
      {.name = "height_attribute",
       .member = &C::height_attribute,
       .help = "Attribute with heights above ground, used where no roof is measured",
       .value = "NAME"},
      {.name = "height_unit",
       .member = choice<&C::height_unit>(),
       .help = "Unit of the heights that name none themselves",
       .choices = {"m", "ft", "us-ft"}},
      {.name = "floors_attribute",
       .member = &C::floors_attribute,
       .help = "Attribute with numbers of floors, used where there is no height; default: "
               "building:levels, building_levels, num_floors or levels",
       .value = "NAME"},
      {.name = "floor_height",
       .member = &C::floor_height,
       .help = "Height of a floor",
       .unit = "m",
       .min = 1,
       .max = 20},
      {.name = "default_height",
       .member = &C::default_height,
       .help = "Height of buildings that state none, where there are neither points nor dsm",
       .unit = "m",
       .min = 0,
       .max = 1000,
       .above_min = true},
      {.name = "terrain_only",
       .member = &C::terrain_only,
       .commands = kBuild | kCity | kMesh,
       .help = "Accept a domain without any building"}};
}

std::vector<ConfigField> output_fields() {
  using C = Config;
  return {
      {.name = "out",
       .member = &C::out,
       .commands = kAll,
       .help = "Folder for the results",
       .value = "DIR",
       .letter = 'o',
       .common = true},
      {.name = "overwrite",
       .member = &C::overwrite,
       .commands = kAll,
       .help = "Replace files in the way of results that no earlier run has written",
       .common = true},
      {.name = "formats",
       .member = &C::formats,
       .help = "Formats of the meshes, comma separated; replaces the default: list vtu to keep it",
       .common = true,
       .choices = {"vtu", "xdmf", "msh", "msh2", "vtkhdf", "cgns", "fluent", "su2", "openfoam",
                   "obj", "ply", "glb"}},
      {.name = "building_patches",
       .member = &C::building_patches,
       .help = "Formats with named patches (openfoam, msh, msh2, cgns, fluent, su2): a roof and a "
               "wall patch for each building, such as roof_b7"},
      {.name = "building_zones",
       .member = &C::building_zones,
       .help = "Formats with named zones of cells (openfoam, msh, msh2, cgns, fluent): the cells "
               "above each building are a zone, such as over_b7"},
      {.name = "coordinates",
       .member = choice<&C::coordinates>(),
       .help = "Coordinates of meshes: relative to the origin in report.json, or of the CRS",
       .choices = {"local", "absolute"}},
      {.name = "compression",
       .member = choice<&C::compression>(),
       .help = "Compression of VTK and XDMF files: about a quarter of the size, slower to write",
       .choices = {"none", "zlib"}},
      {.name = "no_html",
       .member = &C::no_html,
       .commands = kBuild | kCity | kMesh,
       .help = "Leave out index.html, the page that shows the run"}};
}

std::vector<ConfigField> city_model_fields() {
  using C = Config;
  return {
      {.name = "domain_margin",
       .member = &C::domain_margin,
       .help =
           "Margin around the footprints without `bounds`, as far as there are points; also how "
           "far the domain may reach beyond them to keep a building whole",
       .unit = "m",
       .min = 0,
       .max = 1e5},
      {.name = "dtm_step",
       .member = &C::dtm_step,
       .help = "Distance between the terrain's nodes",
       .unit = "m",
       .min = 0.01,
       .max = 1000},
      {.name = "ground_filter",
       .member = choice<&C::ground_filter>(),
       .help = "Find ground points by a morphological filter: where the cloud or a file lacks the "
               "ground class, never, or always",
       .choices = {"auto", "never", "always"}},
      {.name = "ground_filter_window",
       .member = &C::ground_filter_window,
       .help =
           "Ground filter: half the width of the widest building that is not among the footprints",
       .unit = "m",
       .min = 1,
       .max = 1000},
      {.name = "ground_filter_slope",
       .member = &C::ground_filter_slope,
       .help = "Ground filter: rise over run of the steepest terrain",
       .min = 0.01,
       .max = 2},
      {.name = "parallel_tolerance",
       .member = &C::parallel_tolerance,
       .help = "Consecutive edges that differ less in direction are joined, where that moves the "
               "outline by at most 2 cm at a corner, and 5 cm in all",
       .unit = "rad",
       .min = 0,
       .max = 0.5},
      {.name = "ground_margin",
       .member = &C::ground_margin,
       .help = "Width of the ring around a footprint whose points give its ground height",
       .unit = "m",
       .min = 0,
       .max = 50},
      {.name = "outlier_sigma",
       .member = &C::outlier_sigma,
       .help = "Points further than this from the mean height are outliers",
       .unit = "standard deviations",
       .min = 0,
       .above_min = true},
      {.name = "ground_percentile",
       .member = &C::ground_percentile,
       .help = "Ground height: percentile of the ground points",
       .unit = "%",
       .min = 0,
       .max = 100},
      {.name = "roof_percentile",
       .member = &C::roof_percentile,
       .help =
           "Height of flat roofs: percentile of the roof points (90 in the paper, which is above "
           "most of a sloped roof)",
       .unit = "%",
       .min = 0,
       .max = 100},
      {.name = "lod",
       .member = choice<&C::lod>(),
       .help = "Roofs: planes where the points carry them (2.2), flat parts a metre or more apart "
               "(1.3), one flat part per footprint (1.2), one flat block per building (block)",
       .common = true,
       .choices = {"block", "1.2", "1.3", "2.2"}},
      {.name = "min_building_height",
       .member = &C::min_building_height,
       .help = "Lower buildings are raised to this",
       .unit = "m",
       .min = 0.1,
       .max = 1000},
      {.name = "min_building_distance",
       .member = &C::min_building_distance,
       .commands = kData | kMesh,
       .help = "Footprints closer than this are merged, and no detail is smaller (mesh: closer "
               "ones are refused)",
       .unit = "m",
       .common = true,
       .min = 0.05,
       .max = 1000},
      {.name = "close_gaps",
       .member = &C::close_gaps,
       .help = "Slots between walls that are narrower than this and lead nowhere, and such "
               "courtyards, are filled; passages stay",
       .unit = "m",
       .min = 0,
       .max = 1000},
      {.name = "merge_growths",
       .member = &C::merge_growths,
       .help = "Reaches tried for pieces that join footprints: the distance, twice that, four "
               "times that, ...",
       .min = 1,
       .max = 10},
      {.name = "min_building_area",
       .member = &C::min_building_area,
       .help = "Smaller footprints are dropped after merging",
       .unit = "m2",
       .min = 0},
      {.name = "measured_ground",
       .member = choice<&C::measured_ground>(),
       .help = "What becomes of footprints without a stated height in which the points measure "
               "ground and no roof",
       .choices = {"drop", "keep"}},
      {.name = "boundary_buildings",
       .member = choice<&C::boundary_buildings>(),
       .help = "What to do with buildings that cross the domain's boundary; without `bounds`, drop "
               "lets the domain reach beyond the points for buildings mostly within them",
       .choices = {"drop", "clip"}}};
}

std::vector<ConfigField> mesh_fields() {
  using C = Config;
  return {
      {.name = "mesh_size",
       .member = &C::mesh_size,
       .help = "Longest edge in the ground mesh; with far_size, in buildings and at their walls",
       .unit = "m",
       .common = true,
       .min = 0.05,
       .max = 10000},
      {.name = "far_size",
       .member = &C::far_size,
       .help = "Longest edge far from buildings, at least mesh_size; 0: mesh_size, so that all "
               "places are alike",
       .unit = "m",
       .common = true,
       .min = 0,
       .max = 10000},
      {.name = "ground_size",
       .member = &C::ground_size,
       .help = "With far_size: longest edge on the ground between buildings, in the convex hull of "
               "all; 0: as edges grow",
       .unit = "m",
       .min = 0,
       .max = 10000},
      {.name = "size_growth",
       .member = &C::size_growth,
       .help = "With far_size or refine: an edge over the one before it, away from buildings and "
               "areas",
       .min = 1.01,
       .max = 3},
      {.name = "refine",
       .member = &C::refine,
       .help = "Areas with a longest edge of their own, in metres: polygons of a vector file, or a "
               "box in the CRS of the points",
       .value = "FILE:SIZE or XMIN,YMIN,XMAX,YMAX:SIZE",
       .require = require_refine},
      {.name = "surface_layers",
       .member = &C::surface_layers,
       .help = "Polygons of water, roads and vegetation: their edges become edges of the mesh, the "
               "ground in them a patch, water level; of one kind, or of the kinds that an "
               "attribute names",
       .value = "FILE:water|road|vegetation or FILE:ATTRIBUTE",
       .require = require_surface_layer},
      {.name = "canopies",
       .member = &C::canopies,
       .help = "Polygons of trees: the cells in them become zones of porous air; up to the height "
               "above ground that an attribute states in metres, or that points of classes 3 to 5 "
               "have",
       .value = "FILE or FILE:ATTRIBUTE",
       .require = require_canopies},
      {.name = "leaf_area_density",
       .member = &C::leaf_area_density,
       .help = "One-sided area of leaves per volume of canopies that have no attribute of this "
               "name",
       .unit = "1/m",
       .min = 0,
       .max = 20,
       .above_min = true},
      {.name = "target_cells",
       .member = &C::target_cells,
       .help = "Scale mesh_size, far_size, ground_size and refine alike until the mesh has about "
               "so many cells; 0: sizes are as given",
       .min = 0,
       .max = 1e10},
      {.name = "min_angle",
       .member = &C::min_angle,
       .help = "Minimum angle of ground triangles, where the footprints allow it",
       .unit = "degrees",
       .min = 0,
       .max = 30},
      {.name = "domain_height",
       .member = &C::domain_height,
       .help = "Height of the domain above the highest ground; at least two mesh sizes (uniform: "
               "layers) above the highest roof. 0: 100 m; with any domain but data 5 times the "
               "tallest building above the highest roof",
       .unit = "m",
       .common = true,
       .min = 0,
       .max = 1e5},
      {.name = "cells",
       .member = choice<&C::cells>(),
       .help =
           "Tets, or prisms alone: layers that all columns share, on boundary_layers (5 if that "
           "is 0); roofs are flat. Tets where terrain is steeper than 36 degrees on 5 % of it",
       .choices = {"tets", "prisms"}},
      {.name = "layering",
       .member = choice<&C::layering>(),
       .help = "Spacing of nodes: graded by the triangles around each column, or equal layers "
               "moved by two Laplace problems",
       .choices = {"graded", "uniform"}},
      {.name = "layer_height",
       .member = &C::layer_height,
       .help = "Uniform: mean height of layers, 0: the mesh size. Graded: largest spacing (cells "
               "may be half as high again), and all columns go on to the top: several times the "
               "cells; 0: no limit",
       .unit = "m",
       .min = 0,
       .max = 1e5},
      {.name = "boundary_layers",
       .member = &C::boundary_layers,
       .help = "Layers of prisms over open ground, below the tets; thinner at low walls",
       .min = 0,
       .max = 100},
      {.name = "first_layer",
       .member = &C::first_layer,
       .help = "Height of the lowest of boundary_layers",
       .unit = "m",
       .min = 0.001,
       .max = 100},
      {.name = "layer_growth",
       .member = &C::layer_growth,
       .help = "Ratio of the height of each of boundary_layers to that of the one below",
       .min = 1,
       .max = 2},
      {.name = "top",
       .member = choice<&C::top>(),
       .help = "Top of the domain: flat, or free to follow the terrain",
       .choices = {"flat", "free"}},
      {.name = "min_wall_height",
       .member = &C::min_wall_height,
       .help = "Minimum height of a wall (prisms: 2 at least); where the terrain leaves less, the "
               "ground at the wall is lowered",
       .unit = "m",
       .min = 0.01,
       .max = 1000},
      {.name = "cut_slope",
       .member = &C::cut_slope,
       .help = "Gentlest slope to excavate terrain to where cells would otherwise be poor (75 and "
               "66 degrees are tried first); 90: never",
       .unit = "degrees",
       .min = 30,
       .max = 90},
      {.name = "min_gap_share",
       .member = &C::min_gap_share,
       .help = "Uniform: minimum vertical edge of a cell, as a share of the even spacing",
       .min = 0.001,
       .max = 0.9},
      {.name = "solver_tolerance",
       .member = &C::solver_tolerance,
       .help = "Uniform layering or free top: error, relative to the first guess, at which "
               "smoothing stops",
       .min = 1e-6,
       .max = 0.5},
      {.name = "solver_iterations",
       .member = &C::solver_iterations,
       .help = "Uniform layering or free top: maximum number of iterations per smoothing",
       .min = 1,
       .max = 100000}};
}

std::vector<ConfigField> synthetic_city_fields() {
  using C = Config;
  return {
      {.name = "kind",
       .member = choice<&C::kind>(),
       .help = "Random rectangles as in the paper, a street grid with blocks, park and river, or a "
               "village with a mix of defects",
       .common = true,
       .choices = {"random", "blocks", "adversarial"}},
      {.name = "buildings",
       .member = &C::buildings,
       .help = "Number of buildings; 0: as dense as 3096 on 2500 m (random), or as many as fit "
               "(blocks); not for adversarial cities",
       .common = true,
       .min = 0,
       .max = 1e7},
      {.name = "size",
       .member = &C::size,
       .help =
           "Side of the square; 0: 2500 m (random, at least 50 m), 500 m (blocks, at least 300 m) "
           "or 200 m (adversarial, 100 to 1000 m)",
       .unit = "m",
       .common = true,
       .min = 0,
       .max = 1e5},
      {.name = "seed",
       .member = &C::seed,
       .help = "Seed of the random numbers",
       .common = true,
       .min = 0,
       .max = std::numeric_limits<int>::max()},
      {.name = "point_density",
       .member = &C::point_density,
       .help = "Points per square metre",
       .unit = "1/m2",
       .common = true,
       .min = 0.01,
       .max = 1000},
      {.name = "relief",
       .member = &C::relief,
       .help = "Height of the hills; 0: flat; negative: the kind's own",
       .unit = "m",
       .common = true,
       .min = -1,
       .max = 2000},
      {.name = "roofs",
       .member = choice<&C::roofs>(),
       .help = "Level roofs, or gables, hips, sheds, mansards, steps, dormers and towers (blocks), "
               "whose planes truth.city.json has",
       .choices = {"flat", "sloped"}},
      {.name = "defects",
       .member = &C::defects,
       .help =
           "Exactly these defects (adversarial; see docs/quality.md); default: a mix drawn from "
           "the seed",
       .value = "NAME,..."}};
}

std::vector<ConfigField> run_fields() {
  using C = Config;
  return {{.name = "max_memory",
           .member = &C::max_memory,
           .commands = kData | kMesh,
           .help = "Limit, such as 8G or 500M; points and meshes that would need more are refused; "
                   "default: 90 % of what the machine and the limits of the process leave",
           .value = "SIZE",
           .require = require_size},
          {.name = "threads",
           .member = &C::threads,
           .help = "Threads; 0: one per core. Results do not depend on it",
           .min = 0,
           .max = 4096},
          {.name = "quiet", .member = &C::quiet, .help = "Print errors only", .letter = 'q'},
          {.name = "verbose",
           .member = &C::verbose,
           .commands = kAll,
           .help = "Print every step, by the numbers of the paper",
           .letter = 'v',
           .common = true},
          {.name = "log",
           .member = &C::log,
           .help = "Write what is printed, and every step, to this file, too",
           .value = "FILE"}};
}

std::vector<ConfigField> make_fields() {
  struct Group {
    std::string_view name;
    unsigned commands;  ///< Of fields that name none.
    std::vector<ConfigField> fields;
  };
  std::vector<ConfigField> all;
  for (Group& group : std::vector<Group>{{"Input", kData, input_fields()},
                                         {"Output", kMeshes, output_fields()},
                                         {"City model", kData, city_model_fields()},
                                         {"Mesh", kMeshes, mesh_fields()},
                                         {"Synthetic city", kSynth, synthetic_city_fields()},
                                         {"Run", kAll | kCheck, run_fields()}}) {
    for (ConfigField& field : group.fields) {
      field.group = group.name;
      if (field.commands == 0) field.commands = group.commands;
      all.push_back(std::move(field));
    }
  }
  return all;
}

}  // namespace

std::span<const ConfigField> config_fields() {
  static const std::vector<ConfigField> fields = make_fields();
  return fields;
}

const ConfigField* find_field(std::string_view name) {
  for (const ConfigField& field : config_fields())
    if (field.name == name) return &field;
  return nullptr;
}

}  // namespace tetropolis
