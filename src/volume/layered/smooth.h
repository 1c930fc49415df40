// Steps 3.2 to 3.5: layering, smoothing to the ground, trimming, smoothing to the roofs.
#pragma once

#include <cstdint>
#include <span>

#include "tetropolis/core/progress.h"

#include "laplace.h"
#include "layered_mesh.h"
#include "monotone.h"

namespace tetropolis {

struct SmoothOptions {
  LaplaceOptions laplace;
  double gap_share = 0.25;  ///< See MonotoneOptions.
};

struct SmoothReport {
  SolverReport solver;
  MonotoneReport guard;
};

/// Step 3.3. Moves the evenly layered, untrimmed `mesh` so that layer 0 is at `ground` (per vertex)
/// and the displacement in between is harmonic; afterwards every column is monotone.
SmoothReport smooth_to_ground(LayeredMesh& mesh, std::span<const double> ground,
                              const SmoothOptions& options, const Progress& progress = {});

/// Step 3.4. Gives every building the layer its roof is cut at, and with it first_layer, first_node
/// and roof_layer. The layer is the one nearest to the roof, in the sense that the least and the
/// greatest wall height both come closest to whole layers (in ratio); at least 1, at most K - 1.
/// `lowest_roof` as from lowest_roofs; `roofs`: elevation per building part. Precondition: roofs
/// are above the ground layer at all their vertices. Throws Error(kGuarantee) naming the vertex if
/// two roofs end at one: a column of layers has one.
void trim(LayeredMesh& mesh, std::span<const RegionIndex> lowest_roof,
          std::span<const double> roofs);

/// Step 3.5. Moves the trimmed mesh so that every roof is at its exact elevation, ground and top
/// stay where they are, and the displacement is harmonic; afterwards every column is monotone.
SmoothReport smooth_to_roofs(LayeredMesh& mesh, std::span<const RegionIndex> lowest_roof,
                             std::span<const double> roofs, const SmoothOptions& options,
                             const Progress& progress = {});

}  // namespace tetropolis
