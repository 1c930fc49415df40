#include "tetropolis/volume/quality/cell_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "cells_of.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/units.h"
#include "shapes_over.h"
#include "tet_cosines.h"

namespace tetropolis {

namespace {

constexpr double kFlattest = 180 - kQualityFloor.greatest;

/// Keeps the `count` worst, worst first; ties by place, so that the order of adding is irrelevant.
void keep_worst(std::vector<WorstCell>& cells, std::size_t count) {
  std::sort(cells.begin(), cells.end(), [](const WorstCell& a, const WorstCell& b) {
    return std::tie(a.share_of_floor, a.triangle, a.centre) <
           std::tie(b.share_of_floor, b.triangle, b.centre);
  });
  if (cells.size() > count) cells.resize(count);
}

/// Ground that rises above a roof by more than this times the triangle's altitude leaves the cells
/// between them no good shape: the roof's edge has one cell on that side, however columns are cut.
constexpr double kBuried = 2;

double altitude(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 e0 = minus(b, a), e1 = minus(c, a), e2 = minus(c, b);
  const double longest =
      std::sqrt(std::max({e0[0] * e0[0] + e0[1] * e0[1], e1[0] * e1[0] + e1[1] * e1[1],
                          e2[0] * e2[0] + e2[1] * e2[1]}));
  return std::abs(e0[0] * e1[1] - e0[1] * e1[0]) / longest;
}

/// What makes a bad cell over triangle t, from its nodes: p[3] is above one of the others.
std::string_view cause_of(const ColumnMesh& mesh, TriangleIndex t,
                          const std::array<NodeIndex, 4>& nodes, const std::array<Point3, 4>& p) {
  const auto& v = mesh.ground.triangles[t];
  const double least = altitude(p[0], p[1], p[2]);
  double low = kInfinity, high = -low, roof = low;
  bool at_floor = true, at_building = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const NodeIndex floor = mesh.floor_over(t, v[i]);
    low = std::min(low, mesh.z[floor]);
    high = std::max(high, mesh.z[floor]);
    at_floor = at_floor && nodes[i] <= floor + 1;
    for (const RegionIndex region : mesh.regions[v[i]]) {
      if (!mesh.ground.regions[region].is_building()) continue;
      at_building = true;
      roof = std::min(roof, mesh.z[mesh.floor(region, v[i])]);
    }
  }
  const auto below =
      static_cast<std::size_t>(std::find(nodes.begin(), nodes.end(), nodes[3] - 1) - nodes.begin());
  const double edge = p[3][2] - p[below][2];
  const double bottom = std::min({p[0][2], p[1][2], p[2][2]});
  if (at_building && bottom < high && high - roof > kBuried * least) return "buried roof";
  if (at_floor && high - low > least) return "steep ground";
  if (at_floor && at_building && edge < least) return "low wall";
  if (edge > 2 * least) return "small detail";
  return "change of size";
}

}  // namespace

double share_of_floor(double least_deg, double greatest_deg) {
  return std::min(least_deg / kLeastOfMost, (180 - greatest_deg) / kFlattest);
}

AngleBounds angles_at(double share) { return {share * kLeastOfMost, 180 - share * kFlattest}; }

CellExtremes cells_over(const ColumnMesh& mesh, std::span<const TriangleIndex> triangles,
                        std::size_t worst) {
  const std::size_t grain = grain_of_chunks(triangles.size());
  std::vector<CellExtremes> partial((triangles.size() + grain - 1) / grain);
  const auto widen = [](CellExtremes& all, double greatest, double least, double aspect_ratio) {
    all.greatest_cosine = std::max(all.greatest_cosine, greatest);
    all.least_cosine = std::min(all.least_cosine, least);
    all.aspect_ratio = std::max(all.aspect_ratio, aspect_ratio);
  };
  parallel_chunks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    CellExtremes& part = partial[begin / grain];
    // Cells whose cosines stay within these are not among the worst.
    double greatest_cosine = -2, least_cosine = 2;
    const auto add = [&](TriangleIndex t, const std::array<NodeIndex, 4>& nodes,
                         const std::array<Point3, 4>& p, const TetCosines& shape) {
      widen(part, shape.greatest, shape.least, shape.aspect_ratio);
      if (worst == 0 || (shape.greatest < greatest_cosine && shape.least > least_cosine)) return;
      const double least = angle_deg(shape.greatest), greatest = angle_deg(shape.least);
      part.worst.push_back({share_of_floor(least, greatest), least, greatest, centre_of(p), t,
                            cause_of(mesh, t, nodes, p)});
      if (part.worst.size() < 2 * worst) return;
      keep_worst(part.worst, worst);
      const AngleBounds limits = angles_at(part.worst.back().share_of_floor);
      greatest_cosine = std::cos(to_radians(limits.least)) - 1e-12;
      least_cosine = std::cos(to_radians(limits.greatest)) + 1e-12;
    };
    for (std::size_t i = begin; i < end; ++i) {
      const TriangleIndex t = triangles[i];
      for_each_shape_over(mesh, t, [&](const auto& nodes, const auto& p, const auto& shape) {
        add(t, nodes, p, shape);
      });
    }
  });
  CellExtremes result;
  for (const CellExtremes& part : partial) {
    widen(result, part.greatest_cosine, part.least_cosine, part.aspect_ratio);
    result.worst.insert(result.worst.end(), part.worst.begin(), part.worst.end());
  }
  keep_worst(result.worst, worst);
  return result;
}

}  // namespace tetropolis
