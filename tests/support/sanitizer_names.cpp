// What the sanitizers, which are libraries, ask a test program for: its names must be seen from
// outside.
#include "tests/support/sanitizer_names.h"

#include "tests/support/full_disk.h"
#include "tests/support/sanitizers.h"

bool palpable::test::sanitizer_names_are_here() { return true; }

#define PALPABLE_SEEN extern "C" __attribute__((visibility("default")))

#ifdef PALPABLE_ASAN
// LeakSanitizer asks for this name before it looks.
PALPABLE_SEEN int __lsan_is_turned_off();                                               // NOLINT
PALPABLE_SEEN int __lsan_is_turned_off() { return palpable::test::leaks_are_foreign; }  // NOLINT

// AddressSanitizer guesses where glibc keeps the thread's memory of libraries that are loaded late
// (Mesa's drivers), and takes it from two words before that; LeakSanitizer dies of a wrong guess.
PALPABLE_SEEN const char* __asan_default_options();                                        // NOLINT
PALPABLE_SEEN const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }  // NOLINT
#endif

#ifdef PALPABLE_TSAN
// Debian's OpenCV, its thread pool and the GDAL behind it are not built for ThreadSanitizer, which
// therefore cannot see how they hand work over; what it says about our own code stays. The linker
// looks for this name.
PALPABLE_SEEN const char* __tsan_default_suppressions();   // NOLINT: the sanitizer's name
PALPABLE_SEEN const char* __tsan_default_suppressions() {  // NOLINT
  return "race:libopencv_\nrace:libtbb\ndeadlock:libgdal\n";
}
#endif
