#include "tri_mesh.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tetropolis {

void TriMesh::start(std::int32_t a, std::int32_t b, std::int32_t c) {
  const std::int32_t v[3] = {a, b, c};
  triangles.assign(4, {});
  tri(0) = {{a, b, c}, {4 * 1, 4 * 2, 4 * 3}, 0, 0};
  for (std::int32_t i = 0; i < 3; ++i) {
    // Ghost 1 + i lies behind edge i, which runs from v[i+1] to v[i+2].
    const std::int32_t from = v[(i + 2) % 3];
    const std::int32_t to = v[(i + 1) % 3];
    // The ghost's edge opposite `from` joins `to` and the ghost vertex: shared with the ghost
    // behind the edge that starts at... the other edge at `to`, which is edge i + 2.
    tri(1 + i) = {
        {kGhost, from, to}, {i, 4 * (1 + (i + 2) % 3) + 2, 4 * (1 + (i + 1) % 3) + 1}, 0, 0};
  }
  if (tracking) {
    some_triangle.assign(points.size(), kNothing);
    for (const std::int32_t x : v) track(x, 0);
  }
}

bool TriMesh::in_ghost(const Triangle& x, Point2 p) const {
  const int g = x.v[0] < 0 ? 0 : x.v[1] < 0 ? 1 : 2;
  const Point2 a = point(x.v[(g + 1) % 3]);
  const Point2 b = point(x.v[(g + 2) % 3]);
  const int side = orient2d(a, b, p);
  if (side != 0) return side > 0;
  // On the line of the hull edge: strictly between its ends.
  const double from_a = (p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y);
  const double from_b = (p.x - b.x) * (a.x - b.x) + (p.y - b.y) * (a.y - b.y);
  return from_a > 0 && from_b > 0;
}

TriMesh::Location TriMesh::locate(Point2 p, std::int32_t from) const {
  std::int32_t t = from;
  if (ghost(t)) {
    const Triangle& x = tri(t);
    const int g = x.v[0] < 0 ? 0 : x.v[1] < 0 ? 1 : 2;
    t = across(4 * t + g) >> 2;
  }
  std::int32_t entry = kNothing;
  // Which of two possible ways to take is alternated pseudo-randomly: in a triangulation that is
  // not Delaunay a fixed choice can go in circles.
  std::uint32_t dice = 0x9e3779b9U;
  for (;;) {
    const Triangle& x = tri(t);
    const Point2 v[3] = {point(x.v[0]), point(x.v[1]), point(x.v[2])};
    dice = dice * 1664525U + 1013904223U;
    const int first = entry < 0 ? 0 : (entry + 1 + static_cast<int>(dice >> 31)) % 3;
    const int second = entry < 0 ? 1 : 3 - entry - first;
    int sides[3] = {1, 1, 1};
    std::int32_t out = kNothing;
    // The edge it came in by needs no test: p is strictly on this side of it.
    for (const int i : {first, second, entry < 0 ? 2 : -1}) {
      if (i < 0) break;
      sides[i] = orient2d(v[(i + 1) % 3], v[(i + 2) % 3], p);
      if (sides[i] < 0) {
        out = i;
        break;
      }
    }
    if (out == kNothing) {
      Location where{t, kNothing, kNothing};
      for (std::int32_t k = 0; k < 3; ++k) {
        if (v[k] == p) where.vertex = x.v[k];
        if (sides[k] == 0) where.edge = k;
      }
      return where;
    }
    const std::int32_t other = across(4 * t + out);
    if (other < 0) return {};
    t = other >> 2;
    entry = other & 3;
    if (ghost(t)) return {t, kNothing, kNothing};
  }
}

