#include "measure_upper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tetropolis/volume/quality/face_quality.h"

#include "cells_of.h"
#include "core/parallel.h"
#include "core/units.h"
#include "tet_cosines.h"
#include "tet_kernels.h"
#include "volume/column/upper_faces.h"
#include "volume/column/upper_fans.h"

namespace tetropolis {

namespace {

/// Far beyond the rounding of cosines and squares.
constexpr double kCosineMargin = 1e-9;

/// Fans of a chunk.
constexpr std::size_t kLeastFansPerChunk = 1024;

/// The worst cells, worst first; of those as bad, the first.
class WorstCells {
 public:
  explicit WorstCells(std::size_t most) : most_(most) {}
  /// Whether a cell with these angles may be one of them.
  bool may_take(const TetCosines& shape) const {
    return most_ > 0 && (shape.greatest > least_ || shape.least < greatest_);
  }
  void add(WorstCell cell) {
    const auto worse = [](const WorstCell& a, const WorstCell& b) {
      return a.share_of_floor < b.share_of_floor;
    };
    if (most_ == 0 || (cells_.size() == most_ && !worse(cell, cells_.back()))) return;
    cells_.insert(std::upper_bound(cells_.begin(), cells_.end(), cell, worse), std::move(cell));
    if (cells_.size() > most_) cells_.pop_back();
    if (cells_.size() < most_) return;
    const AngleBounds bounds = angles_at(cells_.back().share_of_floor);
    least_ = std::cos(to_radians(bounds.least)) - kCosineMargin;
    greatest_ = std::cos(to_radians(bounds.greatest)) + kCosineMargin;
  }
  const std::vector<WorstCell>& cells() const { return cells_; }

 private:
  std::size_t most_;
  double least_ = -1 - kCosineMargin,
         greatest_ = 1 + kCosineMargin;  // cosines that others are beyond
  std::vector<WorstCell> cells_;
};

/// Degrees that are good by all that is asked.
AngleBounds good_by_all() {
  AngleBounds good{kLeastOfMost, 180};
  for (const AngleBounds& bounds : kAskedBounds)
    good = {std::max(good.least, bounds.least), std::min(good.greatest, bounds.greatest)};
  return good;
}

/// Of cells.
class CellSums {
 public:
  explicit CellSums(std::size_t worst) : worst_(worst) {}
  void add(const std::array<const Point3*, 4>& corners) {
    corners_.add(corners);
    if (corners_.is_full()) measure();
  }
  /// Those that are left.
  void measure() {
    take_measured();
    measure_tets(corners_, figures_);
    measured_ = corners_.size();
    corners_.clear();
    take_measured();
  }
  /// Figures of up to FanRows::kMost cells may be written from there on, and are then taken.
  std::size_t room_for_fan() {
    if (measured_ + FanRows::kMost >= kRowStride) take_measured();
    return measured_;
  }
  TetFigures& figures() { return figures_; }
  void add_measured(std::size_t count) { measured_ += count; }
  void add_to(MeshQuality& quality, WorstCells& worst) const;

 private:
  void take_measured();

  PointRows<4> corners_;
  TetFigures figures_;
  std::size_t measured_ = 0;
  QualityHistogram histogram_;
  FaultCounts faults_;
  WorstCells worst_;
  double volume_ = 0;
};

void CellSums::take_measured() {
  static const double good_least = std::cos(to_radians(good_by_all().least)) - kCosineMargin;
  static const double good_greatest = std::cos(to_radians(good_by_all().greatest)) + kCosineMargin;
  const std::size_t count = std::exchange(measured_, 0);
  faults_.cells += static_cast<std::int64_t>(count);
  std::int64_t inverted = 0;
  double greatest = -1, least = 1, aspect = 0, volume = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const TetCosines shape{figures_.volume[k], figures_.greatest[k], figures_.least[k],
                           figures_.aspect[k]};
    inverted += shape.volume > 0 ? 0 : 1;
    volume += shape.volume;
    greatest = std::max(greatest, shape.greatest);
    least = std::min(least, shape.least);
    aspect = std::max(aspect, shape.aspect_ratio);
    figures_.aspect[k] *= shape.aspect_ratio;
    const bool is_good = shape.greatest < good_least && shape.least > good_greatest;
    if (is_good && !worst_.may_take(shape)) continue;
    const double least_deg = angle_deg(shape.greatest), greatest_deg = angle_deg(shape.least);
    faults_.thin += least_deg < kLeastOfMost ? 1 : 0;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i)
      faults_.outside[i] +=
          least_deg < kAskedBounds[i].least || greatest_deg > kAskedBounds[i].greatest ? 1 : 0;
    worst_.add({share_of_floor(least_deg, greatest_deg), least_deg, greatest_deg,
                figures_.centre(k), kNoTriangle, "change of size"});
  }
  volume_ += volume;
  histogram_.widen(greatest, least, aspect);
  histogram_.add(std::span(figures_.greatest).first(count), std::span(figures_.aspect).first(count),
                 inverted);
}

