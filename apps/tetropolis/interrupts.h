// Ctrl-C, SIGTERM and SIGHUP: a run is asked to stop, and ended within a second if it does not. And
// crashes of a library on broken input, which end it in good order too.
#pragma once

#include <functional>
#include <string>

#include "tetropolis/run/output_folder.h"

namespace tetropolis::app {

inline constexpr int kInterruptedExit = 130;

/// Call once, first. A SIGHUP that is ignored (nohup) stays ignored. A first signal sets
/// interrupted(); a run that does not look soon enough (it is inside a library, or a file system
/// hangs) loses its hidden folder, and the process ends with kInterruptedExit. A second signal does
/// that at once, a third ends the process as it is. Results that have begun to move to their place
/// are waited for. A crash inside ForeignCode ends the process with one line that names the input,
/// and as other errors of input do.
void catch_interrupts();

bool interrupted();

/// Tells what to remove where a run has to be ended.
OutputWatcher watch_output();

/// Does not return if a handler is ending the process: what fails then does so because the handler
/// removes its files.
void wait_if_ending();

/// Calls `say` with the last line of an interrupted run. Returns kInterruptedExit. Call once, and
/// wait_if_ending() not after it.
int say_interrupted(const std::function<void(const std::string&)>& say);

}  // namespace tetropolis::app
