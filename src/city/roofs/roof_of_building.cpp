#include "city/roofs/roof_of_building.h"

#include "city/roofs/clear_lines.h"
#include "city/roofs/label_cells.h"
#include "city/roofs/region_points.h"
#include "city/roofs/roof_cells.h"
#include "city/roofs/trace_lines.h"

namespace tetropolis {

FinishedRoof roof_of_building(const RoofInput& input, const RoofOptions& options,
                              double fallback_height, double lowest) {
  constexpr double kCell = 0.5;      // metres
  constexpr double kCap = 3;         // metres
  constexpr double kForSnap = 5e-4;  // metres that snapping may bring lines closer
  const RoofCells cells = make_roof_cells(input, kCell);
  LabelOptions label;
  label.lod = options.lod;
  label.percentile = options.percentile;
  label.fallback_height = fallback_height;
  label.min_area = options.min_area;
  const RoofRegions regions = label_cells(input, cells, label);
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
