#include "ladder.h"

#include <algorithm>

namespace tetropolis {

std::vector<double> make_ladder(double bottom, double roofs, double top,
                                const LadderSpacing& spacing) {
  std::vector<double> z{bottom};
  double height = std::min(spacing.first, (top - bottom) / 2);
  while (z.back() < top) {
    z.push_back(z.back() + height);
    const double most = z.back() < roofs ? spacing.canopy : spacing.far;
    height = std::max(std::min(height * spacing.growth, most), std::min(height, most));
  }
  // The last one is beyond the top: it stays if the one before is further away.
  if (z.size() > 3 && top - z[z.size() - 2] < z.back() - top) z.pop_back();
  const double stretch = (top - bottom) / (z.back() - bottom);
  for (double& level : z) level = bottom + stretch * (level - bottom);
  z.back() = top;
  return z;
}

}  // namespace tetropolis
