// Long calls: the interpreter stays free, Ctrl-C ends them, progress is told on the caller's
// thread.
#pragma once

#include <functional>

#include <nanobind/nanobind.h>

#include "tetropolis/core/steps.h"

namespace tetropolis::python {

namespace nb = nanobind;

/// Runs work(hooks) on a thread of its own, without the interpreter's lock. Meanwhile the calling
/// thread, which has it before and after, looks for signals twenty times a second and calls
/// progress(step, fraction) (unless it is None) when there is news: Python code runs on no other
/// thread. What either raises ends the work, by Cancelled, and is raised when it has ended. Throws
/// what `work` throws.
void call(const nb::object& progress, const std::function<void(const StepHooks&)>& work);

}  // namespace tetropolis::python
