// Moves free vertices after the refinement: to widen the smallest angles around them, then, where
// the terrain is known, to make steep triangles less steep.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/units.h"
#include "geometry/slope.h"
#include "geometry/vec2.h"
#include "refiner.h"

namespace tetropolis {

namespace {

// Only where an angle is below this is it worth trying, in degrees: measured on cities, more gains
// little and costs as much again.
constexpr double kContentAngle = 36;
// A move has to widen the smallest angle by a hundredth, or it is not worth making.
constexpr double kGain = 1.02;
constexpr std::size_t kMaxDegree = 16;

// Found by trial, on villages with rock walls of 20 m in meshes of 5 m: only triangles steeper than
// this leave thin cells, more sweeps change nothing, and fewer places leave more of them.
constexpr double kSteepDeg = 72;
constexpr int kFlatteningSweeps = 3;
constexpr int kDirections = 16;
constexpr std::array kReaches{0.03, 0.06, 0.12, 0.24, 0.48};  // shares of the mean edge
constexpr std::size_t kTrianglesPerChunk = 8192;

// Squared sine of the smallest angle; negative if the triangle is not counter-clockwise.
double squared_sine(Point2 p, Point2 a, Point2 b) {
  const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
  const double cx = b.x - a.x, cy = b.y - a.y;
  const double cross = ax * by - ay * bx;
  const double pa = ax * ax + ay * ay, pb = bx * bx + by * by, ab = cx * cx + cy * cy;
  const double q = cross * cross * std::min({pa, pb, ab}) / (pa * pb * ab);
  return cross > 0 ? q : -1;
}

// The triangles around a vertex: half-edges opposite to it and the points where they start.
struct Star {
  std::size_t size = 0;
  std::array<std::int32_t, kMaxDegree> rim;
  std::array<Point2, kMaxDegree> ring;

  Point2 after(std::size_t i) const { return ring[i + 1 == size ? 0 : i + 1]; }
  Point2 before(std::size_t i) const { return ring[i == 0 ? size - 1 : i - 1]; }
  double worst(Point2 p, double give_up) const {
    double q = 1;
    for (std::size_t i = 0; i < size && q > give_up; ++i)
      q = std::min(q, squared_sine(p, ring[i], after(i)));
    return q;
  }
};

bool gather(const TriMesh& mesh, std::int32_t he, Star& star) {
  star.size = 0;
  bool fits = true;
  mesh.around(he, [&](std::int32_t rim) {
    if (star.size == kMaxDegree) return !(fits = false);
    star.rim[star.size] = rim;
    star.ring[star.size++] = mesh.point(mesh.origin(rim));
    return false;
  });
  return fits;
}

// Two places that tend to be better: the minimiser of the interpolation error of a paraboloid over
// the star (Chen 2004, "Mesh smoothing schemes based on optimal Delaunay triangulations": the
// circumcentres weighted by area) and the mean of the neighbours; and half the way to each.
std::array<Point2, 4> candidates(const Star& star, Point2 p) {
  double ox = 0, oy = 0, weight = 0, lx = 0, ly = 0;
  for (std::size_t i = 0; i < star.size; ++i) {
    const Point2 a = star.ring[i], b = star.after(i);
    const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y;
    const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by;
    ox += 0.5 * (by * a2 - ay * b2);
    oy += 0.5 * (ax * b2 - bx * a2);
    weight += ax * by - ay * bx;
    lx += ax;
    ly += ay;
  }
  ox /= weight;
  oy /= weight;
  lx /= static_cast<double>(star.size);
  ly /= static_cast<double>(star.size);
  return {Point2{p.x + ox, p.y + oy}, Point2{p.x + lx, p.y + ly},
          Point2{p.x + 0.5 * ox, p.y + 0.5 * oy}, Point2{p.x + 0.5 * lx, p.y + 0.5 * ly}};
}

// Whether the star stays counter-clockwise and constrained Delaunay with its centre at p.
bool stays_delaunay(const TriMesh& mesh, const Star& star, Point2 p) {
  for (std::size_t i = 0; i < star.size; ++i) {
    const Point2 a = star.ring[i], b = star.after(i);
    if (orient2d(p, a, b) <= 0) return false;
  }
  for (std::size_t i = 0; i < star.size; ++i) {
    const Point2 a = star.ring[i], b = star.after(i);
    const std::int32_t beyond = mesh.link(star.rim[i]);
    if (beyond >= 0 && incircle(p, a, b, mesh.point(mesh.apex(beyond))) > 0) return false;
    if (incircle(p, star.before(i), a, b) > 0) return false;
  }
  return true;
}

}  // namespace

void Refiner::optimize(const Progress& progress) {
  const double sine = std::sin(to_radians(kContentAngle));
  const double content = sine * sine;
  std::vector<char> tried(mesh_.points.size(), 0);
  const auto visit = [&](std::int32_t t) {
    const TriMesh::Triangle& x = mesh_.tri(t);
    if (x.v[0] == TriMesh::kDead) return;
    if (squared_sine(mesh_.point(x.v[0]), mesh_.point(x.v[1]), mesh_.point(x.v[2])) >= content)
      return;
    for (std::int32_t i = 0; i < 3; ++i)
      if (kind(x.v[i]) == kFreeVertex && !std::exchange(tried[static_cast<std::size_t>(x.v[i])], 1))
        move_vertex(x.v[i], 4 * t + i, content);
  };
  const auto count = static_cast<std::int32_t>(mesh_.triangles.size());
  for (std::int32_t t = 0; t < count; ++t) {
    if ((t & 0xfff) == 0) progress.update(static_cast<double>(t) / count);
    visit(t);
  }
}

bool Refiner::move_vertex(std::int32_t v, std::int32_t he, double content) {
  Star star;
  if (!gather(mesh_, he, star)) return false;
  const Point2 p = mesh_.point(v);
  double quality = star.worst(p, 0);
  // What is excused by a sharp corner must stay as it is to be excused.
  if (quality >= content || quality < sine_squared_) return false;
  bool moved = false;
  quality *= kGain;
  const std::array<Point2, 4> places = candidates(star, p);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (k == 2 && moved) break;  // half the way is for when all of it is too far
    const Point2 q = places[k];
    const double better = star.worst(q, quality);
    if (better <= quality || !edges_fit(star.rim.data(), star.size, q)) continue;
    if (!stays_delaunay(mesh_, star, q)) continue;
    mesh_.point(v) = q;
    quality = better;
    moved = true;
  }
  return moved;
}

