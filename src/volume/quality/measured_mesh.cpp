#include "measured_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cells_of.h"
#include "core/infinity.h"
#include "core/parallel.h"
#include "core/units.h"
#include "faces_of.h"
#include "measure_upper.h"
#include "shapes_over.h"
#include "stack_kernels.h"

namespace tetropolis {

namespace {

/// Of a sweep's buffers: enough for few edges to have a triangle in another block, and little
/// enough for the cache.
constexpr std::size_t kTrianglesPerBlock = 512;
/// And of chunks, each of which has a histogram.
constexpr std::size_t kLeastTrianglesPerChunk = 1024;

/// Far beyond the rounding of the kernels' figures, and of these to floats.
constexpr double kMargin = 1e-6, kTiny = 1e-12;

bool at_most(double figure, double limit) { return figure <= limit * (1 + kMargin) + kTiny; }
bool at_least(double figure, double limit) { return figure >= limit * (1 - kMargin) - kTiny; }

/// 1 - cosine, which tells small angles apart, and back.
double versine(double degrees) {
  const double sine = std::sin(to_radians(degrees / 2));
  return 2 * sine * sine;
}
double angle_of(double versine) {
  return to_degrees(2 * std::asin(std::sqrt(std::clamp(versine / 2, 0.0, 1.0))));
}

/// The cosines of the bounds' angles.
struct CosineBounds {
  double of_least, of_greatest;
};

const std::array<CosineBounds, kAskedBounds.size()>& cosine_bounds() {
  static const auto bounds = [] {
    std::array<CosineBounds, kAskedBounds.size()> cosines{};
    for (std::size_t i = 0; i < cosines.size(); ++i)
      cosines[i] = {std::cos(to_radians(kAskedBounds[i].least)),
                    std::cos(to_radians(kAskedBounds[i].greatest))};
    return cosines;
  }();
  return bounds;
}

/// Of the least angle, and of 180 degrees less the greatest.
struct Versines {
  double least = 0, greatest = 0;
};

/// Those beyond which a cell is good by all bounds.
const Versines& good_versines() {
  static const auto good = [] {
    Versines versines;
    for (const AngleBounds& bounds : kAskedBounds) {
      versines.least = std::max(versines.least, versine(bounds.least));
      versines.greatest = std::max(versines.greatest, versine(180 - bounds.greatest));
    }
    return versines;
  }();
  return good;
}

/// Greatest squared skewness of the lowest `count` faces of a strip, on the boundary.
double skewness2_of_wall(const Strip& strip, Point2 a, Point2 b, Point2 opposite,
                         std::size_t count) {
  double greatest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Point3 pa{a.x, a.y, strip.a[k]}, pb{b.x, b.y, strip.b[k]};
    const Point3 apex = strip.a[k + 1] != strip.a[k] ? Point3{a.x, a.y, strip.a[k + 1]}
                                                     : Point3{b.x, b.y, strip.b[k + 1]};
    const Point3 behind{opposite.x, opposite.y, strip.opposite[k]};
    greatest =
        std::max(greatest, boundary_skewness({pa, pb, apex}, centre_of({pa, pb, apex, behind})));
  }
  return greatest * greatest;
}

/// A stack is a prism cut at an angle.
double volume_of(const ColumnMesh& mesh) {
  return parallel_reduce_ordered(
      mesh.triangle_count(), 4096, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double volume = 0;
        for (const TriangleIndex t : indices<TriangleIndex>(begin, end)) {
          const auto& v = mesh.ground.triangles[t];
          const auto at = [&](std::size_t i) { return mesh.ground.vertices[v[i]]; };
          const Point2 a = at(0), b = at(1), c = at(2);
          const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
          double height = 0;  // of all three corners
          for (const VertexIndex i : v)
            height += mesh.z[mesh.top(i)] - mesh.z[mesh.floor_over(t, i)];
          volume += area * height / 6;
        }
        return volume;
      },
      [](double a, double b) { return a + b; });
}

}  // namespace

/// Goes over some triangles block by block.
class MeasuredMesh::Sweep {
 public:
  /// `all`: what this and other sweeps go over, ascending.
  Sweep(MeasuredMesh& measured, const ColumnMesh& mesh, std::span<const TriangleIndex> all)
      : measured_(measured), mesh_(mesh), all_(all) {}

  /// Counts the cells in the histogram if there is one. Measures the stacks and edges, or if
  /// `times` is -1 nothing more.
  void go_over(std::span<const TriangleIndex> block, QualityHistogram* histogram, int times);

