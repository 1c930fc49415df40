#include "call.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include <nanobind/stl/string.h>

#include "tetropolis/run/progress.h"

namespace tetropolis::python {

namespace {

/// What the working thread tells the calling one.
struct Shared {
  std::mutex mutex;  ///< Of all that follows.
  std::condition_variable ended_or_news;
  std::string step;
  double share = 0;
  bool news = false;
  bool ended = false;
  bool cancelled = false;
  std::exception_ptr thrown;
};

/// `run`: turns what is done of a step into a share of the whole.
StepHooks hooks_into(Shared& shared, RunProgress& run) {
  StepHooks hooks;
  const auto tell = [&shared, &run] {
    shared.share = run.share();
    shared.news = true;
  };
  hooks.step_begins = [&shared, &run, tell](const StepTime& step) {
    const std::lock_guard lock(shared.mutex);
    shared.step = step.name;
    run.begin(step);
    tell();
  };
  hooks.step_progress = [&shared, &run, tell](double fraction) {
    const std::lock_guard lock(shared.mutex);
    run.update(fraction);
    tell();
  };
  hooks.step_ends = [&shared, &run, tell](const StepTime& step) {
    const std::lock_guard lock(shared.mutex);
    run.end(step);
    tell();
  };
  hooks.cancelled = [&shared] {
    const std::lock_guard lock(shared.mutex);
    return shared.cancelled;
  };
  return hooks;
}

StepHooks hooks_into(Shared& shared) {
  StepHooks hooks;
  hooks.step_progress = [&shared](double fraction) {
    const std::lock_guard lock(shared.mutex);
    shared.share = fraction;
    shared.news = true;
  };
  hooks.cancelled = [&shared] {
    const std::lock_guard lock(shared.mutex);
    return shared.cancelled;
  };
  return hooks;
}

/// Signals and progress, with the lock of the interpreter. Throws nb::python_error.
void look_around(const nb::object& progress, const std::string& step, double share, bool news) {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  if (news && !progress.is_none()) progress(step, share);
}

/// See call().
void follow(const nb::object& progress, Shared& shared, const StepHooks& hooks, const Work& work) {
  constexpr std::chrono::milliseconds kLook{50};
  std::exception_ptr raised;  // by Python
  {
    const nb::gil_scoped_release release;
    std::thread worker([&] {
      std::exception_ptr thrown;
      try {
        work(hooks);
      } catch (...) {
        thrown = std::current_exception();
      }
      const std::lock_guard lock(shared.mutex);
      shared.thrown = thrown;
      shared.ended = true;
      shared.ended_or_news.notify_one();
    });
    std::unique_lock lock(shared.mutex);
    while (!shared.ended_or_news.wait_for(lock, kLook, [&] { return shared.ended; })) {
      if (shared.cancelled) continue;
      const std::string step = shared.step;
      const double share = shared.share;
      const bool news = shared.news;
      shared.news = false;
      lock.unlock();
      bool stop = false;
      {
        const nb::gil_scoped_acquire acquire;
        try {
          look_around(progress, step, share, news);
        } catch (...) {
          raised = std::current_exception();
          stop = true;
        }
      }
      lock.lock();
      shared.cancelled = stop;
    }
    lock.unlock();
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (shared.thrown) std::rethrow_exception(shared.thrown);
  look_around(progress, shared.step, 1, true);
}

}  // namespace

void call(const nb::object& progress, Command command, const Config& config, const Work& work) {
  Shared shared;
  RunProgress run(command, config);
  follow(progress, shared, hooks_into(shared, run), work);
}

void call(const nb::object& progress, const char* step, const Work& work) {
  Shared shared;
  shared.step = step;
  follow(progress, shared, hooks_into(shared), work);
}

}  // namespace tetropolis::python
