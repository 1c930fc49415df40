#include "stack_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/infinity.h"
#include "core/wide.h"
#include "tet_lanes.h"

namespace tetropolis {

namespace {

using lanes::greater;
using lanes::lesser;

/// What all fronts over a triangle share. Side i is opposite to corner i.
struct Base {
  double area = 0;                                  ///< Twice the triangle's.
  double ux = 0, uy = 0, wx = 0, wy = 0, turn = 1;  ///< Sides 2 and 1 from corner 0; 1 or -1.
  double mx0 = 0, my0 = 0, mx1 = 0, my1 = 0, mx2 = 0, my2 = 0;  ///< Normals of sides, outwards.
  double l0 = 0, l1 = 0, l2 = 0;                                ///< Lengths of sides
  double ll0 = 0, ll1 = 0, ll2 = 0;                             ///< and their squares.
  double c0 = 0, c1 = 0, c2 = 0;                                ///< Cosines of the corners.
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0, x2 = 0, y2 = 0;        ///< Corners from the centroid.
};

Base base_of(const Fronts& fronts) {
  const std::array<Point2, 3>& p = fronts.corner;
  Base s;
  const double x = (p[0].x + p[1].x + p[2].x) / 3, y = (p[0].y + p[1].y + p[2].y) / 3;
  s.x0 = p[0].x - x, s.x1 = p[1].x - x, s.x2 = p[2].x - x;
  s.y0 = p[0].y - y, s.y1 = p[1].y - y, s.y2 = p[2].y - y;
  s.ux = p[1].x - p[0].x, s.uy = p[1].y - p[0].y;
  s.wx = p[2].x - p[0].x, s.wy = p[2].y - p[0].y;
  const double vx = p[2].x - p[1].x, vy = p[2].y - p[1].y;
  s.turn = fronts.turn;
  s.area = (s.ux * s.wy - s.uy * s.wx) * s.turn;
  s.ll0 = vx * vx + vy * vy, s.ll1 = s.wx * s.wx + s.wy * s.wy, s.ll2 = s.ux * s.ux + s.uy * s.uy;
  s.l0 = std::sqrt(s.ll0), s.l1 = std::sqrt(s.ll1), s.l2 = std::sqrt(s.ll2);
  const double f0 = s.turn / s.l0, f1 = s.turn / s.l1, f2 = s.turn / s.l2;
  s.mx0 = vy * f0, s.my0 = -vx * f0;
  s.mx1 = -s.wy * f1, s.my1 = s.wx * f1;
  s.mx2 = s.uy * f2, s.my2 = -s.ux * f2;
  s.c0 = -(s.mx1 * s.mx2 + s.my1 * s.my2);
  s.c1 = -(s.mx0 * s.mx2 + s.my0 * s.my2);
  s.c2 = -(s.mx0 * s.mx1 + s.my0 * s.my1);
  s.ux *= s.turn, s.uy *= s.turn;
  return s;
}

/// Leaves the greater one, or the lesser, in `a`: of two numbers, or lane by lane.
template <bool kGreatest, typename Values>
TETROPOLIS_INLINE void pick(Values& a, const Values& b) {
  if constexpr (kGreatest)
    a = a < b ? b : a;
  else
    a = b < a ? b : a;
}

/// The greatest of a row and `first`, or the least.
template <bool kGreatest>
TETROPOLIS_INLINE double extreme_of(const double* row, std::size_t count, double first) {
  using Lanes = double __attribute__((vector_size(32)));
  constexpr std::size_t kLanes = sizeof(Lanes) / sizeof(double);
  Lanes best = Lanes{} + first, next;
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    std::memcpy(&next, row + k, sizeof(next));
    pick<kGreatest>(best, next);
  }
  for (std::size_t i = 0; i < kLanes; ++i) pick<kGreatest>(first, double{best[i]});
  for (; k < count; ++k) pick<kGreatest>(first, row[k]);
  return first;
}

/// Of the vector (x, y, z), four times that from where a face is pierced to its centre: the
/// squared skewness. `least`: 16 times the square of the least extent. The face's corners are as
/// high above its centre as h0, h1 and h2.
TETROPOLIS_INLINE double squared_skewness(const Base& s, double x, double y, double z, double least,
                                          double h0, double h1, double h2) {
  const double square = x * x + y * y + z * z;
  const double q0 = std::abs(x * s.x0 + y * s.y0 + z * h0);
  const double q1 = std::abs(x * s.x1 + y * s.y1 + z * h1);
  const double q2 = std::abs(x * s.x2 + y * s.y2 + z * h2);
  const double q = greater(greater(q0, q1), q2);
  return square * square / greater(greater(least * square, 16 * (q * q)), 1e-300);
}

/// Per front: its upward normal, area (twice), longest edge squared, and cosines to the sides.
TETROPOLIS_WIDE void measure_fronts(std::size_t fronts, const Base s, const double* __restrict z0,
                                    const double* __restrict z1, const double* __restrict z2,
                                    double* __restrict nx, double* __restrict ny,
                                    double* __restrict nz, double* __restrict area,
                                    double* __restrict edge2, double* __restrict g0,
                                    double* __restrict g1, double* __restrict g2) {
  for (std::size_t k = 0; k < fronts; ++k) {
    const double h2 = z1[k] - z0[k], h1 = z2[k] - z0[k], h0 = z2[k] - z1[k];
    const double x = s.uy * h1 - s.wy * (h2 * s.turn), y = s.wx * (h2 * s.turn) - s.ux * h1;
    const double square = x * x + y * y + s.area * s.area;
    const double over = 1 / std::sqrt(square);
    area[k] = square * over;
    nx[k] = x * over;
    ny[k] = y * over;
    nz[k] = s.area * over;
    g0[k] = (x * s.mx0 + y * s.my0) * over;
    g1[k] = (x * s.mx1 + y * s.my1) * over;
    g2[k] = (x * s.mx2 + y * s.my2) * over;
    edge2[k] = greater(greater(s.ll0 + h0 * h0, s.ll1 + h1 * h1), s.ll2 + h2 * h2);
  }
}

TETROPOLIS_WIDE void measure_cells(std::size_t cells, const Base s, const double* __restrict z0,
                                   const double* __restrict z1, const double* __restrict z2,
                                   const double* __restrict nx, const double* __restrict ny,
                                   const double* __restrict nz, const double* __restrict area,
                                   const double* __restrict edge2, const double* __restrict g0,
                                   const double* __restrict g1, const double* __restrict g2,
                                   double* __restrict greatest, double* __restrict least,
                                   double* __restrict aspect2, double* __restrict volumes,
                                   double* __restrict px, double* __restrict py,
                                   double* __restrict from, double* __restrict to) {
  for (std::size_t k = 0; k < cells; ++k) {
    const double d0 = z0[k + 1] - z0[k], d1 = z1[k + 1] - z1[k], d2 = z2[k + 1] - z2[k];
    const bool at0 = d0 != 0, at1 = d1 != 0;
    const double rise = d0 + d1 + d2;  // two are zero
    const double between = nx[k] * nx[k + 1] + ny[k] * ny[k + 1] + nz[k] * nz[k + 1];
    const double high0 = greater(g0[k], -g0[k + 1]), low0 = lesser(g0[k], -g0[k + 1]);
    const double high1 = greater(g1[k], -g1[k + 1]), low1 = lesser(g1[k], -g1[k + 1]);
    const double high2 = greater(g2[k], -g2[k + 1]), low2 = lesser(g2[k], -g2[k + 1]);
    const double corner = at0 ? s.c0 : at1 ? s.c1 : s.c2;
    const double high_a = at0 ? high1 : high0, high_b = at0 || at1 ? high2 : high1;
    const double low_a = at0 ? low1 : low0, low_b = at0 || at1 ? low2 : low1;
    greatest[k] = greater(greater(corner, between), greater(high_a, high_b));
    least[k] = lesser(lesser(corner, between), lesser(low_a, low_b));
    const double sides = at0 ? s.l1 + s.l2 : at1 ? s.l0 + s.l2 : s.l0 + s.l1;
    const double surface = area[k] + area[k + 1] + sides * rise;
    const double longest2 = greater(greater(edge2[k], edge2[k + 1]), rise * rise);
    volumes[k] = s.area * rise;
    const double share = surface / (s.area * rise);
    aspect2[k] = longest2 * (1.0 / 24) * (share * share);
    px[k] = at0 ? s.x0 : at1 ? s.x1 : s.x2;
    py[k] = at0 ? s.y0 : at1 ? s.y1 : s.y2;
    from[k] = at0 ? z0[k] : at1 ? z1[k] : z2[k];
    to[k] = at0 ? z0[k + 1] : at1 ? z1[k + 1] : z2[k + 1];
  }
}

/// Faces between cells k and k + 1, for face_shape() in a frame with the triangle's centroid at
/// (0, 0). The centres of these cells are a quarter of (to[k + 1] - from[k], ...) apart.
TETROPOLIS_WIDE void measure_faces(std::size_t faces, const Base s, const double* __restrict z0,
                                   const double* __restrict z1, const double* __restrict z2,
                                   const double* __restrict nx, const double* __restrict ny,
                                   const double* __restrict nz, const double* __restrict px,
                                   const double* __restrict py, const double* __restrict from,
                                   const double* __restrict to, double* __restrict straight2,
                                   double* __restrict skewness2) {
  for (std::size_t k = 0; k < faces; ++k) {
    const double a = z0[k + 1], b = z1[k + 1], c = z2[k + 1], z = (a + b + c) * (1.0 / 3);
    const double x = nx[k + 1], y = ny[k + 1], up = nz[k + 1];
    const double dx = px[k + 1] - px[k], dy = py[k + 1] - py[k], dz = to[k + 1] - from[k];
    const double n_d = x * dx + y * dy + up * dz, dd = dx * dx + dy * dy + dz * dz;
    straight2[k] = n_d * n_d / dd;
    const double tz = z - from[k];
    const double share = (up * tz - x * px[k] - y * py[k]) / n_d;
    skewness2[k] = squared_skewness(s, -px[k] - share * dx, -py[k] - share * dy, tz - share * dz,
                                    0.04 * dd, a - z, b - z, c - z);
  }
}

/// What all faces over an edge share.
struct Gate {
  double length = 0;
  double apart2 = 0;    ///< Squared distance of the opposite corners,
  double through2 = 0;  ///< and of their distances from the edge's line.
  double share = 0;     ///< Of the way from one to the other: where it meets that line
  double x = 0;         ///< so far from the edge's first end.
};

TETROPOLIS_WIDE void measure_strip(std::size_t faces, const Gate s, const double* __restrict a,
                                   const double* __restrict b, const double* __restrict c0,
                                   const double* __restrict c1, double* __restrict straight2,
                                   double* __restrict skewness2) {
  for (std::size_t k = 0; k < faces; ++k) {
    const bool at_a = a[k + 1] != a[k];
    const double dz = c1[k] - c0[k], dd = s.apart2 + dz * dz;
    straight2[k] = s.through2 / dd;
    const double to = at_a ? a[k + 1] : b[k + 1], x_to = at_a ? 0.0 : s.length;
    const double x = (s.length + x_to) * (1.0 / 3), z = (a[k] + b[k] + to) * (1.0 / 3);
    const double sx = x - s.x, sz = z - (c0[k] + s.share * dz);
    const double ss = sx * sx + sz * sz;
    const double q0 = std::abs(sx * -x + sz * (a[k] - z));
    const double q1 = std::abs(sx * (s.length - x) + sz * (b[k] - z));
    const double q2 = std::abs(sx * (x_to - x) + sz * (to - z));
    const double q = greater(greater(q0, q1), q2);
    skewness2[k] = ss * ss / greater(greater(0.04 * (dd * ss), 16 * (q * q)), 1e-300);
  }
}

TETROPOLIS_WIDE CellFigures cell_figures(std::size_t cells, const double* greatest,
                                         const double* least, const double* aspect2,
                                         const double* volumes) {
  CellFigures figures;
  figures.greatest = extreme_of<true>(greatest, cells, figures.greatest);
  figures.least = extreme_of<false>(least, cells, figures.least);
  figures.aspect2 = extreme_of<true>(aspect2, cells, figures.aspect2);
  for (std::size_t k = 0; k < cells; ++k) figures.inverted += volumes[k] > 0 ? 0 : 1;
  return figures;
}

TETROPOLIS_WIDE FaceFigures face_figures(std::size_t faces, const double* straight2,
                                         const double* skewness2) {
  FaceFigures figures;
  figures.straight2 = extreme_of<false>(straight2, faces, figures.straight2);
  figures.skewness2 = extreme_of<true>(skewness2, faces, figures.skewness2);
  return figures;
}

}  // namespace

