// Cells of leaves, told to a model of OpenFOAM that looks for cells below a surface. Private to
// src/case.
#pragma once

#include <string>
#include <vector>

#include "foam_mesh.h"

namespace tetropolis {

/// How far a mark is above the centre of its cell [m]: less than any other centre.
inline constexpr double kMarkHeight = 0.0005;

/// A leaf area density [1/m], and the marks of all cells that have it: a surface (OBJ) of one tiny
/// triangle right above each centre.
struct LeafMarks {
  double leaf_area_density = 0;
  std::string surface;
};

/// Per density, ascending. Centres are as OpenFOAM has them: means of the pyramids over the faces.
std::vector<LeafMarks> mark_leaves(const FoamMesh& mesh);

}  // namespace tetropolis