 private:
  Stack stack_over(TriangleIndex t) const;
  /// Of the faces that the kernels have measured; exact() tells more where some are steep.
  template <typename Exact>
  static Faces faces_of(const FaceFigures& figures, std::size_t count, const Exact& exact);
  Faces faces_over_edge(EdgeIndex e, std::span<const TriangleIndex> block);
  /// The strip over edge e as its triangle t sees it; returns the corner opposite to the edge.
  Point2 gather(EdgeIndex e, TriangleIndex t, std::span<const TriangleIndex> block, Strip& strip);
  bool is_measured_with(TriangleIndex t, EdgeIndex e) const;

  MeasuredMesh& measured_;
  const ColumnMesh& mesh_;
  std::span<const TriangleIndex> all_;
  FrontStore block_, other_;
  StackKernels kernels_;
  std::array<Strip, 2> strips_;
};

template <typename Exact>
MeasuredMesh::Faces MeasuredMesh::Sweep::faces_of(const FaceFigures& figures, std::size_t count,
                                                  const Exact& exact) {
  static const double steep = std::pow(std::cos(to_radians(kMostNonOrthogonal)), 2);
  Faces faces;
  faces.count = static_cast<std::int32_t>(count);
  faces.straight2 = static_cast<float>(figures.straight2);
  faces.skewness2 = static_cast<float>(figures.skewness2);
  if (!at_most(figures.straight2, steep)) return faces;
  const FaceQuality quality = exact();
  faces.steep = static_cast<std::int32_t>(quality.above_70);
  if (faces.steep > 0)
    faces.worst_steep_deg = static_cast<float>(quality.worst.non_orthogonality_deg);
  return faces;
}

MeasuredMesh::Stack MeasuredMesh::Sweep::stack_over(TriangleIndex t) const {
  Stack stack;
  const CellFigures& cells = kernels_.cells();
  stack.least = static_cast<float>(1 - cells.greatest);
  stack.greatest = static_cast<float>(1 + cells.least);
  stack.aspect2 = static_cast<float>(cells.aspect2);
  if (const Versines& good = good_versines();
      at_most(stack.least, good.least) || at_most(stack.greatest, good.greatest)) {
    const auto& bounds = cosine_bounds();
    const double thin = bounds[static_cast<std::size_t>(Asked::kOfMost)].of_least;
    for_each_shape_over(mesh_, t, [&](const auto&, const auto&, const TetCosines& shape) {
      stack.thin += shape.greatest > thin ? 1 : 0;
      for (std::size_t i = 0; i < bounds.size(); ++i)
        stack.outside[i] +=
            shape.greatest > bounds[i].of_least || shape.least < bounds[i].of_greatest ? 1 : 0;
    });
  }
  stack.faces = faces_of(kernels_.faces(), kernels_.greatest().size() - 1,
                         [&] { return faces_over(mesh_, t); });
  return stack;
}

Point2 MeasuredMesh::Sweep::gather(EdgeIndex e, TriangleIndex t,
                                   std::span<const TriangleIndex> block, Strip& strip) {
  auto i = static_cast<std::size_t>(t - block.front());
  const auto is_found = [&] { return i < block.size() && block[i] == t; };
  if (!is_found())  // Otherwise the block is a run of triangles, as mostly.
    i = static_cast<std::size_t>(std::lower_bound(block.begin(), block.end(), t) - block.begin());
  Fronts fronts;
  if (is_found()) {
    fronts = block_[i];
  } else {
    other_.clear();
    other_.add(mesh_, t);
    fronts = other_[0];
  }
  const auto& own = mesh_.edges.of_triangle[t];
  const std::size_t corner = own[2] == e ? 0 : own[1] == e ? 1 : 2;
  gather_strip(fronts, corner, strip);
  return fronts.corner[corner];
}

MeasuredMesh::Faces MeasuredMesh::Sweep::faces_over_edge(EdgeIndex e,
                                                         std::span<const TriangleIndex> block) {
  const auto [a, b] = mesh_.edges.vertices[e];
  const Point2 pa = mesh_.ground.vertices[a], pb = mesh_.ground.vertices[b];
  std::array<Point2, 2> opposite;
  for (std::size_t s = 0; s < 2; ++s) {
    const TriangleIndex t = mesh_.edges.triangles[e][s];
    strips_[s].faces = 0;
    if (t != kNoTriangle) opposite[s] = gather(e, t, block, strips_[s]);
  }
  // Under a roof, and on the rim, there are cells on one side only.
  const std::size_t count = std::min(strips_[0].faces, strips_[1].faces);
  FaceFigures figures;
  if (count > 0) figures = kernels_.measure_between(pa, pb, opposite, strips_, count);
  for (std::size_t s = 0; s < 2; ++s)
    figures.skewness2 =
        std::max(figures.skewness2,
                 skewness2_of_wall(strips_[s], pa, pb, opposite[s], strips_[s].faces - count));
  return faces_of(figures, count, [&] { return faces_beside(mesh_, e); });
}

