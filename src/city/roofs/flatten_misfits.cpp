#include "city/roofs/flatten_misfits.h"

#include <cstddef>

namespace tetropolis {

bool flatten_misfits(const FinishedRoof& roof, Partition& lines, RegionPoints& points) {
  const auto is_misfit = [&](RoofRegion r) {
    return r != Partition::kOutside &&
           roof.misfit(static_cast<std::size_t>(points.roof(r).member)) > 0;
  };
  bool any = false;
  for (const auto& [region, area] : lines.areas())
    if (is_misfit(region)) any = points.flatten(region) || any;
  if (!any) return false;
  for (Partition::EdgeId e = 0; e < lines.edges().size(); ++e) {
    const Partition::Edge edge = lines.edge(e);
    if (!edge.alive || edge.is_outline() || edge.left == edge.right || !is_misfit(edge.left) ||
        points.roof(edge.left).member != points.roof(edge.right).member)
      continue;
    lines.merge(edge.left, edge.right);
    points.merge(edge.left, edge.right);
  }
  return true;
}

}  // namespace tetropolis
