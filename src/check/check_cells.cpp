#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "core/infinity.h"
#include "core/parallel.h"
#include "core/units.h"
#include "vector3.h"
#include "violations.h"
#include "volume_parts.h"

namespace tetropolis {

namespace {

constexpr std::size_t kTetsPerChunk = 16384;

struct CellShape {
  double volume;
  double greatest_cotangent;  // of the least dihedral angle
  double least_cotangent;     // of the greatest
  double aspect;
};

/// Length of the shortest edge along z; infinite without any.
double least_vertical_edge(const std::array<Vector3, 4>& p) {
  double least = kInfinity;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      if (p[i][0] == p[j][0] && p[i][1] == p[j][1])
        least = std::min(least, std::abs(p[j][2] - p[i][2]));
  return least;
}

/// From the outward area vectors a of two faces and the edge e between them: the faces' dihedral
/// angle has |a_k x a_l| = 6 |V| |e| for the sine and -a_k . a_l for the cosine. Compared are
/// cotangents with their squares, which spares the roots.
CellShape cell_shape(const std::array<Vector3, 4>& p) {
  const Vector3 u = difference(p[1], p[0]), v = difference(p[2], p[0]), w = difference(p[3], p[0]);
  const Vector3 r = difference(p[2], p[1]), s = difference(p[3], p[1]), t = difference(p[3], p[2]);
  const std::array<Vector3, 4> area{cross(r, s), cross(w, v), cross(u, w), cross(v, u)};
  const double six_volumes = -dot(area[3], w);
  // Edges by the two faces beside them.
  const double edges[6] = {dot(t, t), dot(s, s), dot(r, r), dot(w, w), dot(v, v), dot(u, u)};
  const double cosines[6] = {-dot(area[0], area[1]), -dot(area[0], area[2]),
                             -dot(area[0], area[3]), -dot(area[1], area[2]),
                             -dot(area[1], area[3]), -dot(area[2], area[3])};
  double greatest = -kInfinity, least = kInfinity, longest = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double square = cosines[i] * std::abs(cosines[i]) / edges[i];
    greatest = std::max(greatest, square);
    least = std::min(least, square);
    longest = std::max(longest, edges[i]);
  }
  const auto root = [&](double square) {
    return std::copysign(std::sqrt(std::abs(square)), square) / std::abs(six_volumes);
  };
  const double surface = length(area[0]) + length(area[1]) + length(area[2]) + length(area[3]);
  CellShape shape{six_volumes / 6, root(greatest), root(least), kInfinity};
  if (six_volumes != 0) shape.aspect = std::sqrt(longest / 24) * surface / std::abs(six_volumes);
  return shape;
}

/// What is added up over the cells.
struct Sums {
  double volume = 0;
  double least_cotangent = kInfinity;
  double least_vertical_edge = kInfinity;
  std::int64_t inverted = 0;
  std::int64_t slivers = 0;
  std::vector<Violation> violations;
};

Sums added(Sums a, const Sums& b) {
  a.volume += b.volume;
  a.least_cotangent = std::min(a.least_cotangent, b.least_cotangent);
  a.least_vertical_edge = std::min(a.least_vertical_edge, b.least_vertical_edge);
  a.inverted += b.inverted;
  a.slivers += b.slivers;
  add_violations(a.violations, b.violations);
  return a;
}

Distribution distribution(const std::vector<float>& values, double (*convert)(double)) {
  if (values.empty()) return {};
  std::vector<double> at = values_at(values, {0, 1e-4, 1e-3, 1e-2, 0.5, 0.99, 1});
  for (double& value : at) value = convert(value);
  return {at[0], at[1], at[2], at[3], at[4], at[5], at[6]};
}

/// Positive floats have the order of their bits.
std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

}  // namespace

std::string place_of(const TetMesh& mesh, std::size_t c) {
  Vector3 centre{0, 0, 0};
  for (const std::int64_t v : mesh.cells[c])
    for (std::size_t d = 0; d < 3; ++d)
      centre[d] += mesh.points[static_cast<std::size_t>(v)][d] / 4;
  return fmt::format("cell {} at ({:.3f}, {:.3f}, {:.3f})", c, centre[0], centre[1], centre[2]);
}

