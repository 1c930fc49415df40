#include "ease_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "core/infinity.h"
#include "core/units.h"
#include "volume/quality/prism_shape.h"

namespace tetropolis {

namespace {

/// Bounds that ground is lowered to, over those that it is lowered for.
constexpr double kMargin = 0.98;

struct Tangents {
  double slope, least_cosine, skewness;
};

Tangents tangents_of(const PrismBounds& bounds, double share) {
  return {std::tan(to_radians(share * bounds.slope_deg)),
          std::cos(to_radians(share * bounds.non_orthogonal_deg)), share * bounds.skewness};
}

/// Of the plane through three points.
double slope_of(const std::array<Point3, 3>& p) {
  const double ux = p[1][0] - p[0][0], uy = p[1][1] - p[0][1], uz = p[1][2] - p[0][2];
  const double wx = p[2][0] - p[0][0], wy = p[2][1] - p[0][1], wz = p[2][2] - p[0][2];
  return std::hypot(uy * wz - uz * wy, uz * wx - ux * wz) / std::abs(ux * wy - uy * wx);
}

/// Up to four vertices, of which the highest are brought down.
struct Stencil {
  std::array<VertexIndex, 4> vertices{};
  std::size_t count = 3;
};

class Easing {
 public:
  Easing(const GroundMesh& mesh, const EdgeGraph& edges, std::span<const double> lift, double first,
         const PrismBounds& bounds, std::vector<double>& top)
      : mesh_(mesh),
        edges_(edges),
        lift_(lift),
        first_share_(first / *std::max_element(lift.begin(), lift.end())),
        asked_(tangents_of(bounds, 1)),
        aim_(tangents_of(bounds, kMargin)),
        top_(top),
        is_waiting_(mesh.triangles.size(), 0),
        is_lowered_(mesh.vertices.size(), 0) {}

  void run();
  std::vector<VertexIndex> lowered() const;

 private:
  bool is_open(TriangleIndex t) const { return t != kNoTriangle && !mesh_.inside_building(t); }
  /// Of the ground, if no vertex is higher than `most`.
  double ground(VertexIndex v, double most) const { return std::min(top_[v] - lift_[v], most); }
  std::array<Point3, 3> triangle(TriangleIndex t, double most, double share_of_lift) const;
  Prism prism(TriangleIndex t, double most) const;
  bool is_gentle(TriangleIndex t, double most, const Tangents& bounds) const;
  bool is_good(EdgeIndex e, double most, const Tangents& bounds) const;
  void look_at(TriangleIndex t);
  template <typename IsGood>
  void bring_down(const Stencil& stencil, const IsGood& is_good);
  void lower(const Stencil& stencil, double most);
  void wait(TriangleIndex t);

