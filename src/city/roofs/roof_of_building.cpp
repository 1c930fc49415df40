#include "city/roofs/roof_of_building.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "city/roofs/clear_lines.h"
#include "city/roofs/detect_planes.h"
#include "city/roofs/flatten_misfits.h"
#include "city/roofs/region_points.h"
#include "city/roofs/trace_lines.h"
#include "core/infinity.h"
#include "core/parallel.h"

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
  std::vector<std::vector<DetectedPlane>> detected(input.members.size());
  if (options.lod != Lod::k1_2)
    parallel_chunks(detected.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t m = begin; m < end; ++m)
        if (input.sources[m] != RoofSource::kLevel)
          detected[m] = detect_planes(input.points[m], input.density(m));
    });
  const bool is_one_region = detected.size() == 1 && detected.front().size() <= 1;
  RoofFindings found{make_roof_cells(input, is_one_region ? kInfinity : kCell), {}};
  found.planes = choose_planes(input, found.cells, detected, label_options(options));
  return found;
}

FinishedRoof roof_of_building(const RoofInput& input, const RoofFindings& found,
                              const RoofOptions& options, double fallback_height, double lowest) {
  constexpr double kCap = 3;  // metres
  const RoofCells& cells = found.cells;
  LabelOptions label = label_options(options);
  label.fallback_height = fallback_height;
  const RoofRegions regions = label_cells(input, cells, found.planes, label);
  Partition lines = trace_lines(input.footprint, cells, regions, options.clearance);
  RegionPoints points = region_points(input, cells, regions, options.percentile, kCap);
  ClearLinesOptions clear;
  clear.clearance = options.clearance + kForRounding;
  clear.min_area = options.min_area + kForRounding;
  clear.polish = options.lod != Lod::k1_2;
  clear_lines(lines, points, clear);
  const FinishOptions finish{options.percentile, lowest};
  FinishedRoof roof = finish_parts(input, lines, points, finish);
  // As where lines had no room.
  if (flatten_misfits(roof, lines, points)) {
    FinishedRoof flatter = finish_parts(input, lines, points, finish);
    if (flatter.misfit() < roof.misfit()) roof = std::move(flatter);
  }
  return roof;
}

}  // namespace tetropolis
