#include "deferred_library.h"

#include <string>
#include <string_view>

#include <dlfcn.h>
#include <fmt/format.h>

#include "tetropolis/core/error.h"

namespace tetropolis {

void* DeferredLibrary::address(const char* symbol) {
  std::call_once(once_, [&] { load(); });
  // As the library itself resolves it: a program that is linked with it, too, may hold its
  // variables.
  void* address = dlsym(RTLD_DEFAULT, symbol);
  if (address == nullptr) address = dlsym(handle_, symbol);
  if (address == nullptr)
    throw Error(ErrorKind::kUsage,
                fmt::format("{}: has no {}; install the release that Tetropolis was built with",
                            file_, symbol));
  return address;
}

void DeferredLibrary::load() {
  const std::string_view name =
      std::string_view(file_).substr(std::string_view(file_).rfind('/') + 1);
  handle_ = dlopen(name.data(), RTLD_LAZY | RTLD_LOCAL);
  if (handle_ != nullptr) return;
  const std::string reason = dlerror();
  handle_ = dlopen(file_, RTLD_LAZY | RTLD_LOCAL);
  if (handle_ == nullptr)
    throw Error(ErrorKind::kUsage, fmt::format("{}; install the library", reason));
}

}  // namespace tetropolis