void FrontStore::add(const ColumnMesh& mesh, TriangleIndex t) {
  const auto& triangle = mesh.ground.triangles[t];
  const std::array<VertexIndex, 3> v = sorted_vertices(triangle);
  const auto [a, b, c] = triangle;
  Place place{{}, used_};
  Fronts& fronts = place.fronts;
  fronts.turn = int{a < b} + int{b < c} + int{c < a} == 2 ? 1 : -1;
  std::array<const double*, 3> at{}, last{}, level{};
  for (std::size_t i = 0; i < 3; ++i) {
    fronts.corner[i] = mesh.ground.vertices[v[i]];
    at[i] = mesh.z.data() + mesh.floor_over(t, v[i]);
    last[i] = mesh.z.data() + mesh.top(v[i]);
    level[i] = mesh.climbing().data() + mesh.floor_over(t, v[i]);
    fronts.cells += static_cast<std::size_t>(last[i] - at[i]);
  }
  places_.push_back(place);
  used_ += 3 * (fronts.cells + 1);
  if (z_.size() < used_) z_.resize(2 * used_);
  double* const z0 = z_.data() + place.first;
  double* const z1 = z0 + fronts.cells + 1;
  double* const z2 = z1 + fronts.cells + 1;
  const auto key = [&](std::size_t i) {
    return at[i] < last[i] ? climbing_key(level[i], NodeIndex(0)) : kInfinity;
  };
  double key0 = key(0), key1 = key(1), key2 = key(2);
  for (std::size_t k = 0;; ++k) {
    z0[k] = *at[0];
    z1[k] = *at[1];
    z2[k] = *at[2];
    if (k == fronts.cells) return;
    // As climbs_first() has it: of those with the least key, the highest vertex.
    if (key2 <= key1 && key2 <= key0) {
      ++at[2], ++level[2];
      key2 = key(2);
    } else if (key1 <= key0) {
      ++at[1], ++level[1];
      key1 = key(1);
    } else {
      ++at[0], ++level[0];
      key0 = key(0);
    }
  }
}

