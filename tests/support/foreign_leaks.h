/// @file
/// Memory that a driver takes and does not give back is not our leak.
#pragma once

#include "tests/support/sanitizers.h"

#ifdef PALPABLE_ASAN
#include <sanitizer/lsan_interface.h>
#endif

namespace palpable::test {

/// While one lives, what is allocated is not looked at for leaks. For windows: the window library
/// unloads the GL driver when it ends, with a few hundred bytes still allocated, and LeakSanitizer
/// cannot name (and so not suppress) a library that is gone.
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
