#include "point_collector.h"

#include <cstdint>
#include <new>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

#include "tetropolis/core/parallel.h"

namespace tetropolis {

namespace {

/// Makes room for `size` values, whose memory the system is asked for at once: page by page, as the
/// values are written, takes half as long again.
template <typename T>
void grow(Buffer<T>& values, std::size_t size) {
  const std::size_t first = values.size();
  values.resize(size);
#ifdef MADV_POPULATE_WRITE
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(values.data() + first) + page - 1) / page;
  const auto end = reinterpret_cast<std::uintptr_t>(values.data() + size) / page;
  if (begin < end)
    madvise(reinterpret_cast<void*>(begin * page), (end - begin) * page, MADV_POPULATE_WRITE);
#endif
}

/// From the numbers of records to coordinates.
class Axis {
 public:
  Axis(double scale, double offset)
      : scale_(scale * PointCoordinate::kPerMetre), offset_(offset * PointCoordinate::kPerMetre) {}
  PointCoordinate at(std::int32_t number) const {
    return PointCoordinate::of_tenths(number * scale_ + offset_);
  }

 private:
  double scale_;
  double offset_;
};

}  // namespace

PointCollector::PointCollector(std::size_t tasks, std::size_t expected, Point2 origin)
    : origin_(origin), waiting_(tasks) {
  try {
    points_.x.reserve(expected);
    points_.y.reserve(expected);
    points_.z.reserve(expected);
    points_.classification.reserve(expected);
  } catch (const std::bad_alloc&) {
    points_ = {};
  }
}

Buffer<LasRecord> PointCollector::empty_records() {
  const std::scoped_lock lock(mutex_);
  if (used_.empty()) return {};
  Buffer<LasRecord> records = std::move(used_.back());
  used_.pop_back();
  return records;
}

void PointCollector::take_some(std::size_t task, Buffer<LasRecord>& records,
                               const LasInfo& info) {
  const std::scoped_lock lock(mutex_);
  if (next_ != task) return;
  append(records, info);
  records.clear();
}

void PointCollector::take(std::size_t task, Buffer<LasRecord>&& records, const LasInfo& info) {
  const std::scoped_lock lock(mutex_);
  waiting_[task] = {std::move(records), &info};
  for (; next_ < waiting_.size() && waiting_[next_].info != nullptr; ++next_) {
    Buffer<LasRecord> done = std::move(waiting_[next_].records);
    append(done, *waiting_[next_].info);
    if (used_.size() >= static_cast<std::size_t>(thread_count())) continue;
    done.clear();
    used_.push_back(std::move(done));
  }
  if (next_ > task) return;
  Buffer<LasRecord>& waits = waiting_[task].records;
  if (waits.size() < waits.capacity() / 2) waits.shrink_to_fit();
}

void PointCollector::append(const Buffer<LasRecord>& records, const LasInfo& info) {
  const std::size_t first = points_.size(), size = first + records.size();
  grow(points_.x, size);
  grow(points_.y, size);
  grow(points_.z, size);
  grow(points_.classification, size);
  const Axis x(info.scale[0], info.offset[0] - origin_.x);
  const Axis y(info.scale[1], info.offset[1] - origin_.y);
  const Axis z(info.scale[2], info.offset[2]);
  PointCoordinate *xs = points_.x.data() + first, *ys = points_.y.data() + first,
                  *zs = points_.z.data() + first;
  std::uint8_t* classes = points_.classification.data() + first;
  for (std::size_t i = 0; i < records.size(); ++i) {
    xs[i] = x.at(records[i].x);
    ys[i] = y.at(records[i].y);
    zs[i] = z.at(records[i].z);
    classes[i] = records[i].classification;
  }
}

}  // namespace tetropolis
