// What a library that broken input may crash is reading, for a program's signal handlers.
#pragma once

namespace tetropolis {

/// What another library (GDAL, LASzip, ...) reads for this thread now: a file's name, or nullptr.
/// While it is not nullptr the thread has a second stack for signal handlers (sigaltstack). May be
/// called from a signal handler; the library installs none.
const char* foreign_input();

}  // namespace tetropolis
