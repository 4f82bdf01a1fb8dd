#include "palpable/live/sources/depth_unit.h"

#include "tests/support/test.h"

#include <cmath>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("the unit of a known device is its own, and of a name that was cut off not guessed",
          "[sources][depth_unit]") {
  CHECK(known_depth_unit("Intel(R) RealSense(TM) Depth Camera 405 ") == 1e-4);
  CHECK(known_depth_unit("RealSense D405") == 1e-4);
  CHECK(known_depth_unit("Intel RealSense L515") == 2.5e-4);
  CHECK(known_depth_unit("Intel(R) RealSense(TM) Camera SR300") == 1.25e-4);
  CHECK(known_depth_unit("Intel(R) RealSense(TM) Depth Camera 435i") == 1e-3);
  // 31 letters, as v4l2_capability has them: a D405 or a D435.
  CHECK_FALSE(known_depth_unit("Intel(R) RealSense(TM) Depth Ca"));
  CHECK_FALSE(known_depth_unit("USB Camera 405"));
  CHECK_FALSE(known_depth_unit(""));
}

TEST_CASE("what is stated counts in the order user, calibration, layout; else 1 mm is assumed",
          "[sources][depth_unit]") {
  FrameFormat format;
  const auto decide = [&](const DepthUnitStatements& stated) {
    const std::vector<std::string> notes = decide_depth_unit(stated, "clip", format);
    return notes.empty() ? std::string() : notes.front();
  };
  CHECK(decide({.asked = 1e-4, .calibration = 2e-4, .known = 3e-4, .known_of = "TUM"}).empty());
  CHECK(format.depth_unit == 1e-4);
  CHECK_FALSE(format.depth_unit_assumed);
  CHECK(decide({.asked = {}, .calibration = 2e-4, .known = 3e-4, .known_of = "TUM"}).empty());
  CHECK(format.depth_unit == 2e-4);
  CHECK_THAT(decide({.asked = {}, .calibration = {}, .known = 3e-4, .known_of = "TUM"}),
             Contains("clip: one step of its depth is 0.3 mm, as known of TUM"));
  CHECK(format.depth_unit == 3e-4);
  CHECK_FALSE(format.depth_unit_assumed);
  CHECK_THAT(decide({}), Contains("clip: nothing states the unit of its depth") &&
                             Contains("1 mm") && Contains("--depth-unit"));
  CHECK(format.depth_unit == 1e-3);
  CHECK(format.depth_unit_assumed);
}

TEST_CASE("a unit that is no length of a step is refused with what was probably meant",
          "[sources][depth_unit][refusal]") {
  for (const double unit : {1e-6, 1.0 / 256000, 1e-3, 1.0}) {
    CHECK(what_is_wrong_with_depth_unit(unit).empty());
  }
  CHECK_THAT(what_is_wrong_with_depth_unit(5000), Contains("5000 steps in a metre are 0.0002 m"));
  for (const double unit : {0.0, -0.001, 1e-7, 1.5, std::nan("")}) {
    CAPTURE(unit);
    CHECK_THAT(what_is_wrong_with_depth_unit(unit), Contains("0.001"));
  }
}

}  // namespace
}  // namespace palpable
