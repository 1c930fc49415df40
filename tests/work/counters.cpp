#include "counters.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <geos_c.h>
#include <malloc.h>

#include "geometry/predicates.h"

// The linker leads calls of NAME to __wrap_NAME, and calls of __real_NAME to NAME.
extern "C" void* __real_calloc(std::size_t count, std::size_t size);
extern "C" void __real_free(void* memory);

namespace {

std::atomic<std::int64_t> allocations, allocated_bytes, live_bytes, peak_bytes, start_bytes;
std::atomic<std::int64_t> exact_orientations, exact_circles, geos_operations;

void count(void* memory, std::size_t size) {
  ++allocations;
  allocated_bytes += static_cast<std::int64_t>(size);
  const std::int64_t live = live_bytes += static_cast<std::int64_t>(malloc_usable_size(memory));
  std::int64_t peak = peak_bytes;
  while (live > peak && !peak_bytes.compare_exchange_weak(peak, live)) {
  }
}

void* allocate(std::size_t size, std::size_t alignment) {
  void* memory = alignment == 0 ? std::malloc(size == 0 ? 1 : size)
                                : std::aligned_alloc(
                                      alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  count(memory, size);
  return memory;
}

void release(void* memory) noexcept {
  if (memory == nullptr) return;
  live_bytes -= static_cast<std::int64_t>(malloc_usable_size(memory));
  __real_free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new[](std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
// As algorithms of the library take their buffers.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept try {
  return allocate(size, 0);
} catch (const std::bad_alloc&) {
  return nullptr;
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace tetropolis {

#define TETROPOLIS_ORIENT2D "_ZN10tetropolis10predicates14orient2d_exactENS_6Point2ES1_S1_"
#define TETROPOLIS_INCIRCLE "_ZN10tetropolis10predicates14incircle_exactENS_6Point2ES1_S1_S1_"

int real_orient2d(Point2 a, Point2 b, Point2 c) asm("__real_" TETROPOLIS_ORIENT2D);
int real_incircle(Point2 a, Point2 b, Point2 c, Point2 d) asm("__real_" TETROPOLIS_INCIRCLE);
int counted_orient2d(Point2 a, Point2 b, Point2 c) asm("__wrap_" TETROPOLIS_ORIENT2D);
int counted_incircle(Point2 a, Point2 b, Point2 c, Point2 d) asm("__wrap_" TETROPOLIS_INCIRCLE);

int counted_orient2d(Point2 a, Point2 b, Point2 c) {
  ++exact_orientations;
  return real_orient2d(a, b, c);
}

int counted_incircle(Point2 a, Point2 b, Point2 c, Point2 d) {
  ++exact_circles;
  return real_incircle(a, b, c, d);
}

}  // namespace tetropolis

extern "C" {

void* __wrap_calloc(std::size_t count_of, std::size_t size);
void* __wrap_calloc(std::size_t count_of, std::size_t size) {
  void* memory = __real_calloc(count_of, size);
  if (memory != nullptr) count(memory, count_of * size);
  return memory;
}

// Of the library's own code, only what calloc gave is freed this way.
void __wrap_free(void* memory);
void __wrap_free(void* memory) { release(memory); }

#define TETROPOLIS_COUNT_GEOS(result, name, parameters, arguments) \
  result __real_##name parameters;                                 \
  result __wrap_##name parameters;                                 \
  result __wrap_##name parameters {                                \
    ++geos_operations;                                             \
    return __real_##name arguments;                                \
  }

TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSUnaryUnion_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a), (context, a))
TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSUnaryUnionPrec_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a, double grid),
                      (context, a, grid))
TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSDifferencePrec_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a, const GEOSGeometry* b,
                       double grid),
                      (context, a, b, grid))
TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSIntersectionPrec_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a, const GEOSGeometry* b,
                       double grid),
                      (context, a, b, grid))
TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSMakeValid_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a), (context, a))
TETROPOLIS_COUNT_GEOS(GEOSGeometry*, GEOSMakeValidWithParams_r,
                      (GEOSContextHandle_t context, const GEOSGeometry* a,
                       const GEOSMakeValidParams* how),
                      (context, a, how))
TETROPOLIS_COUNT_GEOS(char, GEOSisValid_r, (GEOSContextHandle_t context, const GEOSGeometry* a),
                      (context, a))

}  // extern "C"

namespace tetropolis::testing {

void start_counting() {
  start_bytes = peak_bytes = live_bytes.load();
  allocations = allocated_bytes = exact_orientations = exact_circles = geos_operations = 0;
}

Counts counts() {
  return {allocations,        allocated_bytes, peak_bytes - start_bytes,
          exact_orientations, exact_circles,   geos_operations};
}

}  // namespace tetropolis::testing
