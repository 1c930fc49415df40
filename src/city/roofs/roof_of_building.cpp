#include "city/roofs/roof_of_building.h"

#include "city/roofs/clear_lines.h"
#include "city/roofs/region_points.h"
#include "city/roofs/trace_lines.h"

namespace tetropolis {

namespace {

LabelOptions label_options(const RoofOptions& options) {
  LabelOptions label;
  label.lod = options.lod;
  label.percentile = options.percentile;
  label.min_area = options.min_area;
  return label;
}

}  // namespace

RoofFindings find_planes(const RoofInput& input, const RoofOptions& options) {
  constexpr double kCell = 0.5;  // metres
  RoofFindings found{make_roof_cells(input, kCell), {}};
  found.planes = choose_planes(input, found.cells, label_options(options));
  return found;
}

FinishedRoof roof_of_building(const RoofInput& input, const RoofFindings& found,
                              const RoofOptions& options, double fallback_height, double lowest) {
  constexpr double kCap = 3;         // metres
  constexpr double kForSnap = 5e-4;  // metres that snapping may bring lines closer
  const RoofCells& cells = found.cells;
  LabelOptions label = label_options(options);
  label.fallback_height = fallback_height;
  const RoofRegions regions = label_cells(input, cells, found.planes, label);
  TraceOptions trace;
  trace.reach = options.clearance;
  Partition lines = trace_lines(input.footprint, cells, regions, trace);
  RegionPoints points = region_points(input, cells, regions, options.percentile, kCap);
  ClearLinesOptions clear;
  clear.clearance = options.clearance + kForSnap;
  clear.min_area = options.min_area + kForSnap;
  clear.polish = options.lod != Lod::k1_2;
  clear_lines(lines, points, clear);
  return finish_parts(input, lines, points, {options.percentile, lowest});
}

}  // namespace tetropolis
