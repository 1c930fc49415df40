#include <algorithm>
#include <cmath>
#include <deque>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tetropolis/core/error.h"

#include "construct.h"

namespace tetropolis {

namespace {

// A stretch of an input segment that still has to become edges.
struct Task {
  std::int32_t a;
  std::int32_t b;
  std::int32_t input;
};

// How far a vertex may be from a segment that it is taken to lie on: see triangulation.h.
double tolerance(Point2 a, Point2 b) {
  return 0x1p-46 * std::max({std::abs(a.x), std::abs(a.y), std::abs(b.x), std::abs(b.y)});
}

// What is close enough to the inside of a segment to be on it. Going from vertex to vertex this way
// ends at b: a step either brings the distance to b as computed down, or, exactly on the line,
// leaves it at least as small and brings the true distance down.
class Corridor {
 public:
  Corridor(Point2 a, Point2 b)
      : a_(a),
        b_(b),
        dx_(b.x - a.x),
        dy_(b.y - a.y),
        squared_length_(dx_ * dx_ + dy_ * dy_),
        width_(tolerance(a, b) * std::sqrt(squared_length_)) {}

  bool contains(Point2 p) const {
    const double ax = p.x - a_.x, ay = p.y - a_.y, bx = b_.x - p.x, by = b_.y - p.y;
    // The width is far more than the rounding error, so points exactly on the line pass.
    if (std::abs(ax * dy_ - ay * dx_) > width_) return false;
    if (!(ax * dx_ + ay * dy_ > 0 && bx * dx_ + by * dy_ > 0)) return false;
    return bx * bx + by * by < squared_length_ || orient2d(a_, b_, p) == 0;
  }

