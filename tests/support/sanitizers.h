/// @file
/// Which sanitizer a test is compiled with: GCC defines a macro, Clang has a feature.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define PALPABLE_ASAN
#endif
#if defined(__SANITIZE_THREAD__)
#define PALPABLE_TSAN
#endif
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PALPABLE_ASAN
#endif
#if __has_feature(thread_sanitizer)
#define PALPABLE_TSAN
#endif
#endif
