#include "describe_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace tetropolis {

namespace {

double percent(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

CheckedFile describe(const std::string& name, const VolumeCheck& check) {
  CheckedFile file{name, {}, check.violations, {}};
  const Distribution& angle = check.min_dihedral_deg;
  file.facts = {
      check.prisms.cells == 0
          ? fmt::format("{} vertices, {} tets, {} inverted", check.vertices, check.cells,
                        check.inverted)
          : fmt::format("{} vertices, {} tets, {} prisms, {} inverted", check.vertices,
                        check.cells - check.prisms.cells, check.prisms.cells, check.inverted),
      fmt::format("volume {:.3f} m3, {} boundary faces", check.volume, check.boundary_faces),
      fmt::format("dihedral angles: least {:.2f}, 0.01 % {:.2f}, 0.1 % {:.2f}, 1 % {:.2f}, median "
                  "of least {:.2f}, "
                  "greatest {:.2f} degrees",
                  angle.min, angle.p0_01, angle.p0_1, angle.p1, angle.median,
                  check.max_dihedral_deg),
      fmt::format("cells below {} degrees: {} ({:.4f} %)", kSliverDihedralDeg, check.slivers,
                  percent(check.slivers, check.cells - check.prisms.cells)),
      fmt::format("{} faces between cells: non-orthogonality mean {:.2f}, greatest {:.2f} degrees, "
                  "{} above 70; skewness of all faces at most {:.2f}",
                  check.faces.internal, check.faces.mean_non_orthogonality_deg,
                  check.faces.max_non_orthogonality_deg, check.faces.above_70,
                  check.faces.max_skewness),
      fmt::format("aspect ratio: median {:.2f}, 99 % {:.2f}, greatest {:.2f}",
                  check.aspect_ratio.median, check.aspect_ratio.p99, check.aspect_ratio.max)};
  if (check.prisms.cells > 0)
    file.facts.push_back(
        fmt::format("prisms: aspect ratio at most {:.2f}, flatness of faces at "
                    "least {:.6f}",
                    check.prisms.max_aspect_ratio, check.prisms.least_flatness));
  return file;
}

CheckedFile describe(const std::string& name, const SurfaceCheck& check) {
  CheckedFile file{name, {}, check.violations, {}};
  std::string patches;
  for (const auto& [patch, faces] : check.faces_by_patch)
    patches += fmt::format("{}{} {}", patches.empty() ? "" : ", ", patch, faces);
  file.facts = {
      fmt::format("{} triangles, {}{}, {}", check.triangles,
                  check.quads == 0 ? "" : fmt::format("{} quadrilaterals, ", check.quads),
                  check.closed ? "closed" : "open", check.manifold ? "manifold" : "not manifold"),
      check.enclosed_volume == 0 ? fmt::format("area {:.3f} m2", check.area)
                                 : fmt::format("encloses {:.3f} m3", check.enclosed_volume),
      "faces: " + patches};
  return file;
}

double joint_clearance_of(const CityCheck& check) {
  return std::min(check.min_clearance, check.domain_distance);
}

CheckedFile describe(const std::string& name, const CityCheck& check,
                     std::optional<double> min_distance) {
  CheckedFile file{name, {}, check.violations, {}};
  file.facts = {fmt::format("{} buildings, {} dropped features, {:.1f} m2", check.buildings,
                            check.dropped, check.area)};
  if (check.parts > 0) file.facts.push_back(fmt::format("{} parts with roofs", check.parts));
  if (std::isfinite(check.part_clearance))
    file.facts.push_back(fmt::format("lines of parts {:.6f} m apart", check.part_clearance));
  if (min_distance && std::isfinite(joint_clearance_of(check)))
    file.facts.push_back(
        fmt::format("clearance {:.6f} m, {} m asked", joint_clearance_of(check), *min_distance));
  return file;
}

}  // namespace tetropolis
