#include "point_collector.h"

#include <algorithm>
#include <new>
#include <utility>

#include "tetropolis/core/threads.h"

#include "core/page_advice.h"

namespace tetropolis {

namespace {

/// Makes room for `size` values, whose memory the system is asked for at once: page by page, as the
/// values are written, takes half as long again.
template <typename T>
void grow(Buffer<T>& values, std::size_t size) {
  const std::size_t first = values.size();
  values.resize(size);
#ifdef MADV_POPULATE_WRITE
  advise_pages(values.data() + first, values.data() + size, MADV_POPULATE_WRITE);
#endif
}

template <typename T>
void append_values(const Buffer<T>& from, Buffer<T>& to) {
  const std::size_t size = to.size();
  grow(to, size + from.size());
  std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(size));
}

/// Calls `act` with each of the arrays.
template <typename Act>
void with_arrays(PointCloud& points, const Act& act) {
  act(points.x);
  act(points.y);
  act(points.z);
  act(points.classification);
}

void clear(PointCloud& points) {
  with_arrays(points, [](auto& values) { values.clear(); });
}

}  // namespace

PointCollector::PointCollector(std::size_t tasks, std::size_t expected) : waiting_(tasks) {
  try {
    with_arrays(points_, [&](auto& values) { values.reserve(expected); });
  } catch (const std::bad_alloc&) {
    points_ = {};
  }
}

PointCloud PointCollector::empty_points(std::size_t reserved) {
  PointCloud points;
  {
    const std::scoped_lock lock(mutex_);
    if (!used_.empty()) {
      points = std::move(used_.back());
      used_.pop_back();
    }
  }
  with_arrays(points, [&](auto& values) { values.reserve(reserved); });
  return points;
}

void PointCollector::take_some(std::size_t task, PointCloud& points) {
  const std::scoped_lock lock(mutex_);
  if (next_ != task) return;
  append(points);
  clear(points);
}

void PointCollector::take(std::size_t task, PointCloud&& points) {
  const std::scoped_lock lock(mutex_);
  waiting_[task] = {std::move(points), true};
  for (; next_ < waiting_.size() && waiting_[next_].ended; ++next_) {
    PointCloud done = std::move(waiting_[next_].points);
    append(done);
    if (used_.size() >= static_cast<std::size_t>(thread_count())) continue;
    clear(done);
    used_.push_back(std::move(done));
  }
  if (next_ > task) return;
  with_arrays(waiting_[task].points, [](auto& values) {
    if (values.size() < values.capacity() / 2) values.shrink_to_fit();
  });
}

void PointCollector::append(const PointCloud& points) {
  append_values(points.x, points_.x);
  append_values(points.y, points_.y);
  append_values(points.z, points_.z);
  append_values(points.classification, points_.classification);
}

}  // namespace tetropolis
