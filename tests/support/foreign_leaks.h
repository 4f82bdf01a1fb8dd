/// @file
/// Excludes memory that a driver leaks from our leak detection.
#pragma once

#include "tests/support/sanitizers.h"

#ifdef PALPABLE_ASAN
#include <sanitizer/lsan_interface.h>
#endif

namespace palpable::test {

/// During its life, allocations are excluded from leak detection. For windows: the window library
/// unloads the GL driver at the end, with a few hundred bytes still allocated, and LeakSanitizer
/// cannot identify (and so not suppress) a library that is no longer loaded.
class IgnoreForeignLeaks {
 public:
#ifdef PALPABLE_ASAN
  IgnoreForeignLeaks() { __lsan_disable(); }
  ~IgnoreForeignLeaks() { __lsan_enable(); }
#else
  IgnoreForeignLeaks() = default;
  ~IgnoreForeignLeaks() {}
#endif
  IgnoreForeignLeaks(const IgnoreForeignLeaks&) = delete;
  IgnoreForeignLeaks& operator=(const IgnoreForeignLeaks&) = delete;
};

}  // namespace palpable::test