/// Edges are measured with the last of their triangles.
bool MeasuredMesh::Sweep::is_measured_with(TriangleIndex t, EdgeIndex e) const {
  const TriangleIndex last = mesh_.edges.triangles[e][1];
  return t == last || last == kNoTriangle ||
         (all_.size() < mesh_.triangle_count() &&
          !std::binary_search(all_.begin(), all_.end(), last));
}

void MeasuredMesh::Sweep::go_over(std::span<const TriangleIndex> block, QualityHistogram* histogram,
                                  int times) {
  block_.clear();
  for (const TriangleIndex t : block) block_.add(mesh_, t);
  for (std::size_t i = 0; i < block.size(); ++i) {
    const TriangleIndex t = block[i];
    kernels_.measure(block_[i]);
    if (histogram != nullptr)
      histogram->add(kernels_.greatest(), kernels_.aspect2(), kernels_.cells().inverted, times);
    if (times < 0) continue;
    measured_.stacks_[t] = stack_over(t);
    for (const EdgeIndex e : mesh_.edges.of_triangle[t])
      if (is_measured_with(t, e)) measured_.beside_[e] = faces_over_edge(e, block);
  }
}

void MeasuredMesh::sweep(const ColumnMesh& mesh, std::span<const TriangleIndex> triangles,
                         int times) {
  const std::size_t grain = std::max(grain_of_chunks(triangles.size()), kLeastTrianglesPerChunk);
  std::vector<QualityHistogram> partial;
  if (histogram_ && triangles.size() > grain) partial.resize((triangles.size() - 1) / grain + 1);
  parallel_chunks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    QualityHistogram* const histogram = !partial.empty() ? &partial[begin / grain]
                                        : histogram_     ? &*histogram_
                                                         : nullptr;
    Sweep sweep(*this, mesh, triangles);
    for (; begin < end; begin += kTrianglesPerBlock)
      sweep.go_over(triangles.subspan(begin, std::min(kTrianglesPerBlock, end - begin)), histogram,
                    times);
  });
  for (const QualityHistogram& part : partial) histogram_->merge(part);
}

MeasuredMesh::MeasuredMesh(const ColumnMesh& mesh, Counting counting)
    : stacks_(mesh.triangle_count()), beside_(mesh.edges.size()) {
  if (counting == Counting::kHistogram) histogram_.emplace();
  std::vector<TriangleIndex> all(mesh.triangle_count());
  std::iota(all.begin(), all.end(), TriangleIndex(0));
  sweep(mesh, all, 1);
}

void MeasuredMesh::forget(const ColumnMesh& mesh, std::span<const VertexIndex> columns) {
  if (histogram_) sweep(mesh, triangles_around(mesh.edges, columns), -1);
}

void MeasuredMesh::look_again(const ColumnMesh& mesh, std::span<const VertexIndex> columns) {
  sweep(mesh, triangles_around(mesh.edges, columns), 1);
}

FaultCounts MeasuredMesh::counts() const {
  FaultCounts counts;
  const auto add = [&](const Faces& faces) {
    counts.steep_faces += faces.steep;
    counts.worst_face_deg =
        std::max(counts.worst_face_deg, static_cast<double>(faces.worst_steep_deg));
  };
  for (const Stack& stack : stacks_) {
    counts.cells += stack.faces.count + 1;
    counts.thin += stack.thin;
    for (std::size_t i = 0; i < kAskedBounds.size(); ++i) {
      counts.outside[i] += stack.outside[i];
      counts.triangles[i] += stack.outside[i] > 0 ? 1 : 0;
    }
    add(stack.faces);
  }
  for (const Faces& faces : beside_) add(faces);
  return counts;
}

std::vector<std::uint8_t> MeasuredMesh::steep_triangles(const ColumnMesh& mesh) const {
  std::vector<std::uint8_t> steep(stacks_.size());
  for (std::size_t t = 0; t < steep.size(); ++t) steep[t] = stacks_[t].faces.steep > 0 ? 1 : 0;
  for (const EdgeIndex e : mesh.edges.vertices.indices())
    if (beside_[e].steep > 0)
      for (const TriangleIndex t : mesh.edges.triangles[e])
        if (t != kNoTriangle) steep[t] = 1;
  return steep;
}

std::vector<std::uint8_t> MeasuredMesh::bad_triangles(const ColumnMesh& mesh, Asked asked) const {
  std::vector<std::uint8_t> bad = steep_triangles(mesh);
  for (std::size_t t = 0; t < bad.size(); ++t)
    if (stacks_[t].outside[static_cast<std::size_t>(asked)] > 0) bad[t] = 1;
  return bad;
}

