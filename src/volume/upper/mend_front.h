// Has the front climb again where cells came below the floor of quality.
#pragma once

#include "front.h"

namespace tetropolis {

/// Where columns of `phases` are poor they climb again with shorter segments, a few times, and so
/// do those that this changes something for: all is as if every column had climbed with these
/// segments. The last time stands, whatever it is like elsewhere. Precondition: `phases` are of
/// climb.to_top() with shares of 1.
void mend_front(const ColumnMesh& mesh, double top, FrontClimb& climb, FrontPhases& phases);

}  // namespace tetropolis