void TriMesh::find_cavity(Point2 p, std::int32_t t) {
  cavity.clear();
  cavity_dead_.clear();
  cavity_dead_.push_back(t);
  stack_.assign({4 * t + 2, 4 * t + 1, 4 * t});
  while (!stack_.empty()) {
    const std::int32_t he = stack_.back();
    stack_.pop_back();
    const std::int32_t n = link(he);
    if (n >= 0 && in_circumcircle(n >> 2, p)) {
      cavity_dead_.push_back(n >> 2);
      stack_.push_back(prev(n));
      stack_.push_back(next(n));
    } else {
      cavity.push_back({origin(he), target(he), n});
    }
  }
  assert(cavity.size() == cavity_dead_.size() + 2);
}

void TriMesh::fill_cavity(std::int32_t vertex) {
  const std::int32_t region = tri(cavity_dead_[0]).region;
  slots_ = cavity_dead_;
  slots_.push_back(new_triangle());
  slots_.push_back(new_triangle());
  const std::size_t k = cavity.size();
  for (std::size_t i = 0; i < k; ++i) {
    const std::int32_t t = slots_[i];
    const std::int32_t after = slots_[i + 1 == k ? 0 : i + 1];
    const std::int32_t before = slots_[i == 0 ? k - 1 : i - 1];
    const CavityEdge& e = cavity[i];
    tri(t) = {{vertex, e.a, e.b}, {e.link, 4 * after + 2, 4 * before + 1}, region, 0};
    attach(e.link, 4 * t, e.a);
    if (tracking) track(e.a, t);
  }
  if (tracking) track(vertex, slots_[0]);
  touched.insert(touched.end(), slots_.begin(), slots_.end());
}

void TriMesh::flip(std::int32_t he) {
  const std::int32_t t = he >> 2;
  const std::int32_t other = link(he);
  assert(other >= 0);
  const std::int32_t u = other >> 2;
  Triangle& x = tri(t);
  Triangle& y = tri(u);
  const int i = he & 3;
  const int j = other & 3;
  const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  const std::int32_t p = x.v[i], a = x.v[i1], b = x.v[i2], q = y.v[j];
  const std::int32_t aq = y.n[j1], pa = x.n[i2], qb = y.n[j2], bp = x.n[i1];
  x = {{p, a, q}, {aq, 4 * u + 2, pa}, x.region, 0};
  y = {{p, q, b}, {qb, bp, 4 * t + 1}, y.region, 0};
  attach(aq, 4 * t + 0, a);
  attach(pa, 4 * t + 2, p);
  attach(qb, 4 * u + 0, q);
  attach(bp, 4 * u + 1, b);
  if (tracking) {
    track(p, t);
    track(a, t);
    track(q, t);
    track(b, u);
  }
  touched.push_back(t);
  touched.push_back(u);
}

bool TriMesh::locally_delaunay(std::int32_t he) const {
  const std::int32_t n = link(he);
  if (n < 0) return true;
  const std::int32_t q = apex(n);
  if (q >= 0) return !in_circumcircle(he >> 2, point(q));
  // The ghost vertex is in no circle; the other side of the edge decides.
  const std::int32_t p = apex(he);
  return p < 0 || !in_circumcircle(n >> 2, point(p));
}

void TriMesh::restore_delaunay() {
  while (!pending_.empty()) {
    const std::int32_t he = pending_.back();
    pending_.pop_back();
    if (dead(he >> 2) || locally_delaunay(he)) continue;
    const std::int32_t t = he >> 2;
    const std::int32_t u = link(he) >> 2;
    flip(he);
    // The four outer edges: a stale entry on the stack may name another edge by now, but every edge
    // that is in doubt has an entry that names it.
    for (const std::int32_t outer : {4 * t, 4 * t + 2, 4 * u, 4 * u + 1}) pending_.push_back(outer);
  }
}

