#include "gdal_support.h"

#include <mutex>

#include "tetropolis/core/error.h"

namespace tetropolis::gdal {

void initialise() {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
}

QuietErrors::QuietErrors() { CPLPushErrorHandlerEx(&QuietErrors::collect, this); }

QuietErrors::~QuietErrors() {
  CPLPopErrorHandler();
  CPLErrorReset();
}

void CPL_STDCALL QuietErrors::collect(CPLErr kind, CPLErrorNum, const char* message) noexcept {
  if (kind != CE_Failure && kind != CE_Fatal) return;
  auto* self = static_cast<QuietErrors*>(CPLGetErrorHandlerUserData());
  if (self == nullptr || message == nullptr) return;
  const bool is_first = self->failures_++ == 0;
  try {
    std::string line = one_line(message);
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    if (is_first) self->first_ = line;
    self->last_ = std::move(line);
  } catch (...) {  // No memory for the text. GDAL, which calls this, is C.
  }
}

std::string QuietErrors::reason() const { return last_.empty() ? "" : ": " + last_; }

void QuietErrors::reset() {
  failures_ = 0;
  first_.clear();
  last_.clear();
}

ThreadOption::ThreadOption(const char* key, const char* value) : key_(key) {
  if (const char* previous = CPLGetThreadLocalConfigOption(key, nullptr)) {
    previous_ = previous;
    had_previous_ = true;
  }
  CPLSetThreadLocalConfigOption(key, value);
}

ThreadOption::~ThreadOption() {
  CPLSetThreadLocalConfigOption(key_.c_str(), had_previous_ ? previous_.c_str() : nullptr);
}

}  // namespace tetropolis::gdal