/// Those over which the cells with extreme figures are, and the `worst` worst ones.
std::vector<TriangleIndex> MeasuredMesh::suspects(std::size_t worst) const {
  Stack extreme;
  std::vector<double> shares;            // of the worst stacks so far
  Versines limit{kInfinity, kInfinity};  // worse ones keep to one of these
  if (worst == 0) limit = {};
  const auto prune = [&] {
    if (worst == 0 || shares.size() < worst) return;
    const auto last = shares.begin() + static_cast<std::ptrdiff_t>(worst) - 1;
    std::nth_element(shares.begin(), last, shares.end());
    shares.resize(worst);
    const AngleBounds bounds = angles_at(shares.back());
    limit = {versine(bounds.least), versine(180 - bounds.greatest)};
  };
  for (const Stack& stack : stacks_) {
    extreme.least = std::min(extreme.least, stack.least);
    extreme.greatest = std::min(extreme.greatest, stack.greatest);
    extreme.aspect2 = std::max(extreme.aspect2, stack.aspect2);
    const double least = stack.least, greatest = stack.greatest;
    if (least > limit.least && greatest > limit.greatest) continue;
    shares.push_back(share_of_floor(angle_of(least), 180 - angle_of(greatest)));
    if (shares.size() >= 2 * worst) prune();
  }
  prune();
  limit.least = std::max(limit.least, double{extreme.least});
  limit.greatest = std::max(limit.greatest, double{extreme.greatest});
  std::vector<TriangleIndex> triangles;
  for (const TriangleIndex t : indices<TriangleIndex>(stacks_.size()))
    if (at_most(stacks_[t].least, limit.least) || at_most(stacks_[t].greatest, limit.greatest) ||
        at_least(stacks_[t].aspect2, extreme.aspect2))
      triangles.push_back(t);
  return triangles;
}

FaceQuality MeasuredMesh::face_quality(const ColumnMesh& mesh) const {
  FaceQuality quality;
  Faces extreme;
  const auto for_all = [&](const auto& visit) {
    for (const TriangleIndex t : mesh.ground.triangles.indices())
      visit(stacks_[t].faces, t, faces_over);
    for (const EdgeIndex e : mesh.edges.vertices.indices()) visit(beside_[e], e, faces_beside);
  };
  for_all([&](const Faces& faces, auto, auto) {
    quality.faces += faces.count;
    quality.above_70 += faces.steep;
    extreme.straight2 = std::min(extreme.straight2, faces.straight2);
    extreme.skewness2 = std::max(extreme.skewness2, faces.skewness2);
  });
  for_all([&](const Faces& faces, auto i, auto measure) {
    if (!at_most(faces.straight2, extreme.straight2) &&
        !at_least(faces.skewness2, extreme.skewness2))
      return;
    const FaceShape worst = measure(mesh, i).worst;
    quality.worst = {std::max(quality.worst.non_orthogonality_deg, worst.non_orthogonality_deg),
                     std::max(quality.worst.skewness, worst.skewness)};
  });
  return quality;
}

MeshQuality MeasuredMesh::quality(const ColumnMesh& mesh, std::size_t worst) const {
  MeshQuality quality{{*histogram_, {}}, face_quality(mesh), counts()};
  CellExtremes cells = cells_over(mesh, suspects(worst), worst);
  quality.cells.histogram.add_volume(volume_of(mesh));
  quality.cells.histogram.widen(cells.greatest_cosine, cells.least_cosine, cells.aspect_ratio);
  quality.cells.worst = std::move(cells.worst);
  return quality;
}

void measure_ends(const ColumnMesh& mesh, std::size_t worst, MeshQuality& quality) {
  double& skewness = quality.faces.worst.skewness;
  skewness = parallel_reduce_ordered(
      mesh.triangle_count(), 4096, skewness,
      [&](std::size_t begin, std::size_t end) {
        double greatest = 0;
        for (const TriangleIndex t : indices<TriangleIndex>(begin, end))
          greatest = std::max(greatest, skewness_at_ends(mesh, t));
        return greatest;
      },
      [](double a, double b) { return std::max(a, b); });
  if (!mesh.upper.empty()) add_upper_quality(mesh, worst, quality);
}

MeshQuality measure_quality(const ColumnMesh& mesh, std::size_t worst) {
  MeshQuality quality = MeasuredMesh(mesh, MeasuredMesh::Counting::kHistogram).quality(mesh, worst);
  measure_ends(mesh, worst, quality);
  return quality;
}

CellQuality measure_cells(const ColumnMesh& mesh, std::size_t worst) {
  return measure_quality(mesh, worst).cells;
}

FaceQuality measure_faces(const ColumnMesh& mesh) { return measure_quality(mesh, 0).faces; }

}  // namespace tetropolis
