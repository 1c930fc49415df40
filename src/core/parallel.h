// The one place where loops become parallel. Results never depend on the number of threads: ranges
// are cut into chunks whose size is fixed by the caller, and partial results are combined in order.
// Private to the library; the number of threads is limited by tetropolis/core/threads.h.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

namespace tetropolis {

/// What the loops below are made of; calls throw nothing unless said otherwise.
namespace threads {

/// Calls body(i) for all of [0, size), in no particular order and possibly at the same time.
void for_each(std::size_t size, const std::function<void(std::size_t)>& body);

/// Calls make(i) for all of [0, size), possibly at the same time, and use(i), which may throw, in
/// order and one at a time; at most `slots` > 0 items are under way. Throws what use throws first;
/// nothing behind is used.
void pipeline(std::size_t size, std::size_t slots, const std::function<void(std::size_t)>& make,
              const std::function<void(std::size_t)>& use);

}  // namespace threads

/// The grain that cuts [0, size) into `chunks` at most: for chunks with large temporary data.
inline std::size_t grain_of_chunks(std::size_t size, std::size_t chunks = 64) {
  return size <= chunks ? 1 : (size + chunks - 1) / chunks;
}

/// What the first of several jobs that failed has thrown: which one that is does not depend on
/// threads if no job before it is left out.
class FirstFailure {
 public:
  /// Whether a job before this one has failed, so that it need not run.
  bool is_before(std::size_t job) const { return failed_.load(std::memory_order_relaxed) < job; }

  /// Runs body() and notes what it throws.
  template <typename Body>
  void run(std::size_t job, const Body& body) {
    try {
      body();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (job >= failed_) return;
      failed_ = job;
      thrown_ = std::current_exception();
    }
  }

  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  std::atomic<std::size_t> failed_{std::numeric_limits<std::size_t>::max()};
  std::mutex mutex_;
  std::exception_ptr thrown_;
};

/// Calls body(begin, end) for consecutive chunks of [0, size) of `grain` items (the last may be
/// shorter), in no particular order and possibly at the same time. Serial when one chunk suffices.
/// Throws what the first chunk that fails throws; chunks behind it may not run. Precondition: grain
/// > 0; chunks do not write to the same memory.
template <typename Body>
void parallel_chunks(std::size_t size, std::size_t grain, const Body& body) {
  const std::size_t chunks = (size + grain - 1) / grain;
  if (chunks <= 1) {
    if (size > 0) body(std::size_t{0}, size);
    return;
  }
  FirstFailure failure;
  const auto run = [&](std::size_t c) {
    if (failure.is_before(c)) return;
    const std::size_t begin = c * grain;
    failure.run(c, [&] { body(begin, begin + grain < size ? begin + grain : size); });
  };
  threads::for_each(chunks, std::ref(run));  // by reference: nothing is allocated
  failure.rethrow();
}

/// Calls job(number) for all of [0, size), begun in order and possibly running at the same time.
/// Throws what the first job that fails throws; jobs behind it may not run.
template <typename Job>
void parallel_in_order(std::size_t size, const Job& job) {
  std::atomic<std::size_t> next{0};
  FirstFailure failure;
  parallel_chunks(size, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t number = next++;
      if (!failure.is_before(number)) failure.run(number, [&] { job(number); });
    }
  });
  failure.rethrow();
}

/// Calls make(number, slot) for all of [0, size), possibly at the same time, and use(number, slot)
/// with the same slot in order and one at a time, but on any thread, while later ones are being
/// made. At most slots.size() > 0 items are under way. Throws what the first item that fails
/// throws, in make or in use; nothing behind it is used.
template <typename Slot, typename Make, typename Use>
void parallel_pipeline(std::size_t size, std::vector<Slot>& slots, const Make& make,
                       const Use& use) {
  FirstFailure failure;
  const auto slot_of = [&](std::size_t number) -> Slot& { return slots[number % slots.size()]; };
  const auto fill = [&](std::size_t number) {
    if (!failure.is_before(number)) failure.run(number, [&] { make(number, slot_of(number)); });
  };
  const auto empty = [&](std::size_t number) {
    if (failure.is_before(number + 1)) failure.rethrow();
    use(number, slot_of(number));
  };
  threads::pipeline(size, slots.size(), std::ref(fill), std::ref(empty));
}

/// Combines map(begin, end) over the chunks of [0, size) from left to right:
/// combine(...combine(combine(identity, m0), m1)..., mLast). The same bits for any thread count.
/// The first argument of combine is moved in, so that one that takes it by value may add to it.
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
  Value result = std::move(identity);
  for (const Partial& part : partial) result = combine(std::move(result), part.value);
  return result;
}

}  // namespace tetropolis
