#include "tetropolis/check/check_volume.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "core/parallel.h"
#include "core/ragged_builder.h"
#include "edges.h"
#include "geometry/square_grid.h"
#include "vector3.h"
#include "violations.h"
#include "volume_parts.h"

namespace tetropolis {

namespace {

/// Pairs of vertices at the same place, the second of each ascending.
std::vector<std::pair<std::int64_t, std::int64_t>> coincident_vertices(const TetMesh& mesh) {
  const SquareGrid grid(box_of(mesh.points), mesh.points.size() / 8);
  const RaggedArray<std::uint32_t> filed =
      file_under_rows(mesh.points.size(), grid.size(), [&](std::size_t v, const auto& use) {
        if (is_finite(mesh.points[v])) use(grid.at(mesh.points[v]));
      });
  using Pairs = std::vector<std::pair<std::int64_t, std::int64_t>>;
  Pairs pairs = parallel_reduce_ordered(
      filed.size(), 2048, Pairs{},
      [&](std::size_t begin, std::size_t end) {
        Pairs part;
        std::vector<std::pair<std::array<double, 3>, std::int64_t>> row;
        for (std::size_t r = begin; r < end; ++r) {
          row.clear();
          for (const std::uint32_t v : filed[r]) {
            const auto& p = mesh.points[v];
            row.push_back({{p[2], p[0], p[1]}, v});  // elevations tell most of them apart
          }
          std::sort(row.begin(), row.end());
          for (std::size_t i = 1; i < row.size(); ++i)
            if (row[i].first == row[i - 1].first)
              part.emplace_back(row[i - 1].second, row[i].second);
        }
        return part;
      },
      [](Pairs a, const Pairs& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  return pairs;
}

}  // namespace

void check_vertices(const TetMesh& mesh, const std::vector<std::uint8_t>& used,
                    VolumeCheck& check) {
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto place = [&] { return fmt::format("vertex {}", v); };
    if (used[v] == 0) note_violation(check.violations, "vertices without cells", place);
    if (!is_finite(mesh.points[v])) note_violation(check.violations, kCoordinatesNotFinite, place);
  }
  for (const auto& [a, b] : coincident_vertices(mesh))
    note_violation(check.violations, "coincident vertices",
                   [&, a = a, b = b] { return fmt::format("vertices {} and {}", a, b); });
}

void check_boundary(VolumeCheck& check) {
  std::vector<std::array<std::int64_t, 3>> triangles = check.boundary;
  for (const auto& [a, b, c, d] : check.boundary_quads) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  add_violations(
      check.violations,
      look_at_edges(
          triangles, static_cast<std::size_t>(check.vertices),
          [](std::int64_t low, std::span<const EdgeUse> uses, std::vector<Violation>& violations) {
            if (uses.size() == 2 && uses[0].forward != uses[1].forward) return;
            note_violation(
                violations, uses.size() < 2 ? "open boundary edges" : "non-manifold boundary edges",
                [&] { return fmt::format("edge between vertices {} and {}", low, uses[0].high); });
          }));
}

VolumeCheck check_volume(const TetMesh& mesh, const Progress& progress) {
  VolumeCheck check;
  check.vertices = static_cast<std::int64_t>(mesh.points.size());
  check.cells = static_cast<std::int64_t>(mesh.cell_count());
  if (mesh.points.size() > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kInput,
                "a mesh of more than 2^32 vertices can only be checked in parts");
  if (mesh.cell_count() == 0)
    note_violation(check.violations, "no cells", [] { return "the file"; });
  progress.update(0);
  std::vector<std::uint8_t> used = measure_cells(mesh, check);
  measure_wedges(mesh, used, check);
  progress.update(0.3);
  check_vertices(mesh, used, check);
  progress.update(0.4);
  match_faces(mesh, check, progress);
  check_boundary(check);
  return check;
}

}  // namespace tetropolis
