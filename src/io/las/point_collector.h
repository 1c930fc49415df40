// Points of tasks that end in any order, in the order of the tasks. Private to src/io.
#pragma once

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "tetropolis/geometry/point_cloud.h"

namespace tetropolis {

/// Appends the points of tasks to those of all tasks before, as soon as these are there. Memory:
/// the points, and those of the tasks that wait. May be called from several threads; one of them
/// copies at a time.
class PointCollector {
 public:
  /// `expected` points get their memory at once, unless there is not so much; more may come.
  PointCollector(std::size_t tasks, std::size_t expected);

  /// No points, but memory for so many, used before if there is any: fresh memory is slow.
  PointCloud empty_points(std::size_t reserved);

  /// Empties `points`, the first or next ones of a task that is not at its end, unless points of
  /// tasks before are still to come.
  void take_some(std::size_t task, PointCloud& points);

  /// The (remaining) points of one task. Precondition: once for each task.
  void take(std::size_t task, PointCloud&& points);

  /// The points of all tasks. Precondition: all were taken.
  PointCloud take_points() { return std::move(points_); }

 private:
  struct Waiting {
    PointCloud points;
    bool ended = false;
  };

  void append(const PointCloud& points);

  std::mutex mutex_;  ///< Of all that follows.
  std::vector<Waiting> waiting_;
  std::size_t next_ = 0;  ///< Task whose points come next.
  std::vector<PointCloud> used_;
  PointCloud points_;
};

}  // namespace tetropolis