std::vector<double> values_at(const std::vector<float>& values, const std::vector<double>& shares) {
  // Counted by the upper half of their bits; the values of a bin that is asked for are then sorted.
  constexpr std::size_t kBins = 1 << 16, kParts = 16;
  using Counts = std::vector<std::int64_t>;
  const std::size_t grain = values.size() / kParts + 1;
  const Counts counts = parallel_reduce_ordered(
      values.size(), grain, Counts(kBins, 0),
      [&](std::size_t begin, std::size_t end) {
        Counts part(kBins, 0);
        for (std::size_t i = begin; i < end; ++i) ++part[bits_of(values[i]) >> 16];
        return part;
      },
      [](Counts a, const Counts& b) {
        for (std::size_t i = 0; i < kBins; ++i) a[i] += b[i];
        return a;
      });
  std::vector<std::size_t> bin_of, rank_in_bin;
  std::vector<std::vector<float>> content(kBins);
  std::vector<char> wanted(kBins, 0);
  for (const double share : shares) {
    // The first at which that share is reached, as QualityHistogram has it.
    const double reached = std::ceil(share * static_cast<double>(values.size()));
    auto rank = static_cast<std::int64_t>(std::max(1.0, reached)) - 1;
    std::size_t bin = 0;
    for (; rank >= counts[bin]; ++bin) rank -= counts[bin];
    bin_of.push_back(bin);
    rank_in_bin.push_back(static_cast<std::size_t>(rank));
    wanted[bin] = 1;
  }
  for (const float value : values)
    if (wanted[bits_of(value) >> 16] != 0) content[bits_of(value) >> 16].push_back(value);
  std::vector<double> result;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    std::vector<float>& bin = content[bin_of[i]];
    const auto at = bin.begin() + static_cast<std::ptrdiff_t>(rank_in_bin[i]);
    std::nth_element(bin.begin(), at, bin.end());
    result.push_back(static_cast<double>(*at));
  }
  return result;
}

std::vector<std::uint8_t> measure_cells(const TetMesh& mesh, VolumeCheck& check) {
  std::vector<std::uint8_t> used(mesh.points.size(), 0);
  std::vector<float> tangents(mesh.cells.size()), aspects(mesh.cells.size());
  const double sliver = 1 / std::tan(to_radians(kSliverDihedralDeg));
  const Sums sums = parallel_reduce_ordered(
      mesh.cells.size(), kTetsPerChunk, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums part;
        for (std::size_t c = begin; c < end; ++c) {
          std::array<Vector3, 4> p;
          for (std::size_t i = 0; i < 4; ++i) {
            const auto v = static_cast<std::size_t>(mesh.cells[c][i]);
            p[i] = mesh.points[v];
            std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
          }
          const CellShape shape = cell_shape(p);
          part.volume += shape.volume;
          part.least_cotangent = std::min(part.least_cotangent, shape.least_cotangent);
          part.least_vertical_edge = std::min(part.least_vertical_edge, least_vertical_edge(p));
          if (!(shape.greatest_cotangent <= sliver)) ++part.slivers;
          // No angle of a tet is least and above 71 degrees; what is not a number counts as flat.
          const double tangent = 1 / shape.greatest_cotangent;
          tangents[c] = tangent > 0 ? static_cast<float>(tangent) : 0.0F;
          aspects[c] = static_cast<float>(shape.aspect);
          if (shape.volume > 0) continue;
          ++part.inverted;
          note_violation(part.violations, "inverted cells", [&] { return place_of(mesh, c); });
        }
        return part;
      },
      added);
  check.volume = sums.volume;
  check.inverted = sums.inverted;
  check.slivers = sums.slivers;
  check.least_vertical_edge = sums.least_vertical_edge;
  add_violations(check.violations, sums.violations);
  if (!mesh.cells.empty())
    check.max_dihedral_deg = to_degrees(std::atan2(1.0, sums.least_cotangent));
  check.min_dihedral_deg =
      distribution(tangents, [](double tangent) { return to_degrees(std::atan(tangent)); });
  check.aspect_ratio = distribution(aspects, [](double aspect) { return aspect; });
  return used;
}

}  // namespace tetropolis
