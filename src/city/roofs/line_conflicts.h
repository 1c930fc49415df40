// Where lines of a roof come too close. Private to src/city.
#pragma once

#include <algorithm>
#include <tuple>
#include <vector>

#include "tetropolis/geometry/types.h"

#include "city/roofs/partition.h"

namespace tetropolis {

/// A node too near to an edge; without a node, an edge too short; with a second edge, two that meet
/// at too small an angle at the node.
struct LineConflict {
  double distance;
  Partition::EdgeId edge;
  Partition::NodeId node = Partition::kNone;
  Partition::EdgeId second = Partition::kNone;
  friend bool operator<(const LineConflict& a, const LineConflict& b) {
    return std::tie(a.distance, a.edge, a.node, a.second) <
           std::tie(b.distance, b.edge, b.node, b.second);
  }
};

/// Looks for conflicts among the lines as they are. Those of the outline alone are none: its
/// corners and its sides among themselves.
class LineConflicts {
 public:
  /// `lines` outlive it. `clearance`: metres; `min_angle`: radians, between lines that meet.
  LineConflicts(const Partition& lines, double clearance, double min_angle)
      : lines_(lines), clearance_(clearance), min_angle_(min_angle) {}

  /// All of them, the closest first.
  std::vector<LineConflict> all() const;
  /// Whether it is one, after lines have changed.
  bool still_holds(const LineConflict& conflict) const;
  /// Whether nothing is too close to a node and its edges.
  bool is_clear(Partition::NodeId n) const;

 private:
  bool can_move(Partition::EdgeId e) const;
  bool is_short(Partition::EdgeId e) const;
  double nearness(Partition::NodeId n, Partition::EdgeId e) const;
  double angle(Partition::NodeId n, Partition::EdgeId e, Partition::EdgeId f) const;
  template <typename Visit>
  void for_each_conflict_at(Partition::EdgeId e, const Visit& visit) const;

  const Partition& lines_;
  double clearance_;
  double min_angle_;
};

}  // namespace tetropolis
