// The one place where loops become parallel. Results never depend on the number of threads: ranges
// are cut into chunks whose size is fixed by the caller, and partial results are combined in order.
#pragma once

#include <cstddef>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace tetropolis {

/// While it lives, at most `threads` threads work in the parallel loops (0: as many as there are
/// cores).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);

 private:
  tbb::global_control control_;
};

/// The number of threads the parallel loops may use now.
int thread_count();

/// The grain that cuts [0, size) into `chunks` at most: for chunks with large temporary data.
inline std::size_t grain_of_chunks(std::size_t size, std::size_t chunks = 64) {
  return size <= chunks ? 1 : (size + chunks - 1) / chunks;
}

/// Calls body(begin, end) for consecutive chunks of [0, size) of `grain` items (the last may be
/// shorter), in no particular order and possibly at the same time. Serial when one chunk suffices.
/// Precondition: grain > 0; chunks do not write to the same memory.
template <typename Body>
void parallel_chunks(std::size_t size, std::size_t grain, const Body& body) {
  const std::size_t chunks = (size + grain - 1) / grain;
  if (chunks <= 1) {
    if (size > 0) body(std::size_t{0}, size);
    return;
  }
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, chunks, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
          const std::size_t begin = c * grain;
          body(begin, begin + grain < size ? begin + grain : size);
        }
      },
      tbb::simple_partitioner());
}

/// Combines map(begin, end) over the chunks of [0, size) from left to right:
/// combine(...combine(combine(identity, m0), m1)..., mLast). The same bits for any thread count.
template <typename Value, typename Map, typename Combine>
Value parallel_reduce_ordered(std::size_t size, std::size_t grain, Value identity, const Map& map,
                              const Combine& combine) {
  const std::size_t chunks = (size + grain - 1) / grain;
  // Wrapped, because the elements of std::vector<bool> share bytes.
  struct Partial {
    Value value;
  };
  std::vector<Partial> partial(chunks, Partial{identity});
  parallel_chunks(size, grain, [&](std::size_t begin, std::size_t end) {
    partial[begin / grain].value = map(begin, end);
  });
  Value result = identity;
  for (const Partial& part : partial) result = combine(result, part.value);
  return result;
}

/// Sorts [begin, end) by a strict total order `less` (ties would make the order depend on threads).
template <typename Iterator, typename Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
  tbb::parallel_sort(begin, end, less);
}

}  // namespace tetropolis
