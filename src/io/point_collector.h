// Points of tasks that end in any order, in the order of the tasks. Private to src/io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "tetropolis/core/buffer.h"
#include "tetropolis/geometry/point_cloud.h"
#include "tetropolis/geometry/types.h"
#include "tetropolis/io/las.h"

#include "las_decode.h"

namespace tetropolis {

/// Turns the records that tasks kept into points as soon as those of all tasks before are. Memory:
/// the points, and the records of the tasks that wait. May be called from several threads. One of
/// them makes points at a time, which takes a twentieth of the time of decompressing them.
class PointCollector {
 public:
  /// `expected` points get their memory at once, unless there is not so much; more may come.
  /// `origin` is subtracted from x and y.
  PointCollector(std::size_t tasks, std::size_t expected, Point2 origin);

  /// An empty vector, with memory that was used before if there is any: fresh memory is slow.
  Buffer<LasRecord> empty_records();

  /// Empties `records`, the first or next ones of a task that is not at its end, unless points of
  /// tasks before are still to come.
  void take_some(std::size_t task, Buffer<LasRecord>& records, const LasInfo& info);

  /// The (remaining) records of one task, with the scale and offset of `info`, which has to stay
  /// until points are taken. Precondition: once for each task.
  void take(std::size_t task, Buffer<LasRecord>&& records, const LasInfo& info);

  /// The points of all tasks. Precondition: all were taken.
  PointCloud take_points() { return std::move(points_); }

 private:
  struct Waiting {
    Buffer<LasRecord> records;
    const LasInfo* info = nullptr;  ///< None before the task has ended.
  };

  void append(const Buffer<LasRecord>& records, const LasInfo& info);

  Point2 origin_;
  std::mutex mutex_;  ///< Of all that follows.
  std::vector<Waiting> waiting_;
  std::size_t next_ = 0;  ///< Task whose points come next.
  std::vector<Buffer<LasRecord>> used_;
  PointCloud points_;
};

}  // namespace tetropolis