 private:
  Point2 a_;
  Point2 b_;
  double dx_;
  double dy_;
  double squared_length_;
  double width_;
};

class SegmentInserter {
 public:
  SegmentInserter(TriMesh& mesh, std::int64_t& crossings, std::int64_t segments)
      : mesh_(mesh), crossings_(crossings), limit_(10'000 + 4 * segments * segments) {}

  void insert(std::int32_t a, std::int32_t b, std::int32_t input) {
    tasks_.push_back({a, b, input});
    while (!tasks_.empty()) {
      const Task task = tasks_.back();
      tasks_.pop_back();
      if (task.a != task.b) advance(task);
    }
  }

 private:
  // Handles the first stretch of the task, up to the first vertex on it, and pushes the rest.
  void advance(const Task& task) {
    const Point2 a = mesh_.point(task.a);
    const Point2 b = mesh_.point(task.b);
    const Corridor corridor(a, b);
    std::int32_t direct = TriMesh::kNothing;   // an edge that starts along the segment
    std::int32_t crossed = TriMesh::kNothing;  // an edge opposite to a that the segment crosses
    mesh_.around(mesh_.opposite(mesh_.some_triangle_at(task.a), task.a), [&](std::int32_t he) {
      const std::int32_t u = mesh_.origin(he);
      if (u < 0) return false;
      if (u == task.b || corridor.contains(mesh_.point(u))) {
        direct = TriMesh::prev(he);
        return true;
      }
      const std::int32_t w = mesh_.target(he);
      if (w >= 0 && orient2d(a, mesh_.point(u), b) > 0 && orient2d(a, mesh_.point(w), b) < 0)
        crossed = he;
      return false;
    });
    if (direct >= 0) {
      const std::int32_t u = mesh_.target(direct);
      mesh_.constrain(direct, task.input);
      tasks_.push_back({u, task.b, task.input});
      return;
    }
    if (crossed < 0) give_up(task);
    cross(task, crossed);
  }

  // Among points nearer to one another than the corridor is wide, the way need not be where the
  // predicates say: it may start nowhere, leave the hull, or come back.
  [[noreturn]] void give_up(const Task& task) const {
    const Point2 a = mesh_.point(task.a);
    throw Error(ErrorKind::kInput,
                fmt::format("segment {}: from ({}, {}) on it passes points that are nearer to one "
                            "another than the precision of their coordinates; remove one",
                            task.input, a.x, a.y));
  }

  // Walks from a across edges until a vertex on the segment, and flips the edges away.
  void cross(const Task& task, std::int32_t he) {
    const Point2 a = mesh_.point(task.a);
    const Point2 b = mesh_.point(task.b);
    const Corridor corridor(a, b);
    crossing_.clear();
    std::int32_t end = TriMesh::kNothing;
    for (;;) {
      const std::int32_t n = mesh_.link(he);
      if (n < 0) {
        intersect(task, ~n);
        return;
      }
      crossing_.emplace_back(mesh_.origin(he), mesh_.target(he));
      const std::int32_t x = mesh_.apex(n);
      if (x < 0) give_up(task);
      if (x == task.b || corridor.contains(mesh_.point(x))) {
        end = x;
        break;
      }
      const int side = orient2d(a, b, mesh_.point(x));
      // he's origin was right of the segment; n runs the other way.
      he = side > 0 ? TriMesh::next(n) : TriMesh::prev(n);
    }
    flip_away(task, end);
    const std::int32_t edge_to_end = mesh_.find_edge(task.a, end);
    if (edge_to_end < 0) give_up(task);
    mesh_.constrain(edge_to_end, task.input);
    for (const auto& [p, q] : created_) {
      const std::int32_t edge = mesh_.find_edge(p, q);
      if (edge >= 0) mesh_.push_pending(edge);
    }
    mesh_.restore_delaunay();
    tasks_.push_back({end, task.b, task.input});
  }

  // Sloan 1993: turn the crossing edges one after the other; one whose quadrilateral is not convex,
  // or which still crosses after its turn, goes to the back of the queue.
  // Among points nearer to one another than the corridor is wide, edges that cross the way to b
  // need not cross the way to the vertex found on it: turning them would never end.
  void flip_away(const Task& task, std::int32_t to) {
    const std::int32_t from = task.a;
    auto turns = static_cast<std::int64_t>(crossing_.size());
    turns = 1000 + 16 * turns * turns;
    const Point2 a = mesh_.point(from);
    const Point2 b = mesh_.point(to);
    created_.clear();
    while (!crossing_.empty()) {
      if (--turns < 0) give_up(task);
      const auto edge = crossing_.front();
      crossing_.pop_front();
      const std::int32_t he = mesh_.find_edge(edge.first, edge.second);
      if (he < 0) give_up(task);
      const std::int32_t p = mesh_.apex(he);
      const std::int32_t q = mesh_.apex(mesh_.link(he));
      if (p < 0 || q < 0) give_up(task);
      const Point2 pp = mesh_.point(p);
      const Point2 pq = mesh_.point(q);
      if (orient2d(pp, pq, mesh_.point(edge.first)) >= 0 ||
          orient2d(pp, pq, mesh_.point(edge.second)) <= 0) {
        crossing_.push_back(edge);
        continue;
      }
      mesh_.flip(he);
      const bool touches = p == from || q == from || p == to || q == to;
      if (!touches && orient2d(a, b, pp) * orient2d(a, b, pq) < 0) {
        crossing_.emplace_back(p, q);
      } else {
        created_.emplace_back(p, q);
      }
    }
    mesh_.touched.clear();
  }

  void intersect(const Task& task, std::int32_t s) {
    const TriMesh::Subsegment other = mesh_.sub(s);
    if (++intersections_ > limit_)
      throw Error(ErrorKind::kInput,
                  fmt::format("segments {} and {}: cross one another again and again within the "
                              "precision of their coordinates; remove one",
                              other.piece, task.input));
    const std::int32_t ends[4] = {task.a, task.b, other.v[0], other.v[1]};
    const Point2 p = crossing_point(ends);
    const double near = std::max(tolerance(mesh_.point(ends[0]), mesh_.point(ends[1])),
                                 tolerance(mesh_.point(ends[2]), mesh_.point(ends[3])));
    std::int32_t v = nearest(p, ends, near);
    if (v < 0) v = insert_crossing(p, mesh_.triangle_of(other.side[0]), s, near);
    if (v != other.v[0] && v != other.v[1] && alive(s, other)) {
      // The vertex is off the subsegment by rounding: replace the subsegment by two.
      const std::int32_t freed = mesh_.sub(s).side[0];
      mesh_.release(s);
      mesh_.push_pending(freed);
      mesh_.restore_delaunay();
      tasks_.push_back({other.v[0], v, other.piece});
      tasks_.push_back({v, other.v[1], other.piece});
    }
    tasks_.push_back({v, task.b, task.input});
    tasks_.push_back({task.a, v, task.input});
  }

  // The nearest of `vertices` to p, if both coordinates are within `near`.
  std::int32_t nearest(Point2 p, std::span<const std::int32_t> vertices, double near) const {
    std::int32_t found = TriMesh::kNothing;
    for (const std::int32_t v : vertices) {
      if (v < 0) continue;
      const Point2 q = mesh_.point(v);
      const double distance = std::max(std::abs(p.x - q.x), std::abs(p.y - q.y));
      if (distance > near) continue;
      near = distance;
      found = v;
    }
    return found;
  }

  bool alive(std::int32_t s, const TriMesh::Subsegment& before) const {
    return mesh_.sub(s).v[0] == before.v[0] && mesh_.sub(s).v[1] == before.v[1];
  }

  Point2 crossing_point(const std::int32_t (&ends)[4]) const {
    const Point2 a = mesh_.point(ends[0]), b = mesh_.point(ends[1]);
    const Point2 c = mesh_.point(ends[2]), d = mesh_.point(ends[3]);
    const double abx = b.x - a.x, aby = b.y - a.y;
    const double cdx = d.x - c.x, cdy = d.y - c.y;
    const double denominator = abx * cdy - aby * cdx;
    const double numerator = (c.x - a.x) * cdy - (c.y - a.y) * cdx;
    const double along = numerator / denominator;
    const double t = along >= 0 && along <= 1 ? along : along > 1 ? 1.0 : 0.0;
    // Within the boxes of both: exact on axis-parallel segments.
    const auto clamp_between = [](double value, double u, double v) {
      return std::clamp(value, std::min(u, v), std::max(u, v));
    };
    const double x = clamp_between(clamp_between(a.x + t * abx, a.x, b.x), c.x, d.x);
    const double y = clamp_between(clamp_between(a.y + t * aby, a.y, b.y), c.y, d.y);
    return {x, y};
  }

  std::int32_t insert_crossing(Point2 p, std::int32_t hint, std::int32_t s, double near) {
    const TriMesh::Location where = mesh_.locate(p, hint);
    const std::int32_t close = nearest(p, mesh_.tri(where.triangle).v, near);
    if (close >= 0) return close;
    const std::int32_t v = mesh_.add_point(p);
    ++crossings_;
    const std::int32_t link =
        where.edge >= 0 ? mesh_.link(4 * where.triangle + where.edge) : TriMesh::kNothing;
    if (where.edge >= 0 && link < 0) {
      mesh_.split_subsegment(~link, v);
    } else if (mesh_.split_subsegment(s, v) == TriMesh::kNothing) {
      mesh_.find_cavity(p, where.triangle);
      mesh_.fill_cavity(v);
    }
    mesh_.touched.clear();
    return v;
  }

  TriMesh& mesh_;
  std::int64_t& crossings_;
  std::int64_t limit_;  // generous: n segments cross at most n (n - 1) / 2 times
  std::int64_t intersections_ = 0;
  std::vector<Task> tasks_;
  std::deque<std::pair<std::int32_t, std::int32_t>> crossing_;
  std::vector<std::pair<std::int32_t, std::int32_t>> created_;
};

// All points on one line: no triangles, but subsegments all the same.
void insert_collinear(const PlanarGraph& graph, Construction& result) {
  TriMesh& mesh = result.mesh;
  std::vector<std::int32_t> sorted(mesh.points.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = static_cast<std::int32_t>(i);
  std::sort(sorted.begin(), sorted.end(), [&](std::int32_t i, std::int32_t j) {
    const Point2 p = mesh.point(i), q = mesh.point(j);
    return p.x != q.x ? p.x < q.x : p.y < q.y;
  });
  std::vector<std::size_t> rank(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) rank[static_cast<std::size_t>(sorted[i])] = i;
  std::vector<char> covered(sorted.size(), 0);  // [i]: between ranks i and i + 1
  for (std::size_t s = 0; s < graph.segments.size(); ++s) {
    const auto end = [&](std::size_t k) { return rank[result.input_vertex[graph.segments[s][k]]]; };
    const std::size_t from = end(0), to = end(1);
    const bool forward = from < to;
    for (std::size_t i = std::min(from, to); i < std::max(from, to); ++i) {
      if (covered[i] != 0) continue;
      covered[i] = 1;
      const std::int32_t a = sorted[forward ? i : i + 1], b = sorted[forward ? i + 1 : i];
      mesh.subsegments.push_back(
          {{a, b}, {TriMesh::kNothing, TriMesh::kNothing}, static_cast<std::int32_t>(s), false});
    }
  }
}

}  // namespace

void insert_segments(const PlanarGraph& graph, Construction& result) {
  if (result.mesh.triangles.empty()) {
    insert_collinear(graph, result);
    return;
  }
  result.mesh.subsegments.reserve(graph.segments.size() + 16);
  SegmentInserter inserter(result.mesh, result.crossings,
                           static_cast<std::int64_t>(graph.segments.size()));
  for (std::size_t s = 0; s < graph.segments.size(); ++s) {
    const auto vertex = [&](std::size_t k) {
      return result.input_vertex[graph.segments[s][k]].value();
    };
    inserter.insert(vertex(0), vertex(1), static_cast<std::int32_t>(s));
  }
}

}  // namespace tetropolis
