// Marks hot loops that are compiled for wider vectors as well.
//
// Products are never fused with sums, so every version rounds the same way. Sanitizers do not
// support resolving such functions at load time.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TETROPOLIS_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define TETROPOLIS_WIDE
#endif
#define TETROPOLIS_INLINE __attribute__((always_inline)) inline
