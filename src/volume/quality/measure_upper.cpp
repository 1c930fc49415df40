#include "measure_upper.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tetropolis/volume/quality/face_quality.h"

#include "cells_of.h"
#include "tet_cosines.h"
#include "volume/column/upper_faces.h"

namespace tetropolis {

namespace {

void add_cells(const std::vector<std::array<Point3, 4>>& cells, std::size_t worst,
               MeshQuality& all) {
  CellQuality& quality = all.cells;
  FaultCounts& faults = all.faults;
  faults.cells += static_cast<std::int64_t>(cells.size());
  std::vector<double> greatest, aspect2;
  std::int64_t inverted = 0;
  double volume = 0;
  for (const auto& p : cells) {
    const TetCosines shape = tet_cosines(p[0], p[1], p[2], p[3]);
    greatest.push_back(shape.greatest);
    aspect2.push_back(shape.aspect_ratio * shape.aspect_ratio);
    inverted += shape.volume > 0 ? 0 : 1;
    volume += shape.volume;
    quality.histogram.widen(shape.greatest, shape.least, shape.aspect_ratio);
    const double least_deg = angle_deg(shape.greatest), greatest_deg = angle_deg(shape.least);
    faults.thin += least_deg < kLeastOfMost ? 1 : 0;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i)
      faults.outside[i] +=
          least_deg < kAskedBounds[i].least || greatest_deg > kAskedBounds[i].greatest ? 1 : 0;
    if (worst == 0) continue;
    const WorstCell cell{share_of_floor(least_deg, greatest_deg),
                         least_deg,
                         greatest_deg,
                         centre_of(p),
                         kNoTriangle,
                         "change of size"};
    const auto worse = [](const WorstCell& a, const WorstCell& b) {
      return a.share_of_floor < b.share_of_floor;
    };
    if (quality.worst.size() == worst && !worse(cell, quality.worst.back())) continue;
    quality.worst.insert(std::upper_bound(quality.worst.begin(), quality.worst.end(), cell, worse),
                         cell);
    if (quality.worst.size() > worst) quality.worst.pop_back();
  }
  quality.histogram.add(greatest, aspect2, inverted);
  quality.histogram.add_volume(volume);
}

}  // namespace

void add_upper_quality(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality) {
  const UpperNodes at(mesh);
  const std::vector<CellIndex> offsets = cell_offsets(mesh);
  const CellIndex first = offsets[mesh.triangle_count()];
  const auto corners = [&](std::size_t cell) {
    const auto& c = mesh.upper.cells[cell];
    return std::array<Point3, 4>{at[c[0]], at[c[1]], at[c[2]], at[c[3]]};
  };
  constexpr std::size_t kBlock = 16384;
  std::vector<std::array<Point3, 4>> block;
  for (std::size_t begin = 0; begin < mesh.upper.cells.size(); begin += kBlock) {
    block.clear();
    const std::size_t end = std::min(begin + kBlock, mesh.upper.cells.size());
    for (std::size_t c = begin; c < end; ++c) block.push_back(corners(c));
    add_cells(block, worst, quality);
  }

  const auto centre = [&](CellIndex c) {
    return centre_of(corners(static_cast<std::size_t>(c - first)));
  };
  const auto points = [&](const std::array<NodeIndex, 3>& n) {
    return std::array<Point3, 3>{at[n[0]], at[n[1]], at[n[2]]};
  };
  FaceQuality& faces = quality.faces;
  const auto add = [&](const std::array<NodeIndex, 3>& nodes, const Point3& c0, const Point3& c1) {
    const FaceShape shape = face_shape(points(nodes), c0, c1);
    ++faces.faces;
    faces.above_70 += shape.non_orthogonality_deg > kMostNonOrthogonal ? 1 : 0;
    faces.worst.non_orthogonality_deg =
        std::max(faces.worst.non_orthogonality_deg, shape.non_orthogonality_deg);
    faces.worst.skewness = std::max(faces.worst.skewness, shape.skewness);
  };
  visit_upper_faces(
      mesh,
      [&](const UpperFaces::Inner& face) {
        add(face.nodes, centre(face.cell), centre(face.neighbour));
      },
      [&](const UpperFace& face, bool) {
        faces.worst.skewness = std::max(faces.worst.skewness,
                                        boundary_skewness(points(face.nodes), centre(face.cell)));
      });
  for (const TriangleIndex t : mesh.ground.triangles.indices()) {
    if (!mesh.is_covered(t)) continue;
    const auto& v = mesh.ground.triangles[t];
    add({mesh.top(v[0]), mesh.top(v[1]), mesh.top(v[2])}, centre_of(uppermost_cell(mesh, t)),
        centre(mesh.upper.over_lid[t]));
  }
}

}  // namespace tetropolis
