// Types of cells as VTK numbers them, and corners of prisms. Private to src/io.
#pragma once

#include <array>
#include <cstdint>

namespace tetropolis {

/// SU2 has the same.
inline constexpr std::uint8_t kVtkTriangle = 5, kVtkQuad = 9, kVtkTetra = 10, kVtkWedge = 13;

/// From wedge()'s order to VTK's and back: there the base, seen from the other triangle, runs
/// clockwise. Source: VTK's documentation of vtkWedge.
template <typename Node>
std::array<Node, 6> in_vtk_order(const std::array<Node, 6>& prism) {
  return {prism[0], prism[2], prism[1], prism[3], prism[5], prism[4]};
}

/// Tets are the same in both.
template <typename Node>
const std::array<Node, 4>& in_vtk_order(const std::array<Node, 4>& tet) {
  return tet;
}

}  // namespace tetropolis