Fronts FrontStore::operator[](std::size_t i) const {
  Fronts fronts = places_[i].fronts;
  const double* const z = z_.data() + places_[i].first;
  const std::size_t row = fronts.cells + 1;
  fronts.z = {z, z + row, z + 2 * row};
  return fronts;
}

void gather_strip(const Fronts& fronts, std::size_t i, Strip& strip) {
  const double* const a = fronts.z[i == 0 ? 1 : 0];
  const double* const b = fronts.z[i == 2 ? 1 : 2];
  const double* const c = fronts.z[i];
  const std::size_t most = fronts.cells + 1;
  if (strip.a.size() < most)
    for (std::vector<double>* row : {&strip.a, &strip.b, &strip.opposite}) row->resize(2 * most);
  double* const to_a = strip.a.data();
  double* const to_b = strip.b.data();
  double* const to_c = strip.opposite.data();
  std::size_t m = 0;
  for (std::size_t k = 0; k < fronts.cells; ++k) {
    to_a[m] = a[k];
    to_b[m] = b[k];
    to_c[m] = c[k];
    m += c[k + 1] == c[k] ? 1 : 0;
  }
  to_a[m] = a[fronts.cells];
  to_b[m] = b[fronts.cells];
  strip.faces = m;
}

void StackKernels::make_room(std::size_t cells) {
  size_ = cells;
  if (cells + 1 <= stride_) return;
  stride_ = 2 * (cells + 1);
  rows_.resize(kRows * stride_);
}

