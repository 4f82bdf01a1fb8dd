#include "palpable/live/depth/depth_watch.h"

#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// What is said after `frames` more frames of a kind.
DepthTrouble after(DepthWatch& watch, int frames, double density, double row_error_px) {
  DepthTrouble last = DepthTrouble::kNone;
  for (int n = 0; n < frames; ++n) last = watch.look(density, row_error_px);
  return last;
}

TEST_CASE("a picture with hardly any depth is told once it lasts, and no longer than it lasts",
          "[depth][watch]") {
  DepthWatch watch;
  CHECK(after(watch, 23, 0.03, kUnknown) == DepthTrouble::kNone);
  CHECK(after(watch, 1, 0.03, kUnknown) == DepthTrouble::kFewDepths);
  CHECK(after(watch, 1, 0.3, kUnknown) == DepthTrouble::kNone);
}

TEST_CASE("a density that collapses is told, one that differs from scene to scene is not",
          "[depth][watch]") {
  DepthWatch watch;
  CHECK(after(watch, 60, 0.55, 0.02) == DepthTrouble::kNone);
  CHECK(after(watch, 100, 0.2, 0.02) == DepthTrouble::kNone);
  CHECK(after(watch, 100, 0.12, 0.02) == DepthTrouble::kFewDepths);
  // A single flash is no best that all else is measured by.
  DepthWatch flashed;
  CHECK(after(flashed, 60, 0.1, 0.02) == DepthTrouble::kNone);
  CHECK(after(flashed, 1, 1.0, 0.02) == DepthTrouble::kNone);
  CHECK(after(flashed, 60, 0.1, 0.02) == DepthTrouble::kNone);
}

TEST_CASE("rows that stay out of line are told, frames that cannot say so change nothing",
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
