#include "leaf_marks.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

#include "geometry/vec3.h"

namespace tetropolis {

namespace {

/// A cell while its faces come by.
struct Cell {
  Point3 middle{};  ///< Sum of the centres of its faces, then their mean.
  double faces = 0;
  Point3 moment{};
  double volume = 0;
};

std::unordered_map<std::int32_t, Cell> cells_of(const FoamMesh& mesh) {
  std::unordered_map<std::int32_t, Cell> cells;
  for (const FoamCanopy& canopy : mesh.canopies)
    for (const std::int32_t cell : canopy.cells) cells[cell];
  // Calls visit(cell, face) for both sides of each face.
  const auto for_each_side = [&](const auto& visit) {
    for (std::size_t f = 0; f < mesh.faces(); ++f) {
      const auto owner = cells.find(mesh.owner[f]);
      const auto neighbour =
          f < mesh.neighbour.size() ? cells.find(mesh.neighbour[f]) : cells.end();
      if (owner == cells.end() && neighbour == cells.end()) continue;
      const FaceGeometry face = face_geometry(mesh, f);
      if (owner != cells.end()) visit(owner->second, face);
      if (neighbour != cells.end()) visit(neighbour->second, face);
    }
  };
  for_each_side([](Cell& cell, const FaceGeometry& face) {
    for (std::size_t c = 0; c < 3; ++c) cell.middle[c] += face.centre[c];
    ++cell.faces;
  });
  for (auto& [number, cell] : cells)
    for (double& x : cell.middle) x /= cell.faces;
  for_each_side([](Cell& cell, const FaceGeometry& face) {
    // Cells are convex enough for all pyramids to be positive.
    const double volume = std::abs(dot(face.area, minus(face.centre, cell.middle))) / 3;
    cell.volume += volume;
    for (std::size_t c = 0; c < 3; ++c)
      cell.moment[c] += volume * (0.75 * face.centre[c] + 0.25 * cell.middle[c]);
  });
  return cells;
}

}  // namespace

std::vector<LeafMarks> mark_leaves(const FoamMesh& mesh) {
  if (mesh.canopies.empty()) return {};
  const std::unordered_map<std::int32_t, Cell> cells = cells_of(mesh);
  std::map<double, std::vector<std::int32_t>> by_density;
  for (const FoamCanopy& canopy : mesh.canopies) {
    std::vector<std::int32_t>& same = by_density[canopy.leaf_area_density];
    same.insert(same.end(), canopy.cells.begin(), canopy.cells.end());
  }
  std::vector<LeafMarks> marks;
  for (const auto& [density, numbers] : by_density) {
    std::string text = "# a mark over each cell of leaves\n";
    const auto out = std::back_inserter(text);
    for (const std::int32_t number : numbers) {
      const Cell& cell = cells.at(number);
      Point3 centre{};
      for (std::size_t c = 0; c < 3; ++c) centre[c] = cell.moment[c] / cell.volume;
      constexpr std::array<std::array<double, 2>, 3> kCorners = {{{-2, -1}, {2, -1}, {0, 2}}};
      for (const auto& [x, y] : kCorners)
        fmt::format_to(out, "v {:.12g} {:.12g} {:.12g}\n", centre[0] + x * kMarkHeight,
                       centre[1] + y * kMarkHeight, centre[2] + kMarkHeight);
    }
    for (std::size_t i = 0; i < numbers.size(); ++i)
      fmt::format_to(out, "f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    marks.push_back({density, std::move(text)});
  }
  return marks;
}

}  // namespace tetropolis
