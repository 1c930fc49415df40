// Where mesh files put a mesh.
#pragma once

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// Where files put a mesh: the coordinates written are local coordinates plus `shift`; the position
/// of their zero in the reference system, `origin`, is stored beside them as field data.
struct Placement {
  Point3 shift{0, 0, 0};
  Point3 origin{0, 0, 0};
};

}  // namespace tetropolis
