// The triangle store that triangulation and refinement work on, and its local operations.
//
// A half-edge is 4 * triangle + edge; edge i is opposite to vertex i and runs from vertex i + 1 to
// vertex i + 2 (see triangulation.h). Links across an edge are either a half-edge (>= 0) or, where
// a subsegment lies between, its complement ~index (< 0): searches that must not cross segments
// stop at any negative number. Ghost triangles, with kGhost for a vertex, surround the convex hull
// until renumber() leaves them out; then the boundary consists of subsegments with one side.
#pragma once

#include <cstdint>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "geometry/predicates.h"

namespace tetropolis {

/// Half-edges have to fit into 31 bits: 4 for each of the two triangles that a vertex brings.
inline constexpr std::int64_t kMostVertices = 250'000'000;

class TriMesh {
 public:
  static constexpr std::int32_t kGhost = -1;
  static constexpr std::int32_t kDead = -2;
  static constexpr std::int32_t kNothing = -1;

  struct alignas(32) Triangle {
    std::int32_t v[3];
    std::int32_t n[3];
    std::int32_t region;
    std::int32_t considered;  ///< The refiner's mark; 0 in every triangle that an operation makes.
  };

  /// side[0] is the half-edge that runs from v[0] to v[1], side[1] the one back; or kNothing.
  struct Subsegment {
    std::int32_t v[2];
    std::int32_t side[2];
    std::int32_t piece;
    bool frozen = false;  ///< Too short, or too close to a vertex, to be split again.
  };

  /// Where a point is: in `triangle` (perhaps a ghost), on its edge `edge` if >= 0, at `vertex` if
  /// >= 0.
  struct Location {
    std::int32_t triangle = kNothing;
    std::int32_t edge = kNothing;
    std::int32_t vertex = kNothing;
  };

  /// A side of the hole that an insertion tears, counter-clockwise around the new point.
  struct CavityEdge {
    std::int32_t a;
    std::int32_t b;
    std::int32_t link;
  };

  std::vector<Point2> points;
  std::vector<Triangle> triangles;          ///< Dead ones have v[0] == kDead.
  std::vector<Subsegment> subsegments;      ///< Dead ones have v[0] == kDead.
  std::vector<std::int32_t> some_triangle;  ///< Of each vertex; kept up only while `tracking`.
  bool tracking = false;

  /// The triangles that the last operations made, unless reset; may repeat and hold dead ones.
  std::vector<std::int32_t> touched;
  std::vector<CavityEdge> cavity;

  static std::int32_t triangle_of(std::int32_t he) { return he >> 2; }
  static std::int32_t next(std::int32_t he) { return (he & 3) == 2 ? he - 2 : he + 1; }
  static std::int32_t prev(std::int32_t he) { return (he & 3) == 0 ? he + 2 : he - 1; }

  Triangle& tri(std::int32_t t) { return triangles[static_cast<std::size_t>(t)]; }
  const Triangle& tri(std::int32_t t) const { return triangles[static_cast<std::size_t>(t)]; }
  Subsegment& sub(std::int32_t s) { return subsegments[static_cast<std::size_t>(s)]; }
  const Subsegment& sub(std::int32_t s) const { return subsegments[static_cast<std::size_t>(s)]; }
  Point2& point(std::int32_t v) { return points[static_cast<std::size_t>(v)]; }
  Point2 point(std::int32_t v) const { return points[static_cast<std::size_t>(v)]; }

  std::int32_t& some_triangle_at(std::int32_t v) {
    return some_triangle[static_cast<std::size_t>(v)];
  }

  std::int32_t apex(std::int32_t he) const { return tri(he >> 2).v[he & 3]; }
  std::int32_t origin(std::int32_t he) const { return apex(next(he)); }
  std::int32_t target(std::int32_t he) const { return apex(prev(he)); }
  std::int32_t link(std::int32_t he) const { return tri(he >> 2).n[he & 3]; }

  /// The half-edge on the other side, also across a subsegment; kNothing on a carved boundary.
  std::int32_t across(std::int32_t he) const {
    const std::int32_t n = link(he);
    if (n >= 0) return n;
    const Subsegment& s = sub(~n);
    return s.side[s.side[0] == he ? 1 : 0];
  }

  bool dead(std::int32_t t) const { return tri(t).v[0] == kDead; }
  bool ghost(std::int32_t t) const {
    const Triangle& x = tri(t);
    return (x.v[0] | x.v[1] | x.v[2]) < 0;
  }

  /// Appends a point; it belongs to no triangle yet.
  std::int32_t add_point(Point2 p) {
    points.push_back(p);
    if (tracking) some_triangle.push_back(kNothing);
    return static_cast<std::int32_t>(points.size()) - 1;
  }