void StackKernels::measure(const Fronts& fronts) {
  const std::size_t cells = fronts.cells;
  make_room(cells);
  const Base base = base_of(fronts);
  const double *const z0 = fronts.z[0], *const z1 = fronts.z[1], *const z2 = fronts.z[2];
  measure_fronts(cells + 1, base, z0, z1, z2, at(kNormalX), at(kNormalY), at(kNormalZ), at(kArea),
                 at(kEdge2), at(kSide0), at(kSide1), at(kSide2));
  measure_cells(cells, base, z0, z1, z2, at(kNormalX), at(kNormalY), at(kNormalZ), at(kArea),
                at(kEdge2), at(kSide0), at(kSide1), at(kSide2), at(kGreatest), at(kLeast),
                at(kAspect2), at(kVolumes), at(kX), at(kY), at(kFrom), at(kTo));
  measure_faces(cells - 1, base, z0, z1, z2, at(kNormalX), at(kNormalY), at(kNormalZ), at(kX),
                at(kY), at(kFrom), at(kTo), at(kStraight2), at(kSkewness2));
  cells_ = cell_figures(cells, at(kGreatest), at(kLeast), at(kAspect2), at(kVolumes));
  faces_ = face_figures(cells - 1, at(kStraight2), at(kSkewness2));
}

FaceFigures StackKernels::measure_between(Point2 a, Point2 b, const std::array<Point2, 2>& opposite,
                                          const std::array<Strip, 2>& strips, std::size_t count) {
  Gate gate;
  const double ux = b.x - a.x, uy = b.y - a.y;
  gate.length = std::sqrt(ux * ux + uy * uy);
  const auto along = [&](Point2 p) { return ((p.x - a.x) * ux + (p.y - a.y) * uy) / gate.length; };
  const auto through = [&](Point2 p) {
    return ((p.y - a.y) * ux - (p.x - a.x) * uy) / gate.length;
  };
  const double y0 = through(opposite[0]), y1 = through(opposite[1]);
  const double x0 = along(opposite[0]), dx = along(opposite[1]) - x0;
  gate.through2 = (y1 - y0) * (y1 - y0);
  gate.apart2 = gate.through2 + dx * dx;
  gate.share = y0 / (y0 - y1);
  gate.x = x0 + gate.share * dx;
  make_room(count);
  const auto from = [&](const std::vector<double>& row, std::size_t side) {
    return row.data() + (strips[side].faces - count);
  };
  measure_strip(count, gate, from(strips[0].a, 0), from(strips[0].b, 0),
                from(strips[0].opposite, 0), from(strips[1].opposite, 1), at(kStraight2),
                at(kSkewness2));
  return face_figures(count, at(kStraight2), at(kSkewness2));
}

}  // namespace tetropolis
