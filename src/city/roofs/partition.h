// A polygon divided by lines into regions: what the parts of a roof are made from. Private to
// src/city.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "tetropolis/geometry/types.h"

namespace tetropolis {

/// A planar graph whose faces are regions. Edges meet at nodes only. The outline of the polygon is
/// part of it: its corners never move, and other nodes on it only along it.
///
/// Every operation that changes geometry is refused (false, nothing changed) where the lines would
/// cross, touch, or pass over a node. The area of all regions together stays that of the polygon.
class Partition {
 public:
  using NodeId = std::size_t;
  using EdgeId = std::size_t;
  using Region = std::int32_t;  // RoofRegion
  static constexpr Region kOutside = -1;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  struct Node {
    Point2 p;
    bool corner = false;          ///< A vertex of the polygon.
    bool on_outline = false;      ///< Corners, too.
    std::vector<EdgeId> edges{};  ///< Empty: the node is no more.
  };
  struct Edge {
    NodeId a = kNone, b = kNone;
    Region left = kOutside, right = kOutside;  ///< Seen from a to b.
    bool alive = true;
    NodeId other(NodeId n) const { return a == n ? b : a; }
    bool has(NodeId n) const { return a == n || b == n; }
    bool is_outline() const { return left == kOutside || right == kOutside; }
  };

  /// `box`: all nodes are in it; `reach`: how far callers look around, metres, > 0.
  Partition(const Bounds2& box, double reach);

  NodeId add_node(Point2 p, bool corner, bool on_outline);
  EdgeId add_edge(NodeId a, NodeId b, Region left, Region right);
  void put_on_outline(NodeId n) { nodes_[n].on_outline = true; }
  /// Moves a node back to where it was before the last move.
  void put_back(NodeId n, Point2 to) { put(n, to); }

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const Node& node(NodeId n) const { return nodes_[n]; }
  const Edge& edge(EdgeId e) const { return edges_[e]; }
  Point2 at(NodeId n) const { return nodes_[n].p; }
  double length(EdgeId e) const;
  EdgeId edge_between(NodeId a, NodeId b) const;  ///< kNone: none.

  /// Calls visit(edge) for live edges whose box meets `box`; some more than once.
  template <typename Visit>
  void for_each_edge_near(const Bounds2& box, const Visit& visit) const {
    const std::array<std::size_t, 4> range = cells(box);
    for (std::size_t y = range[1]; y <= range[3]; ++y)
      for (std::size_t x = range[0]; x <= range[2]; ++x)
        for (const EdgeId e : grid_[y * columns_ + x])
          if (edges_[e].alive && box_of(e).intersects(box)) visit(e);
  }

  /// Moves a node. Callers keep nodes of the outline on it.
  bool move(NodeId n, Point2 to);
  /// Replaces the two edges at a node by one. Precondition: it has two and is no corner.
  bool straighten(NodeId n);
  /// Shrinks an edge to its end `kept`, which moves to `to`.
  bool collapse(EdgeId e, NodeId kept, Point2 to);
  /// Leads the edge through a node beside it.
  bool lead_through(EdgeId e, NodeId n);
  /// The node has an edge to an end of `e`, close to `e`: both become one as far as the node.
  bool fold(EdgeId e, NodeId n);
  /// Moves a node beside the edge `e` to x, between the ends of `e`, which then runs through it.
  /// Onto the outline only nodes that are not on it.
  bool move_onto(NodeId n, EdgeId e, Point2 x);
  /// Leads the edge through a new node at x, beside it.
  bool bend(EdgeId e, Point2 x);
  /// Edge g leaves node a at a small angle to edge e: now it leaves e at x, between its ends.
  bool branch_at(EdgeId g, NodeId a, EdgeId e, Point2 x);
  /// The same, at the other end of e.
  bool branch_at_end(EdgeId g, NodeId a, EdgeId e);

  /// A place on the outline, some way from a corner.
  struct OutlinePlace {
    std::vector<EdgeId> passed{};  ///< Sides between the corner and side `on`.
    EdgeId on = kNone;
    Point2 p;  ///< Between the ends of `on`.
  };
  /// Moves edge e, between two corners of the outline, into region `in` on one side of it: it ends
  /// at `from_a` and `from_b`, which are reached from its ends along `in`.
  bool push(EdgeId e, Region in, const OutlinePlace& from_a, const OutlinePlace& from_b);

  /// Gives all of `gone` to `keep`, and removes the edges between them.
  void merge(Region keep, Region gone);
  /// Removes what separates nothing: edges with one region on both sides, nodes of the outline that
  /// are neither corners nor ends of other edges.
  void tidy();

  /// A connected face: its rings, as nodes, with the face on the left; the outer one first.
  struct Face {
    Region region = kOutside;
    std::vector<std::vector<NodeId>> rings{};
    double area = 0;
  };
  /// In the order of their regions, then of their first edges.
  std::vector<Face> faces() const;
  /// Gives faces that have a region in common, but the largest of them, regions of their own, from
  /// `next` on. Returns per new region the one that it was.
  std::vector<Region> split_regions(Region next);
  /// The region at a place that is on no edge; kOutside outside.
  Region region_at(Point2 p) const;

  /// Per region that has edges: its area, square metres.
  std::map<Region, double> areas() const;
  /// Per neighbour of a region: the length of their common border, metres.
  std::map<Region, double> neighbours(Region region) const;

 private:
  std::array<std::size_t, 4> cells(const Bounds2& box) const;
  Bounds2 box_of(EdgeId e) const {
    const Point2 a = at(edges_[e].a), b = at(edges_[e].b);
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
  }
  void enter(EdgeId e);
  void remove(EdgeId e);
  void redirect(EdgeId e, NodeId from, NodeId to);
  /// Whether a new edge from p (node n) to q (node m) meets no edge but `ignored` ones.
  bool is_free(Point2 p, Point2 q, NodeId n, NodeId m, std::span<const EdgeId> ignored) const;
  /// Whether the closed triangle has no node but `ignored` ones.
  bool is_empty(Point2 a, Point2 b, Point2 c, std::initializer_list<NodeId> ignored) const;
  void join_straight(NodeId n);
  bool collapse_into(NodeId gone, NodeId kept, EdgeId e);
  void put(NodeId n, Point2 to);
  /// As fold; `left`: the node lies on the left of the edge from the common end.
  void fold_onto(EdgeId e, EdgeId g, NodeId n, bool left);
  void split(EdgeId e, NodeId n);
  /// The last node of a path of edges.
  NodeId end_of(NodeId from, std::span<const EdgeId> path) const;

  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  Bounds2 box_;
  double cell_;
  std::size_t columns_ = 1, rows_ = 1;
  std::vector<std::vector<EdgeId>> grid_;
  bool is_tidy_ = false;  ///< Whether nothing but places has changed since tidy() found nothing.
};

}  // namespace tetropolis
