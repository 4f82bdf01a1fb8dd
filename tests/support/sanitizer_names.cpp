// Settings that the sanitizers, which are libraries, look up in a test program: their names
// must be exported.
#include "tests/support/sanitizer_names.h"

#include "tests/support/full_disk.h"
#include "tests/support/sanitizers.h"

bool palpable::test::sanitizer_names_are_here() { return true; }

#define PALPABLE_SEEN extern "C" __attribute__((visibility("default")))

#ifdef PALPABLE_ASAN
// LeakSanitizer calls this before its check.
PALPABLE_SEEN int __lsan_is_turned_off();                                               // NOLINT
PALPABLE_SEEN int __lsan_is_turned_off() { return palpable::test::leaks_are_foreign; }  // NOLINT

// AddressSanitizer guesses where glibc keeps the thread-local memory of libraries that are
// loaded late (Mesa's drivers), and reads it from two words before; LeakSanitizer crashes
// after a wrong guess.
PALPABLE_SEEN const char* __asan_default_options();                                        // NOLINT
PALPABLE_SEEN const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }  // NOLINT
#endif

#ifdef PALPABLE_TSAN
// Debian's OpenCV, its thread pool, its GDAL, and FFmpeg, which decodes on threads of its own, are
// not built for ThreadSanitizer, which therefore cannot see their synchronization; reports about
// our own code remain. The sanitizer looks up this name.
PALPABLE_SEEN const char* __tsan_default_suppressions();   // NOLINT: the sanitizer's name
PALPABLE_SEEN const char* __tsan_default_suppressions() {  // NOLINT
  return "race:libopencv_\nrace:libtbb\nrace:libavcodec\nrace:libavutil\ndeadlock:libgdal\n";
}
#endif
