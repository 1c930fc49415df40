// TETROPOLIS_SANITIZED is 1 in builds under the address or the thread sanitizer, otherwise 0: they
// need more address space than any limit leaves.
#pragma once

#if defined(__has_feature)  // Clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TETROPOLIS_SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TETROPOLIS_SANITIZED 1
#endif
#ifndef TETROPOLIS_SANITIZED
#define TETROPOLIS_SANITIZED 0
#endif