  const GroundMesh& mesh_;
  const EdgeGraph& edges_;
  std::span<const double> lift_;
  double first_share_;
  Tangents asked_, aim_;
  std::vector<double>& top_;
  std::deque<TriangleIndex> waiting_;
  std::vector<std::uint8_t> is_waiting_, is_lowered_;
};

std::array<Point3, 3> Easing::triangle(TriangleIndex t, double most, double share_of_lift) const {
  std::array<Point3, 3> corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexIndex v = mesh_.triangles[t][i];
    const Point2 p = mesh_.vertices[v];
    corners[i] = {p.x, p.y, ground(v, most) + share_of_lift * lift_[v]};
  }
  return corners;
}

Prism Easing::prism(TriangleIndex t, double most) const {
  return prism_between(triangle(t, most, 0), triangle(t, most, first_share_));
}

bool Easing::is_gentle(TriangleIndex t, double most, const Tangents& bounds) const {
  return slope_of(triangle(t, most, 0)) <= bounds.slope &&
         slope_of(triangle(t, most, 1)) <= bounds.slope;
}

bool Easing::is_good(EdgeIndex e, double most, const Tangents& bounds) const {
  const auto& [t, other] = edges_.triangles[e];
  const TriangleIndex own = is_open(t) ? t : other, beyond = is_open(t) ? other : t;
  const Prism here = prism(own, most);
  std::size_t side = 0;
  const auto& corners = mesh_.triangles[own];
  const auto& ends = edges_.vertices[e];
  while (std::find(ends.begin(), ends.end(), corners[(side + 2) % 3]) != ends.end()) ++side;
  const PrismFace& face = here.faces[2 + side];
  if (!is_open(beyond)) return skewness_at_boundary(face, here.centre) <= bounds.skewness;
  const Point3 there = prism(beyond, most).centre;
  return cosine_across(face, here.centre, there) >= bounds.least_cosine &&
         skewness_across(face, here.centre, there) <= bounds.skewness;
}

void Easing::wait(TriangleIndex t) {
  if (!is_open(t) || is_waiting_[t] != 0) return;
  is_waiting_[t] = 1;
  waiting_.push_back(t);
}

void Easing::lower(const Stencil& stencil, double most) {
  std::vector<VertexIndex> moved;
  for (std::size_t i = 0; i < stencil.count; ++i) {
    const VertexIndex v = stencil.vertices[i];
    if (!(top_[v] - lift_[v] > most)) continue;
    top_[v] = most + lift_[v];
    is_lowered_[v] = 1;
    moved.push_back(v);
  }
  for (const TriangleIndex t : triangles_around(edges_, moved)) wait(t);
}

/// The least that makes is_good(most) true; nothing if flat ground does not.
template <typename IsGood>
void Easing::bring_down(const Stencil& stencil, const IsGood& is_good) {
  double low = kInfinity, high = -kInfinity;
  for (std::size_t i = 0; i < stencil.count; ++i) {
    const double z = ground(stencil.vertices[i], kInfinity);
    low = std::min(low, z);
    high = std::max(high, z);
  }
  constexpr double kNothing = 1e-3;  // metres
  if (high - low < kNothing || !is_good(low)) return;
  while (high - low > kNothing) {
    const double middle = (low + high) / 2;
    (is_good(middle) ? low : high) = middle;
  }
  lower(stencil, low);
}

void Easing::look_at(TriangleIndex t) {
  const auto& v = mesh_.triangles[t];
  if (!is_gentle(t, kInfinity, asked_))
    bring_down({{v[0], v[1], v[2], {}}, 3}, [&](double most) { return is_gentle(t, most, aim_); });
  for (const EdgeIndex e : edges_.of_triangle[t]) {
    if (is_good(e, kInfinity, asked_)) continue;
    Stencil stencil{{v[0], v[1], v[2], {}}, 3};
    const auto& [a, b] = edges_.triangles[e];
    const TriangleIndex beyond = a == t ? b : a;
    if (is_open(beyond))
      for (const VertexIndex u : mesh_.triangles[beyond])
        if (std::find(v.begin(), v.end(), u) == v.end()) stencil.vertices[stencil.count++] = u;
    bring_down(stencil, [&](double most) { return is_good(e, most, aim_); });
  }
}

void Easing::run() {
  for (const TriangleIndex t : mesh_.triangles.indices()) wait(t);
  while (!waiting_.empty()) {
    const TriangleIndex t = waiting_.front();
    waiting_.pop_front();
    is_waiting_[t] = 0;
    look_at(t);
  }
}

std::vector<VertexIndex> Easing::lowered() const {
  std::vector<VertexIndex> vertices;
  for (const VertexIndex v : mesh_.vertices.indices())
    if (is_lowered_[v] != 0) vertices.push_back(v);
  return vertices;
}

}  // namespace

std::vector<VertexIndex> ease_ground(const GroundMesh& mesh, const EdgeGraph& edges,
                                     std::span<const double> lift, double first,
                                     const PrismBounds& bounds, std::vector<double>& ground) {
  Easing easing(mesh, edges, lift, first, bounds, ground);
  easing.run();
  return easing.lowered();
}

}  // namespace tetropolis
