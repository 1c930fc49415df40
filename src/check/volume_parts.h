// The parts of check_volume.
#pragma once

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