void CellSums::add_to(MeshQuality& quality, WorstCells& worst) const {
  quality.cells.histogram.merge(histogram_);
  quality.cells.histogram.add_volume(volume_);
  quality.faults.cells += faults_.cells;
  quality.faults.thin += faults_.thin;
  for (std::size_t i = 0; i < kAskedBounds.size(); ++i)
    quality.faults.outside[i] += faults_.outside[i];
  for (const WorstCell& cell : worst_.cells()) worst.add(cell);
}

/// Of faces: the worst, and how many are too far from orthogonal.
class FaceSums {
 public:
  /// Between cells with these centres.
  void add(const std::array<const Point3*, 3>& face, const Point3& c0, const Point3& c1) {
    ++faces_.faces;
    rows_.add({face[0], face[1], face[2], &c0, &c1});
    if (rows_.is_full()) measure();
  }
  void add_boundary(const std::array<Point3, 3>& face, const Point3& centre) {
    worsen({0, boundary_skewness(face, centre)});
  }
  /// Those that are left.
  void measure() {
    std::array<double, kTetBatch> is_worse;
    find_worse_faces(rows_, limits_, is_worse);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      if (is_worse[k] == 0) continue;
      const auto [a, b, c, c0, c1] = rows_[k];
      const FaceShape shape = face_shape({a, b, c}, c0, c1);
      faces_.above_70 += shape.non_orthogonality_deg > kMostNonOrthogonal ? 1 : 0;
      worsen(shape);
    }
    rows_.clear();
  }
  const FaceLimits& limits() const { return limits_; }
  /// Faces of which none is of interest.
  void add_good(std::size_t count) { faces_.faces += static_cast<std::int64_t>(count); }
  void add_to(FaceQuality& quality) const {
    quality.faces += faces_.faces;
    quality.above_70 += faces_.above_70;
    quality.worst = {
        std::max(quality.worst.non_orthogonality_deg, faces_.worst.non_orthogonality_deg),
        std::max(quality.worst.skewness, faces_.worst.skewness)};
  }

 private:
  void worsen(const FaceShape& shape) {
    FaceShape& worst = faces_.worst;
    worst.non_orthogonality_deg =
        std::max(worst.non_orthogonality_deg, shape.non_orthogonality_deg);
    worst.skewness = std::max(worst.skewness, shape.skewness);
    const double degrees = std::min(worst.non_orthogonality_deg, kMostNonOrthogonal);
    limits_ = {std::pow(std::cos(to_radians(degrees)), 2) + kCosineMargin,
               worst.skewness * worst.skewness * (1 - kCosineMargin)};
  }
  PointRows<5> rows_;
  FaceQuality faces_;
  // Of those that may be the worst, or about as far from orthogonal as is allowed.
  FaceLimits limits_;
};

/// Measures fans: their cells, and the faces below, between and on the boundary of these.
class FanSweep {
 public:
  FanSweep(const ColumnMesh& mesh, const CellsByTop& tops, double top, CellSums& cells,
           FaceSums& faces)
      : mesh_(mesh), upper_(mesh.upper), tops_(tops), top_(top), cells_(cells), faces_(faces) {}
  void measure(std::size_t fan) {
    if (upper_.fans[fan].up.valid() && is_closed(fan) && cells_of(fan) <= FanRows::kMost)
      measure_whole(fan);
    else
      measure_in_parts(fan);
  }

 private:
  Point3 at(UpperPlace p) const { return upper_position(mesh_, p); }
  std::array<Point3, 4> corners(const UpperMesh::Cell& cell) const {
    return {at(cell[0]), at(cell[1]), at(cell[2]), at(cell[3])};
  }
  void add_top(const std::array<Point3, 3>& face, const Point3& centre) {
    if (face[0][2] == top_ && face[1][2] == top_ && face[2][2] == top_)
      faces_.add_boundary(face, centre);
  }
  std::array<Point3, 3> points(const UpperTriangle& p) const {
    return {at(p[0]), at(p[1]), at(p[2])};
  }
  std::size_t cells_of(std::size_t f) const {
    return upper_.fans[f + 1].cell - upper_.fans[f].cell;
  }
  /// Precondition: the fan goes up.
  bool is_closed(std::size_t f) const {
    return upper_.others[upper_.fans[f].other] == upper_.others[upper_.fans[f + 1].other - 1];
  }
  void measure_whole(std::size_t f);
  void measure_in_parts(std::size_t f);
  void measure_faces(std::size_t f);

  const ColumnMesh& mesh_;
  const UpperMesh& upper_;
  const CellsByTop& tops_;
  double top_;
  CellSums& cells_;
  FaceSums& faces_;
  FanRows rows_;
};