std::int32_t TriMesh::split_subsegment(std::int32_t s, std::int32_t vertex) {
  const Point2 p = point(vertex);
  for (const std::int32_t he : sub(s).side) {
    if (he < 0 || ghost(he >> 2)) continue;
    const Point2 w = point(apex(he));
    if (orient2d(w, point(origin(he)), p) <= 0 || orient2d(p, point(target(he)), w) <= 0)
      return kNothing;
  }
  const Subsegment old = sub(s);
  const std::int32_t s2 = static_cast<std::int32_t>(subsegments.size());
  subsegments.push_back({{vertex, old.v[1]}, {kNothing, kNothing}, old.piece, false});
  sub(s).v[1] = vertex;
  std::int32_t halves[2][2] = {{kNothing, kNothing}, {kNothing, kNothing}};
  for (int k = 0; k < 2; ++k) {
    const std::int32_t he = old.side[k];
    if (he < 0) continue;
    const std::int32_t t = he >> 2;
    const int i = he & 3;
    const Triangle x = tri(t);
    const std::int32_t w = x.v[i], a = x.v[(i + 1) % 3], b = x.v[(i + 2) % 3];
    const std::int32_t wa = x.n[(i + 2) % 3], bw = x.n[(i + 1) % 3];
    const std::int32_t u = new_triangle();
    // Vertex 0 is the new one; the halves of the subsegment are edge 1 of t (behind w: a to the
    // vertex) and edge 2 of u.
    const std::int32_t first = k == 0 ? ~s : ~s2;
    const std::int32_t second = k == 0 ? ~s2 : ~s;
    tri(t) = {{vertex, w, a}, {wa, first, 4 * u + 1}, x.region, 0};
    tri(u) = {{vertex, b, w}, {bw, 4 * t + 2, second}, x.region, 0};
    attach(wa, 4 * t, w);
    attach(bw, 4 * u, b);
    halves[k][0] = 4 * t + 1;
    halves[k][1] = 4 * u + 2;
    if (tracking) {
      track(w, t);
      track(a, t);
      track(b, u);
      track(vertex, t);
    }
    touched.push_back(t);
    touched.push_back(u);
    pending_.push_back(4 * t);
    pending_.push_back(4 * u);
    // Only in doubt if the vertex is off the line: rounding may bend the subsegment.
    pending_.push_back(4 * t + 2);
  }
  sub(s).side[0] = halves[0][0];
  sub(s2).side[0] = halves[0][1];
  sub(s2).side[1] = halves[1][0];
  sub(s).side[1] = halves[1][1];
  restore_delaunay();
  return s2;
}

bool TriMesh::remove_vertex(std::int32_t start_he) {
  const std::int32_t v = apex(start_he);
  const std::size_t first = touched.size();
  const auto own_edges_in_doubt = [&] {
    for (std::size_t k = first; k < touched.size(); ++k)
      if (!dead(touched[k]))
        for (std::int32_t i = 0; i < 3; ++i) pending_.push_back(4 * touched[k] + i);
  };
  std::int32_t he = start_he;
  int degree = 0;
  around(he, [&](std::int32_t) { return ++degree, false; });
  // Turn spokes away while there are more than three. A spoke whose quadrilateral is strictly
  // convex exists unless v lies on a diagonal of it; the Delaunay property is restored afterwards.
  int idle = 0;
  while (degree > 3) {
    // The spoke from v to the first vertex of the rim edge he.
    const std::int32_t spoke = prev(he);
    const std::int32_t other = across(spoke);
    const Point2 y = point(target(he));
    const Point2 x = point(apex(other));
    const Point2 rim = point(origin(he));
    const bool convex = orient2d(x, rim, y) > 0 && orient2d(y, point(v), x) > 0;
    if (!convex) {
      if (++idle > degree) break;
      he = next(across(next(he)));
      continue;
    }
    const std::int32_t t = he >> 2;
    flip(spoke);
    idle = 0;
    --degree;
    he = opposite(t, v);  // the former neighbour has lost v
  }
  if (degree > 3) {
    own_edges_in_doubt();
    restore_delaunay();
    return false;
  }
  const std::int32_t h[3] = {he, next(across(next(he))),
                             next(across(next(next(across(next(he))))))};
  const std::int32_t t = he >> 2;
  const std::int32_t corner[3] = {origin(h[0]), origin(h[1]), origin(h[2])};
  const std::int32_t out[3] = {link(h[0]), link(h[1]), link(h[2])};
  const std::int32_t region = tri(t).region;
  // Their places stay empty: whoever took them would have numbers, and so a turn, by where else
  // vertices were removed.
  for (const int k : {1, 2}) tri(h[k] >> 2).v[0] = kDead;
  // Rim edge k runs from corner k to corner k + 1 and is opposite to corner k + 2.
  tri(t) = {{corner[0], corner[1], corner[2]}, {out[1], out[2], out[0]}, region, 0};
  attach(out[1], 4 * t, corner[1]);
  attach(out[2], 4 * t + 1, corner[2]);
  attach(out[0], 4 * t + 2, corner[0]);
  if (tracking)
    for (const std::int32_t c : corner) track(c, t);
  touched.push_back(t);
  own_edges_in_doubt();
  restore_delaunay();
  return true;
}

