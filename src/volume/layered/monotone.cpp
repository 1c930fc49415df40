#include "monotone.h"

#include <algorithm>
#include <string>

#include "tetropolis/core/error.h"

#include "core/infinity.h"
#include "core/parallel.h"

namespace tetropolis {

namespace {

/// Of a ladder's spacing between ground and roof: with less, where a wall is low for the layers up
/// to its roof, some would be slivers that lie beside thick ones.
constexpr double kShareAtWalls = 0.9;

/// Nodes [first, last] of one column; z[first] is fixed, z[last] too if `fixed_end`. gap(k): least
/// distance of nodes k and k + 1.
template <typename Gap>
std::int64_t spread_piece(double* z, std::int32_t first, std::int32_t last, bool fixed_end,
                          const Gap& gap) {
  std::int64_t moved = 0;
  const std::int32_t end = fixed_end ? last - 1 : last;
  for (std::int32_t k = first + 1; k <= end; ++k) {
    if (z[k] >= z[k - 1] + gap(k - 1)) continue;
    z[k] = z[k - 1] + gap(k - 1);
    ++moved;
  }
  for (std::int32_t k = end; k > first && fixed_end; --k) {
    if (z[k] <= z[k + 1] - gap(k)) continue;
    z[k] = z[k + 1] - gap(k);
    ++moved;
  }
  return moved;
}

MonotoneReport guard_column(LayeredMesh& mesh, VertexIndex v, const MonotoneOptions& options) {
  double* z = mesh.column(v);
  MonotoneReport report;
  std::int32_t first = mesh.first_node[v];
  // Outside walls a column of the building's own has its roof as lowest node: one piece only.
  const std::int32_t roof = mesh.roof_layer[v] > first ? mesh.roof_layer[v] : mesh.layers;
  for (const std::int32_t last : {roof, mesh.layers}) {
    if (last == first) continue;
    const bool fixed_end = last < mesh.layers || options.fixed_top;
    const double spacing = fixed_end ? (z[last] - z[first]) / (last - first) : options.layer_height;
    if (!(spacing > 0))
      throw Error(ErrorKind::kGuarantee,
                  "column mesh: fixed heights do not increase at ground vertex " +
                      std::to_string(v) + " between layers " + std::to_string(first) + " and " +
                      std::to_string(last));
    const auto even = [&](std::int32_t) { return options.gap_share * spacing; };
    // A share of the even spacing would destroy thin layers.
    const auto of_ladder = [&](std::int32_t k) {
      const double share =
          last < mesh.layers ? std::max(options.gap_share, kShareAtWalls) : options.gap_share;
      return share * spacing * (last - first) *
             (share_below(mesh, first, k + 1, last) - share_below(mesh, first, k, last));
    };
    report.moved += mesh.ladder.empty() ? spread_piece(z, first, last, fixed_end, even)
                                        : spread_piece(z, first, last, fixed_end, of_ladder);
    first = last;
  }
  report.min_gap = kInfinity;
  for (std::int32_t k = mesh.first_node[v]; k < mesh.layers; ++k) {
    if (!(z[k + 1] > z[k]))  // so that NaN fails as well
      throw Error(ErrorKind::kGuarantee, "column mesh: the column at ground vertex " +
                                             std::to_string(v) + " could not be made monotone");
    report.min_gap = std::min(report.min_gap, z[k + 1] - z[k]);
  }
  return report;
}

MonotoneReport combined(const MonotoneReport& a, const MonotoneReport& b) {
  return {a.moved + b.moved, std::min(a.min_gap, b.min_gap)};
}

}  // namespace

MonotoneReport make_monotone(LayeredMesh& mesh, const MonotoneOptions& options) {
  const MonotoneReport none{0, kInfinity};
  return parallel_reduce_ordered(
      mesh.vertex_count(), 512, none,
      [&](std::size_t begin, std::size_t end) {
        MonotoneReport chunk = none;
        for (const VertexIndex v : indices<VertexIndex>(begin, end))
          chunk = combined(chunk, guard_column(mesh, v, options));
        return chunk;
      },
      combined);
}

}  // namespace tetropolis