/// Precondition: it goes up, is closed and fits.
void FanSweep::measure_whole(std::size_t f) {
  const UpperFan& fan = upper_.fans[f];
  const std::size_t count = cells_of(f);
  const UpperPlace* const others = upper_.others.data() + fan.other;
  const Point3 node = at(fan.node), up = at(fan.up);
  std::array<Point3, FanRows::kMost + 1> around;
  for (std::size_t k = 0; k <= count; ++k) around[k] = at(others[k]);
  rows_.start(count);
  std::size_t below = 0;
  for (std::size_t k = 0; k < count; ++k) {
    rows_.set_point(k, around[k]);
    const std::array<const Point3*, 3> corner{&node, &around[k], &around[k + 1]};
    std::size_t highest = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if ((*corner[i])[2] > (*corner[highest])[2]) highest = i;
    const CellBelow found = tops_.find({fan.node, others[k], others[k + 1]}, highest);
    if (found.is_found()) {
      const auto top = [&](std::size_t i) { return *corner[(found.turn + i) % 3]; };
      const Point3 centre = centre_of({at(upper_.fans[found.fan].node), top(0), top(1), top(2)});
      rows_.set_below(k, &centre);
      ++below;
    } else {
      rows_.set_below(k, nullptr);
    }
  }
  const std::size_t begin = cells_.room_for_fan();
  const bool is_worse = rows_.measure(node, up[2], faces_.limits(), cells_.figures(), begin);
  cells_.add_measured(count);
  if (up[2] == top_)
    for (std::size_t k = 0; k < count; ++k)
      add_top({around[k], around[k + 1], up}, cells_.figures().centre(begin + k));
  if (is_worse)
    measure_faces(f);
  else
    faces_.add_good(count + below);
}

void FanSweep::measure_in_parts(std::size_t f) {
  const std::size_t first = upper_.fans[f].cell, end = upper_.fans[f + 1].cell;
  for (std::size_t c = first; c < end; ++c) {
    const UpperMesh::Cell cell = upper_.cell(f, c);
    const std::array<Point3, 4> p = corners(cell);
    cells_.add({&p[0], &p[1], &p[2], &p[3]});
    add_top(points(fan_face(cell, FanFace::kTop)), centre_of(p));
  }
  measure_faces(f);
  if (!upper_.fans[f].up.valid() || is_closed(f)) return;
  // Columns at the rim do not end.
  for (const auto& [c, face] : {std::pair(first, FanFace::kBefore), {end - 1, FanFace::kAfter}}) {
    const UpperMesh::Cell cell = upper_.cell(f, c);
    faces_.add_boundary(points(fan_face(cell, face)), centre_of(corners(cell)));
  }
}

/// Those below and between its cells.
void FanSweep::measure_faces(std::size_t f) {
  visit_faces_of(upper_, tops_, f, [&](const InnerFace& face) {
    const std::array<Point3, 3> p = points(face.places);
    faces_.add({&p[0], &p[1], &p[2]}, centre_of(corners(face.corners[0])),
               centre_of(corners(face.corners[1])));
  });
}

}  // namespace

void add_upper_quality(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality) {
  const UpperMesh& upper = mesh.upper;
  const CellsByTop tops(mesh);
  const double top = top_of(mesh);
  const std::size_t fans = upper.fans.size() - 1;
  // Each has a histogram.
  const std::size_t grain = std::max(grain_of_chunks(fans), kLeastFansPerChunk);
  WorstCells all(worst);
  for (const WorstCell& cell : quality.cells.worst) all.add(cell);
  std::vector<std::optional<CellSums>> cells((fans + grain - 1) / grain);
  std::vector<FaceSums> faces(cells.size());
  parallel_chunks(fans, grain, [&](std::size_t begin, std::size_t end) {
    CellSums& own = cells[begin / grain].emplace(worst);
    FaceSums& beside = faces[begin / grain];
    FanSweep sweep(mesh, tops, top, own, beside);
    for (std::size_t f = begin; f < end; ++f) sweep.measure(f);
    own.measure();
    beside.measure();
  });
  for (const auto& part : cells) part->add_to(quality, all);
  for (const FaceSums& part : faces) part.add_to(quality.faces);
  quality.cells.worst = all.cells();

  const CellIndex first = cell_offsets(mesh)[mesh.triangle_count()];
  const std::size_t triangles = grain_of_chunks(mesh.triangle_count(), 16);
  std::vector<FaceSums> on_lid((mesh.triangle_count() + triangles - 1) / triangles);
  parallel_chunks(mesh.triangle_count(), triangles, [&](std::size_t begin, std::size_t end) {
    FaceSums& own = on_lid[begin / triangles];
    for (const TriangleIndex t : indices<TriangleIndex>(begin, end)) {
      if (!mesh.is_covered(t)) continue;
      const auto& v = mesh.ground.triangles[t];
      const auto at = [&](std::size_t i) { return position(mesh, v[i], mesh.top(v[i])); };
      const std::array<Point3, 3> face{at(0), at(1), at(2)};
      const auto above = static_cast<std::size_t>(upper.over_lid[t] - first);
      upper.for_each_cell(above, above + 1, [&](const UpperMesh::Cell& cell) {
        std::array<Point3, 4> p;
        for (std::size_t i = 0; i < 4; ++i) p[i] = upper_position(mesh, cell[i]);
        own.add({&face[0], &face[1], &face[2]}, centre_of(uppermost_cell(mesh, t)), centre_of(p));
      });
    }
    own.measure();
  });
  for (const FaceSums& part : on_lid) part.add_to(quality.faces);
}

}  // namespace tetropolis
