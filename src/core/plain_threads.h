// The loops of parallel.h on threads of the standard library, for the thread sanitizer: TBB is not
// built with it, so that it would take nearly all that passes between tasks for races. Private to
// parallel.h.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tetropolis::plain_threads {

/// Calls work() on `count` threads at the same time, this one among them.
template <typename Work>
void on_threads(std::size_t count, const Work& work) {
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < count; ++i) others.emplace_back(work);
  work();
}

/// Calls body(i), which throws nothing, for all of [0, size), begun in order.
template <typename Body>
void for_each(std::size_t size, int threads, const Body& body) {
  std::atomic<std::size_t> next{0};
  on_threads(std::min(size, static_cast<std::size_t>(threads)), [&] {
    for (std::size_t i = next++; i < size; i = next++) body(i);
  });
}

/// Calls make(i), which throws nothing, for all of [0, size), and use(i) in order and one at a
/// time; at most `slots` items are under way. Rethrows what use throws first; nothing behind is
/// used.
template <typename Make, typename Use>
void pipeline(std::size_t size, std::size_t slots, int threads, const Make& make, const Use& use) {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t begun = 0, used = 0;
  std::exception_ptr thrown;
  on_threads(static_cast<std::size_t>(threads), [&] {
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

}  // namespace tetropolis::plain_threads
