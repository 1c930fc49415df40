// The street plan of the synthetic block city: quarters between avenues, blocks between streets.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"
#include "tetropolis/synth/synthetic_city.h"

namespace tetropolis {

enum class QuarterKind {
  kPerimeter,  ///< Blocks with buildings all around.
  kModern,     ///< Towers and slabs on lawns.
  kVillas,     ///< Free-standing houses with sheds.
  kPark,       ///< Trees only.
};

/// A convex piece of land between avenues, the river and the margin.
struct Quarter {
  Ring ring;    ///< Counter-clockwise.
  Point2 axis;  ///< Unit vector along its streets.
  QuarterKind kind = QuarterKind::kPerimeter;
};

/// A convex piece of land between streets, of the kind of its quarter.
struct Block {
  Ring ring;  ///< Counter-clockwise.
  Point2 axis;
  QuarterKind kind = QuarterKind::kPerimeter;
};

struct StreetPlan {
  SyntheticTerrain terrain;
  std::vector<Quarter> quarters;  ///< From the centre outwards.
  std::vector<Block> blocks;      ///< Parks are one block each.
  std::vector<double> crossings;  ///< Abscissae at which bridges cross the river.
};

/// Depends on size, seed, relief and margin of the options only.
StreetPlan plan_streets(const BlockCityOptions& options);

}  // namespace tetropolis
