#include "mesh_warnings.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace tetropolis {

namespace {

/// What cells of the mesh miss; nothing if it is above the floor.
std::optional<Asked> missed(const MeshQuality& quality) {
  const QualityHistogram& angles = quality.cells.histogram;
  if (angles.dihedral_quantile_deg(kShareOfFew) < kLeastOfMost) return Asked::kOfMost;
  if (angles.min_dihedral_deg() < kQualityFloor.least ||
      angles.max_dihedral_deg() > kQualityFloor.greatest || quality.faces.above_70 > 0)
    return Asked::kFloor;
  return std::nullopt;
}

/// The settings that alone make bad cells, if there are any. `scale`: of the mesh size given.
std::string unusual_settings(const MeshCityOptions& options, double scale) {
  std::string text;
  if (options.layering == Layering::kUniform) text += "; layering = \"graded\" gives better ones";
  if (options.min_angle_deg < 20)
    text += fmt::format("; min_angle {:g} is small", options.min_angle_deg);
  const double share = options.layer_height / options.mesh_size;
  // Graded layers take a large height as an upper limit only.
  const bool tall = share > 2 && options.layering == Layering::kUniform;
  if (options.layer_height > 0 && (share < 0.5 || tall))
    text += fmt::format(
        "; layer_height {:g} is far from mesh_size {:.3g}{}; layer_height = 0 follows it",
        options.layer_height, options.mesh_size,
        scale == 1 ? ""
                   : fmt::format(" ({:g}, which target_cells multiplied by {:.3g})",
                                 options.mesh_size / scale, scale));
  return text;
}

}  // namespace

void warn_of_lowered_ground(const ColumnPlan& plan, const ExcavationSources& excavated,
                            std::vector<Warning>& warnings) {
  if (plan.lowered == 0) return;
  std::string where = "at walls that would be too low otherwise";
  if (const std::size_t roofs = excavated.roofs.size(); roofs > 0)
    where += fmt::format("; around {} roof{} below the terrain", roofs, roofs == 1 ? "" : "s");
  if (const std::size_t toes = excavated.toes.size(); toes > 0)
    where += fmt::format("; at the toes of cliffs or low walls, in {} place{}", toes,
                         toes == 1 ? "" : "s");
  if (plan.undermined > 0)
    where += fmt::format("; {} building{} there, by up to {:.1f} m", plan.undermined,
                         plan.undermined == 1 ? " has its foot above the ground that is now"
                                              : "s have their foot above the ground that is now",
                         plan.deepest_undermined);
  if (!excavated.roofs.empty() || !excavated.toes.empty())
    where += "; cut_slope = 90 keeps the terrain, with worse cells instead";
  warnings.push_back({"ground_lowered", plan.lowered,
                      fmt::format("{} ground vertices were lowered, by up to {:.1f} m: {}",
                                  plan.lowered, plan.deepest, where)});
}

void warn_of_canopies(const CellZones& zones, std::vector<Warning>& warnings) {
  std::int64_t empty = 0;
  std::string first;
  for (const CellZone& zone : zones.zones)
    if (zone.cells == 0 && ++empty == 1) first = zone.name;
  if (empty > 0)
    warnings.push_back(
        {"canopy_without_cells", empty,
         fmt::format("{} canopies have no cell, the first, {}: they are smaller than "
                     "cells, over buildings or outside the domain; refine there",
                     empty, first)});
}

void warn_of_prisms(const PrismQuality& prisms, std::vector<Warning>& warnings) {
  if (prisms.above_70 > 0)
    warnings.push_back(
        {"prisms_sheared", prisms.above_70,
         fmt::format(
             "{} faces of prisms are more than 70 degrees non-orthogonal ({:.1f} at most), on "
             "steep ground or at walls; a lower cut_slope or layer_growth, or fewer "
             "boundary_layers may help",
             prisms.above_70, prisms.max_non_orthogonality_deg)});
  if (prisms.max_skewness >= kMostSkewed)
    warnings.push_back(
        {"prisms_skewed", 1,
         fmt::format("a face of a prism, or more, has a skewness of {:.2f}, where less than {} is "
                     "meant for all, on steep ground or at walls; a lower cut_slope, or fewer "
                     "boundary_layers may help",
                     prisms.max_skewness, kMostSkewed)});
}

void warn_below_floor(const MeshCityOptions& options, double scale, const MeshQuality& quality,
                      std::vector<Warning>& warnings) {
  const std::optional<Asked> asked = missed(quality);
  if (const double skewness = quality.faces.worst.skewness; skewness >= kMostSkewed)
    warnings.push_back({"faces_skewed", 1,
                        fmt::format("a face, or more, has a skewness of {:.2f}, where less than {} "
                                    "is meant for all; a smaller mesh_size may help",
                                    skewness, kMostSkewed)});
  if (!asked) return;
  const QualityHistogram& angles = quality.cells.histogram;
  const AngleBounds& bounds = kAskedBounds[static_cast<std::size_t>(*asked)];
  if (const std::int64_t bad = quality.faults.cells_outside(*asked); bad > 0)
    warnings.push_back(
        {"below_quality_floor", bad,
         fmt::format(
             "{} cells have dihedral angles outside of {} to {} degrees (least {:.2f}, greatest "
             "{:.2f}), where {} to {} are meant for all and {} for all but one in ten thousand; "
             "worst_cells in the report has the worst and why{}",
             bad, bounds.least, bounds.greatest, angles.min_dihedral_deg(),
             angles.max_dihedral_deg(), kQualityFloor.least, kQualityFloor.greatest, kLeastOfMost,
             unusual_settings(options, scale))});
  if (quality.faces.above_70 > 0)
    warnings.push_back(
        {"faces_non_orthogonal", quality.faces.above_70,
         fmt::format(
             "{} faces between cells are more than {} degrees non-orthogonal (the worst "
             "{:.2f}), at steep ground, buried roofs or, in uniform layers, low walls; a smaller "
             "mesh_size may help{}",
             quality.faces.above_70, kMostNonOrthogonal, quality.faces.worst.non_orthogonality_deg,
             unusual_settings(options, scale))});
}

}  // namespace tetropolis
