// Long calls: the interpreter stays free, Ctrl-C ends them, progress is told on the caller's
// thread.
#pragma once

#include <functional>

#include <nanobind/nanobind.h>

#include "tetropolis/core/steps.h"
#include "tetropolis/run/config.h"

namespace tetropolis::python {

namespace nb = nanobind;

using Work = std::function<void(const StepHooks&)>;

/// Runs work(hooks) on a thread of its own, without the interpreter's lock. Meanwhile the calling
/// thread, which has it before and after, looks for signals twenty times a second and calls
/// progress(step, share of the whole) (unless it is None) when there is news: Python code runs on
/// no other thread. What either raises ends the work, by Cancelled, and is raised when it has
/// ended. Throws what `work` throws. The work is steps of `command` with `config`.
void call(const nb::object& progress, Command command, const Config& config, const Work& work);

/// The same of one step by itself.
void call(const nb::object& progress, const char* step, const Work& work);

}  // namespace tetropolis::python