// The lowest and the highest vertex of a triangle are joined by cells that are the thinner the
// steeper it is, with whatever nodes; how steep it is follows from where its corners are.
void Refiner::flatten(const Progress& progress) {
  elevations_.resize(mesh_.points.size());
  parallel_chunks(elevations_.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) elevations_[v] = options_.elevation(mesh_.points[v]);
  });
  const double cosine = std::cos(to_radians(kSteepDeg));
  const double content = cosine * cosine;
  std::vector<std::vector<std::int32_t>> chunks((mesh_.triangles.size() + kTrianglesPerChunk - 1) /
                                                kTrianglesPerChunk);
  for (int sweep = 0; sweep < kFlatteningSweeps; ++sweep) {
    parallel_chunks(mesh_.triangles.size(), kTrianglesPerChunk,
                    [&](std::size_t begin, std::size_t end) {
                      std::vector<std::int32_t>& steep = chunks[begin / kTrianglesPerChunk];
                      steep.clear();
                      for (std::size_t t = begin; t < end; ++t)
                        if (is_open(mesh_.triangles[t]) && flatness(mesh_.triangles[t]) < content)
                          steep.push_back(static_cast<std::int32_t>(t));
                    });
    bool moved = false;
    std::vector<char> tried(mesh_.points.size(), 0);
    for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
      progress.update((sweep + static_cast<double>(chunk) / static_cast<double>(chunks.size())) /
                      kFlatteningSweeps);
      for (const std::int32_t t : chunks[chunk])
        for (std::int32_t i = 0; i < 3; ++i) {
          const std::int32_t v = mesh_.tri(t).v[i];
          if (kind(v) != kFreeVertex || std::exchange(tried[static_cast<std::size_t>(v)], 1) != 0)
            continue;
          if (flatten_around(v, 4 * t + i, content)) moved = true;
        }
    }
    if (!moved) return;
  }
}

double Refiner::flatness(const TriMesh::Triangle& x) const {
  const auto z = [&](int i) { return elevation(x.v[i]); };
  return squared_cosine_of_slope(mesh_.point(x.v[0]), z(0), mesh_.point(x.v[1]), z(1),
                                 mesh_.point(x.v[2]), z(2));
}

bool Refiner::flatten_around(std::int32_t v, std::int32_t he, double content) {
  Star star;
  if (!gather(mesh_, he, star)) return false;
  const Point2 p = mesh_.point(v);
  // What is excused by a sharp corner must stay as it is to be excused.
  if (star.worst(p, 0) < sine_squared_) return false;
  std::array<double, kMaxDegree> z{};
  double edges = 0;
  for (std::size_t i = 0; i < star.size; ++i) {
    z[i] = elevation(mesh_.origin(star.rim[i]));
    edges += distance(star.ring[i], p);
  }
  const double mean = edges / static_cast<double>(star.size);
  const auto steepest_with = [&](Point2 q, double zq, double give_up) {
    double least = 1;
    for (std::size_t i = 0; i < star.size && least > give_up; ++i)
      least = std::min(least, squared_cosine_of_slope(q, zq, star.ring[i], z[i], star.after(i),
                                                      z[i + 1 == star.size ? 0 : i + 1]));
    return least;
  };
  double best = steepest_with(p, elevation(v), 0);
  if (best >= content) return false;
  best *= kGain;
  bool moved = false;
  for (const double reach : kReaches)
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kDirections;
      const Point2 q{p.x + reach * mean * std::cos(angle), p.y + reach * mean * std::sin(angle)};
      // A little more than the least angle, against rounding.
      if (star.worst(q, sine_squared_) <= sine_squared_ * (1 + 1e-9)) continue;
      const double zq = options_.elevation(q);
      const double flat = steepest_with(q, zq, best);
      if (flat <= best || !edges_fit(star.rim.data(), star.size, q) ||
          !stays_delaunay(mesh_, star, q))
        continue;
      best = flat;
      mesh_.point(v) = q;
      elevation(v) = zq;
      moved = true;
    }
  return moved;
}

bool Refiner::edges_fit(const std::int32_t* rim, std::size_t count, Point2 p) const {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t v = mesh_.origin(rim[i]);
    const Point2 a = mesh_.point(v);
    const double dx = a.x - p.x, dy = a.y - p.y, squared = dx * dx + dy * dy;
    if (squared > size_.squared(mesh_.tri(rim[i] >> 2).region, a, p)) return false;
    if (size_.by_segment() && squared > bound_at(v) * bound_at(v)) return false;
  }
  return true;
}

}  // namespace tetropolis