  /// Two triangles' worth of mesh around the counter-clockwise triangle a, b, c: itself and ghosts.
  void start(std::int32_t a, std::int32_t b, std::int32_t c);

  /// Walks from `from` to `p`, through segments as well. Without ghosts the domain must be convex.
  Location locate(Point2 p, std::int32_t from) const;

  /// Fills `cavity` for inserting `p`, which lies in (or on an edge, not a subsegment, of) triangle
  /// `t`: all triangles around whose circumcircle contains p, bounded by subsegments.
  void find_cavity(Point2 p, std::int32_t t);

  /// Replaces the triangles of the last find_cavity() by the star of `vertex`; appends to touched.
  void fill_cavity(std::int32_t vertex);

  /// Splits subsegment `s` at `vertex` into s (first half) and a new one (returned), and restores
  /// the Delaunay property. Returns kNothing, with the mesh unchanged, if the vertex lies too far
  /// off the line for the neighbouring triangles. Appends to touched.
  std::int32_t split_subsegment(std::int32_t s, std::int32_t vertex);

  /// Turns the edge of the two triangles at `he`; not a subsegment, quadrilateral strictly convex.
  /// Afterwards triangle_of(he) and its former neighbour meet at the former apexes, first of all
  /// the apex of he, which is vertex 0 of both. Appends both to touched.
  void flip(std::int32_t he);

  void push_pending(std::int32_t he) { pending_.push_back(he); }
  /// Flips until the pending edges and all they affect are locally Delaunay.
  void restore_delaunay();

  /// Removes a vertex that is on no subsegment and surrounded by triangles; `he` has it as apex.
  /// Returns false, having only flipped, where degenerate position forbids.
  bool remove_vertex(std::int32_t he);

  /// Makes the edge `he` a subsegment directed like he. Returns the existing one if it is one.
  std::int32_t constrain(std::int32_t he, std::int32_t piece);
  /// Makes a subsegment an ordinary edge.
  void release(std::int32_t s);

  /// The half-edge from a to b, or kNothing. Needs tracking.
  std::int32_t find_edge(std::int32_t a, std::int32_t b) const;

  /// Calls visit(he) for the half-edges whose apex is `vertex`, counter-clockwise from the one
  /// given, until it returns true or the circle closes. Crosses subsegments. Needs ghosts around
  /// the hull.
  template <typename Visit>
  void around(std::int32_t start_he, const Visit& visit) const {
    std::int32_t he = start_he;
    do {
      if (visit(he)) return;
      // The edge at vertex (apex) that ends the triangle counter-clockwise is the one before he.
      const std::int32_t other = across(next(he));
      if (other < 0) return;
      he = next(other);
    } while (he != start_he);
  }

  /// The half-edge of `t` whose apex is `vertex`.
  std::int32_t opposite(std::int32_t t, std::int32_t vertex) const {
    const Triangle& x = tri(t);
    return 4 * t + (x.v[0] == vertex ? 0 : x.v[1] == vertex ? 1 : 2);
  }

  /// Keeps the triangles with number[t] >= 0 and gives them these numbers, of which there must be
  /// as many as triangles are kept, from 0 up. Removes the others.
  void renumber(const std::vector<std::int32_t>& number);

  bool in_circumcircle(std::int32_t t, Point2 p) const {
    const Triangle& x = tri(t);
    if ((x.v[0] | x.v[1] | x.v[2]) < 0) return in_ghost(x, p);
    return incircle(point(x.v[0]), point(x.v[1]), point(x.v[2]), p) > 0;
  }

 private:
  bool in_ghost(const Triangle& x, Point2 p) const;
  bool locally_delaunay(std::int32_t he) const;
  std::int32_t new_triangle() {
    triangles.emplace_back();
    return static_cast<std::int32_t>(triangles.size()) - 1;
  }
  /// Makes whatever `link` names point back to `he`, whose origin is `from`.
  void attach(std::int32_t link, std::int32_t he, std::int32_t from) {
    if (link >= 0) {
      tri(link >> 2).n[link & 3] = he;
    } else {
      Subsegment& s = sub(~link);
      s.side[s.v[0] == from ? 0 : 1] = he;
    }
  }
  void track(std::int32_t vertex, std::int32_t t) {
    if (vertex >= 0) some_triangle_at(vertex) = t;
  }

  std::vector<std::int32_t> cavity_dead_;
  std::vector<std::int32_t> stack_;
  std::vector<std::int32_t> slots_;
  std::vector<std::int32_t> pending_;
};

}  // namespace tetropolis