std::int32_t TriMesh::constrain(std::int32_t he, std::int32_t piece) {
  const std::int32_t n = link(he);
  if (n < 0) return ~n;
  const std::int32_t s = static_cast<std::int32_t>(subsegments.size());
  subsegments.push_back({{origin(he), target(he)}, {he, n}, piece, false});
  tri(he >> 2).n[he & 3] = ~s;
  tri(n >> 2).n[n & 3] = ~s;
  return s;
}

void TriMesh::release(std::int32_t s) {
  const std::int32_t left = sub(s).side[0];
  const std::int32_t right = sub(s).side[1];
  tri(left >> 2).n[left & 3] = right;
  tri(right >> 2).n[right & 3] = left;
  sub(s).v[0] = kDead;
}

std::int32_t TriMesh::find_edge(std::int32_t a, std::int32_t b) const {
  const auto first_at = [&](std::int32_t v) {
    return opposite(some_triangle[static_cast<std::size_t>(v)], v);
  };
  const auto turned = [&](std::int32_t he) {
    const std::int32_t other = across(next(he));
    return other < 0 ? kNothing : next(other);
  };
  // Around both at the same pace: at one of them thousands of edges may meet.
  const std::int32_t first_a = first_at(a), first_b = first_at(b);
  std::int32_t at_a = first_a, at_b = first_b;
  do {
    // The edge from an apex to the origin of its half-edge is the one before that.
    if (origin(at_a) == b) return prev(at_a);
    if (origin(at_b) == a) return across(prev(at_b));
    at_a = turned(at_a);
    at_b = turned(at_b);
  } while (at_a >= 0 && at_b >= 0 && at_a != first_a && at_b != first_b);
  return kNothing;
}

void TriMesh::renumber(const std::vector<std::int32_t>& number) {
  const auto count = std::count_if(number.begin(), number.end(), [](auto t) { return t >= 0; });
  std::vector<Triangle> kept;
  kept.reserve(triangles.capacity());
  kept.resize(static_cast<std::size_t>(count));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (number[t] < 0) continue;
    Triangle x = triangles[t];
    for (std::int32_t& n : x.n)
      if (n >= 0) n = 4 * number[static_cast<std::size_t>(n >> 2)] + (n & 3);
    kept[static_cast<std::size_t>(number[t])] = x;
  }
  triangles.swap(kept);
  for (Subsegment& s : subsegments) {
    if (s.v[0] == kDead) continue;
    for (std::int32_t& he : s.side) {
      if (he < 0) continue;
      const std::int32_t t = number[static_cast<std::size_t>(he >> 2)];
      he = t < 0 ? kNothing : 4 * t + (he & 3);
    }
    if (s.side[0] < 0 && s.side[1] < 0) s.v[0] = kDead;
  }
  some_triangle.clear();
  tracking = false;
}

}  // namespace tetropolis
