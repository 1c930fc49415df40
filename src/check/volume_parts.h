// The parts of check_volume.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tetropolis/check/check_volume.h"

namespace tetropolis {

/// Volume and shape of every cell. Returns for each vertex whether a cell has it.
std::vector<std::uint8_t> measure_cells(const TetMesh& mesh, VolumeCheck& check);

/// Vertices without cells, coordinates that are not finite, vertices at the same place (they would
/// hide cracks).
void check_vertices(const TetMesh& mesh, const std::vector<std::uint8_t>& used, VolumeCheck& check);

/// What is added up over the faces between two cells; skewness also over those on the boundary.
struct FaceSums {
  std::int64_t faces = 0, above_70 = 0;
  double cosines = 0;
  double least_cosine = 1;
  double skewness = 0;

  void add_cosine(double cosine);
};

/// A face of a prism, outward, its lowest vertex first.
struct WedgeTriangle {
  std::array<std::int64_t, 3> corners;
  std::size_t wedge;
  std::array<double, 3> centre;  ///< Of the prism.
};

/// Shape of every prism; marks its vertices as used.
void measure_wedges(const TetMesh& mesh, std::vector<std::uint8_t>& used, VolumeCheck& check);

std::vector<WedgeTriangle> wedge_triangles(const TetMesh& mesh);

/// Matches the quadrilaterals of prisms.
void match_quads(const TetMesh& mesh, FaceSums& sums, VolumeCheck& check);

std::string place_of_wedge(const TetMesh& mesh, std::size_t wedge);

/// Matches faces: one or two cells each, two on different sides; shape of those with two cells.
void match_faces(const TetMesh& mesh, VolumeCheck& check, const Progress& progress);

/// Every edge of check.boundary has two faces, which run along it in opposite directions.
void check_boundary(VolumeCheck& check);

/// "cell 17 at (1.0, 2.0, 3.0)".
std::string place_of(const TetMesh& mesh, std::size_t cell);

/// The least values that at least these shares, of [0, 1], of `values` do not exceed; `values` are
/// not negative.
std::vector<double> values_at(const std::vector<float>& values, const std::vector<double>& shares);

}  // namespace tetropolis
