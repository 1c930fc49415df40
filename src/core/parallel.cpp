#include "parallel.h"

#ifdef TETROPOLIS_PLAIN_THREADS
// Threads of the standard library, for the thread sanitizer: TBB is not built with it, so that it
// would take nearly all that passes between tasks for races.
#include <algorithm>
#include <condition_variable>
#include <thread>

#include "tetropolis/core/threads.h"
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#endif

namespace tetropolis::threads {

#ifdef TETROPOLIS_PLAIN_THREADS

namespace {

/// Calls work() on `count` threads at the same time, this one among them.
template <typename Work>
void on_threads(std::size_t count, const Work& work) {
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < count; ++i) others.emplace_back(work);
  work();
}

}  // namespace

void for_each(std::size_t size, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  on_threads(std::min(size, static_cast<std::size_t>(thread_count())), [&] {
    for (std::size_t i = next++; i < size; i = next++) body(i);
  });
}

void pipeline(std::size_t size, std::size_t slots, const std::function<void(std::size_t)>& make,
              const std::function<void(std::size_t)>& use) {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t begun = 0, used = 0;
  std::exception_ptr thrown;
  on_threads(static_cast<std::size_t>(thread_count()), [&] {
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [&] { return thrown || begun == size || begun < used + slots; });
      if (thrown || begun == size) return;
      const std::size_t number = begun++;
      lock.unlock();
      make(number);
      lock.lock();
      changed.wait(lock, [&] { return thrown || used == number; });
      if (thrown) return;
      lock.unlock();
      try {
        use(number);
        lock.lock();
      } catch (...) {
        lock.lock();
        thrown = std::current_exception();
      }
      ++used;
      changed.notify_all();
    }
  });
  if (thrown) std::rethrow_exception(thrown);
}

#else

void for_each(std::size_t size, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, size, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
      },
      tbb::simple_partitioner());
}

void pipeline(std::size_t size, std::size_t slots, const std::function<void(std::size_t)>& make,
              const std::function<void(std::size_t)>& use) {
  std::size_t next = 0;
  const auto take = [&](tbb::flow_control& control) -> std::size_t {
    if (next < size) return next++;
    control.stop();
    return size;
  };
  const auto pass = [&](std::size_t number) {
    make(number);
    return number;
  };
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      slots, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, take) &
                 tbb::make_filter<std::size_t, std::size_t>(filter_mode::parallel, pass) &
                 tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, use));
}

#endif

}  // namespace tetropolis::threads
