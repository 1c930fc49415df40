// Shared libraries that are loaded when first needed. GDAL, PROJ and HDF5 bring a hundred others
// along, and starting takes ten times as long with them.
#pragma once

#include <atomic>
#include <mutex>

#include "io/deferred/library_names.h"

namespace tetropolis {

/// A shared library, loaded by the first use of one of its symbols and kept until the process ends.
/// From all threads.
class DeferredLibrary {
 public:
  /// `file`: its full name, which ends in the SONAME. The system looks for that as for a library
  /// that is linked; only where it finds none is the folder asked for. Kept, not copied.
  explicit constexpr DeferredLibrary(const char* file) : file_(file) {}

  /// Throws Error(kUsage) if the library cannot be loaded or lacks the symbol.
  void* address(const char* symbol);

 private:
  void load();

  const char* file_;
  std::once_flag once_;
  void* handle_ = nullptr;
};

/// Its symbol of type `Type`, looked up once. Throws like DeferredLibrary::address.
template <typename Type>
class DeferredSymbol {
 public:
  constexpr DeferredSymbol(DeferredLibrary& library, const char* name)
      : library_(library), name_(name) {}

 protected:
  Type* get() const {
    void* address = address_.load(std::memory_order_acquire);
    if (address == nullptr)
      address_.store(address = library_.address(name_), std::memory_order_release);
    return reinterpret_cast<Type*>(address);
  }

 private:
  DeferredLibrary& library_;
  const char* name_;
  mutable std::atomic<void*> address_ = nullptr;
};

/// Is called, and handed on as a pointer, like the function of C that it stands for.
template <typename Function>
class DeferredFunction : DeferredSymbol<Function> {
 public:
  using DeferredSymbol<Function>::DeferredSymbol;
  operator Function*() const { return this->get(); }
};

/// Is read like the variable that it stands for.
template <typename Value>
class DeferredValue : DeferredSymbol<Value> {
 public:
  using DeferredSymbol<Value>::DeferredSymbol;
  operator Value() const { return *this->get(); }
};

}  // namespace tetropolis

/// In namespace tetropolis, hides the global function (variable) of that name.
#ifdef TETROPOLIS_DEFERRED
#define TETROPOLIS_DEFER(library, name) \
  inline constinit const DeferredFunction<decltype(::name)> name(library, #name)
#define TETROPOLIS_DEFER_VALUE(library, name) \
  inline constinit const DeferredValue<decltype(::name)> name(library, #name)
#else
#define TETROPOLIS_DEFER(library, name) using ::name
#define TETROPOLIS_DEFER_VALUE(library, name) using ::name
#endif
