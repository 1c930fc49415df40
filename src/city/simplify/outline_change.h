// Small changes of an outline: what they gain, and whether they keep it valid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tetropolis/geometry/domain.h"
#include "tetropolis/geometry/types.h"

#include "city/grid_geometry.h"
#include "city/outline.h"
#include "core/infinity.h"

namespace tetropolis {

enum class ChangeKind : std::uint8_t {
  kDrop,   ///< Vertices go.
  kMerge,  ///< Two vertices become one.
  kSlide,  ///< The ends of a short edge move along their other edges.
  kMove,   ///< A vertex moves.
  kFill,   ///< The hole that `first` belongs to goes; nothing else of the change is set.
};

/// The vertices between `first` and `last` (both stay) are replaced by `fresh`.
struct OutlineChange {
  ChangeKind kind = ChangeKind::kDrop;
  OutlineVertex first = kNoOutlineVertex;
  OutlineVertex last = kNoOutlineVertex;
  std::array<OutlineVertex, 2> old{kNoOutlineVertex, kNoOutlineVertex};
  int old_count = 0;
  std::array<Point2, 2> fresh{};
  int fresh_count = 0;
  double cost = 0;                   ///< Area added and removed, square steps.
  std::array<Point2, 4> made_for{};  ///< The points from first to last when it was considered.

  std::span<const OutlineVertex> old_vertices() const {
    return std::span(old).first(static_cast<std::size_t>(old_count));
  }
  std::span<const Point2> fresh_points() const {
    return std::span(fresh).first(static_cast<std::size_t>(fresh_count));
  }
  void add(Point2 q) { fresh[static_cast<std::size_t>(fresh_count++)] = q; }
};

/// The change that replaces v, without fresh points.
OutlineChange vertex_change(const Outline& outline, OutlineVertex v, ChangeKind kind);

/// At most four points: fixed, up to two free, fixed.
struct ShortPath {
  static constexpr double kNowhere = kInfinity;
  std::array<Point2, 4> p{};
  int edges = 0;
  void add(Point2 q) {
    p[static_cast<std::size_t>(count++)] = q;
    edges = count - 1;
  }
  Point2 at(int i) const { return p[static_cast<std::size_t>(i)]; }
  int count = 0;
};

/// The points of a change's vertices now, and what they would become.
ShortPath old_path(const Outline& outline, const OutlineChange& change);
ShortPath new_path(const Outline& outline, const OutlineChange& change);

/// Makes the change: the edges leave the grid and come back as they are then, the polygon is marked
/// as changed. Vertices that are fresh beyond the old ones get new numbers. Not for fills.
void replace_vertices(Outline& outline, const OutlineChange& change);

/// Judges changes of one outline (not fills); it has room for one neighbourhood at a time. Changes
/// of the same vertices are best asked about one after the other: what is near them is kept.
class ChangeJudge {
 public:
  /// Coordinates are steps. New vertices have to be within `keep_inside`.
  ChangeJudge(const Outline& outline, double epsilon, const Domain& keep_inside)
      : o_(outline),
        epsilon_(epsilon),
        epsilon2_(epsilon * epsilon),
        keep_inside_(keep_inside),
        edge_seen_(outline.point.size(), 0),
        cell_seen_(outline.grid.cell_count(), 0) {}

  /// By how much the change decreases the potential Phi (see repair_vertices), or nothing if that
  /// is less than `least`, or if it makes edges touch, sweeps over a vertex, leaves `keep_inside`
  /// or leaves fewer than three vertices in the ring. Exact apart from the rounding of Phi.
  std::optional<double> gain(const OutlineChange& change, double least = -kRounding);

  /// Collects, as near(), the edges within epsilon of either path, without those the change
  /// removes.
  void gather(const ShortPath& before, const ShortPath& after, const OutlineChange& change);
  const std::vector<OutlineVertex>& near() const { return near_; }

 private:
  static constexpr double kRounding = 1e-9;  // of Phi
  /// The vertices whose neighbourhood was gathered last, and when.
  struct Gathered {
    OutlineVertex first = kNoOutlineVertex;
    std::array<OutlineVertex, 2> old{kNoOutlineVertex, kNoOutlineVertex};
    std::uint64_t edits = 0;
    std::size_t near_count = 0;
    double potential = 0;
  };

  double weight(double squared) const {
    return squared < epsilon2_ ? 1.1 - std::sqrt(squared) / epsilon_ : 0;
  }
  double weight(Point2 p, Point2 a, Point2 b) const {
    return weight(grid::squared_distance_to_segment(p, a, b));
  }
  void gather_before(const ShortPath& before, const OutlineChange& c);
  void gather_along(const ShortPath& path, double reach);
  void gather_in(const Bounds2& box);
  double potential(const ShortPath& path, const OutlineChange& c, double most) const;
  bool crosses(const ShortPath& path, const OutlineChange& c) const;
  bool sweeps_a_vertex(const ShortPath& before, const ShortPath& after, const OutlineChange& c);
  bool is_seen(std::uint32_t gathering) const {
    return gathering == gathering_before_ || gathering == gathering_;
  }

  const Outline& o_;
  double epsilon_;
  double epsilon2_;
  Domain keep_inside_;
  std::vector<std::uint32_t> edge_seen_;  ///< Per edge: the gathering it was last met in.
  std::vector<std::uint32_t> cell_seen_;  ///< Per cell: the last in which all its edges were met.
  std::uint32_t gathering_ = 0;
  std::uint32_t gathering_before_ = 0;  ///< Around the old path.
  Gathered before_;
  std::vector<OutlineVertex> near_;
};

}  // namespace tetropolis
