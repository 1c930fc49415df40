// Prisms as tets, for pictures.
#pragma once

#include "tetropolis/volume/tet_mesh.h"

namespace tetropolis {

/// The mesh with three tets instead of each prism, which meet those of its neighbours face to face;
/// their regions behind those of the others.
TetMesh split_prisms(TetMesh mesh);

}  // namespace tetropolis
