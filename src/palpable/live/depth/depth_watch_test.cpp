#include "palpable/live/depth/depth_watch.h"

#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The result after `frames` more frames with the same values.
DepthTrouble after(DepthWatch& watch, int frames, double density, double row_error_px) {
  DepthTrouble last = DepthTrouble::kNone;
  for (int n = 0; n < frames; ++n) last = watch.look(density, row_error_px);
  return last;
}

TEST_CASE("too few depths are reported once they persist, and only while they do",
          "[depth][watch]") {
  DepthWatch watch;
  CHECK(after(watch, 23, 0.03, kUnknown) == DepthTrouble::kNone);
  CHECK(after(watch, 1, 0.03, kUnknown) == DepthTrouble::kFewDepths);
  CHECK(after(watch, 1, 0.3, kUnknown) == DepthTrouble::kNone);
}

TEST_CASE("a collapse of the density is reported, a difference between scenes is not",
          "[depth][watch]") {
  DepthWatch watch;
  CHECK(after(watch, 60, 0.55, 0.02) == DepthTrouble::kNone);
  CHECK(after(watch, 100, 0.2, 0.02) == DepthTrouble::kNone);
  CHECK(after(watch, 100, 0.12, 0.02) == DepthTrouble::kFewDepths);
  // A single frame with a high density does not become the reference.
  DepthWatch flashed;
  CHECK(after(flashed, 60, 0.1, 0.02) == DepthTrouble::kNone);
  CHECK(after(flashed, 1, 1.0, 0.02) == DepthTrouble::kNone);
  CHECK(after(flashed, 60, 0.1, 0.02) == DepthTrouble::kNone);
}

TEST_CASE("persistent row errors are reported, frames without a measurement change nothing",
          "[depth][watch]") {
  DepthWatch watch;
  CHECK(after(watch, 23, 0.4, -0.8) == DepthTrouble::kNone);
  CHECK(after(watch, 50, 0.4, kUnknown) == DepthTrouble::kNone);
  CHECK(after(watch, 1, 0.4, 0.8) == DepthTrouble::kRowsOff);
  CHECK(after(watch, 5, 0.01, kUnknown) == DepthTrouble::kRowsOff);
  CHECK(after(watch, 1, 0.4, 0.1) == DepthTrouble::kNone);
}

}  // namespace
}  // namespace palpable
