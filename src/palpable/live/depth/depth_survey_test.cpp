#include "palpable/live/depth/depth_survey.h"

#include "palpable/live/depth/depth_camera.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

FrameFormat sensor_format(double unit, bool assumed) {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.depth_camera = {kWidth, kHeight, 140, 140, 80, 60};
  set_size(format, kWidth, kHeight);
  format.depth_unit = unit;
  format.depth_unit_assumed = assumed;
  return format;
}

// A desk that rises towards the back with 2 mm of noise, and a box on it, mm.
int desk(int x, int y, int frame) {
  const int noise = ((x * 31 + y * 17 + frame * 7) * 40503 & 0xFFFF) % 5 - 2;
  const bool box = x > 60 && x < 100 && y > 40 && y < 80;
  return (box ? 520 : 620 - y) + noise;
}

int swapped(int number) { return (number & 0xFF) << 8 | number >> 8; }

struct Survey {
  std::vector<std::string> warnings;
  DepthFigures figures;
};

// The survey of a sensor's frames, whose numbers are number(x, y, frame).
Survey survey_of(const FrameFormat& format, int frames,
                 const std::function<int(int, int, int)>& number,
                 const DepthSettings& settings = {}) {
  DepthCamera camera = std::move(DepthCamera::make(format, settings).value());
  DepthSurvey survey("clip", format, camera.rectified());
  Frame frame;
  frame.left.resize(kWidth, kHeight);
  frame.depth.resize(kWidth, kHeight);
  SeenFrame seen;
  Survey result;
  for (int n = 0; n < frames; ++n) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int step = number(x, y, n);
        frame.depth(x, y) = step == 0 || step == 65535
                                ? std::numeric_limits<float>::quiet_NaN()
                                : static_cast<float>(step) * static_cast<float>(format.depth_unit);
      }
    }
    frame.number = n;
    camera.see(frame, seen);
    survey.add(seen);
  }
  survey.finish();
  survey.finish();
  result.warnings = survey.take_warnings();
  result.figures = survey.figures();
  return result;
}

TEST_CASE("the depths of a desk in millimetres have a median, a range and no warning",
          "[depth][survey]") {
  for (const bool assumed : {true, false}) {
    for (const int frames : {1, 12, 40}) {
      const Survey survey = survey_of(sensor_format(1e-3, assumed), frames, desk);
      CHECK(survey.warnings.empty());
      CHECK(survey.figures.median == Approx(0.55).epsilon(0.02));  // half of the rows
      CHECK(survey.figures.low == Approx(0.507).epsilon(0.02));
      CHECK(survey.figures.high == Approx(0.614).epsilon(0.02));
      CHECK(survey.figures.measured == 1);
      CHECK(survey.figures.kept == 1);
    }
  }
  const std::string text = text_of(survey_of(sensor_format(1e-3, true), 3, desk).figures);
  CHECK_THAT(text, Contains("measured in 100 % of the pixels, kept in 100 %; median 0.5") &&
                       Contains("a step is 1 mm, which is assumed\n"));
}

std::function<int(int, int, int)> desk_times(int factor) {
  return [factor](int x, int y, int n) { return factor * desk(x, y, n); };
}

// Numbers of a scene within 0.2 m, in 256ths of a millimetre, of a sensor with whole millimetres.
int near_in_256ths(int x, int y, int n) { return 256 * (desk(x, y, n) / 4 + 20); }

// Depths, mm, of a flat desk that a camera looks straight down at: 513 to 521, so that an image
// holds nine different numbers only.
int flat_desk(int x, int y, int n) { return 513 + (7 * x + 13 * y + 5 * n) % 9; }

TEST_CASE("right depths in other units, and of odd scenes, give no warning",
          "[depth][survey][false_alarm]") {
  const auto warnings = [](double unit, bool assumed, const std::function<int(int, int, int)>& of) {
    return survey_of(sensor_format(unit, assumed), 40, of).warnings;
  };
  CHECK(warnings(0.2e-3, false, desk_times(5)).empty());   // TUM
  CHECK(warnings(0.25e-3, false, desk_times(4)).empty());  // 4000 steps in a metre
  CHECK(warnings(1e-4, false, desk_times(10)).empty());    // D405
  CHECK(warnings(1.0 / 256000, false, near_in_256ths).empty());
  // Boards at distances that differ by 256 mm, and a wall of one number.
  CHECK(warnings(1e-3, true, [](int x, int, int) { return 512 + 256 * (x / 40); }).empty());
  CHECK(warnings(1e-3, true, [](int x, int, int) { return 512 + 256 * (x / 20); }).empty());
  CHECK(warnings(1e-3, true, [](int, int, int) { return 500; }).empty());
  // A flat desk with noise.
  CHECK(warnings(1e-3, true, flat_desk).empty());
  // A third of the pixels are holes, as 7-Scenes writes them: 65535.
  const Survey holes = survey_of(sensor_format(1e-3, true), 40, [](int x, int y, int n) {
    return (x + y) % 3 == 0 ? 65535 : desk(x, y, n);
  });
  CHECK(holes.warnings.empty());
  CHECK(holes.figures.measured == Approx(0.667).margin(0.002));
  // A hall of which only a corner is within 5 m; a lens that is covered for half a second.
  CHECK(warnings(1e-3, true, [](int x, int y, int n) {
          return y > 110 ? 3000 + desk(x, y, n) : 6000 + 20 * desk(x, y, n);
        }).empty());
  CHECK(warnings(1e-3, true, [](int x, int y, int n) {
          return n > 5 && n < 20 ? 0 : desk(x, y, n);
        }).empty());
}

TEST_CASE("swapped bytes are noticed on a flat desk, too", "[depth][survey]") {
  const Survey swapped = survey_of(sensor_format(1e-3, true), 12, [](int x, int y, int n) {
    const int number = flat_desk(x, y, n);
    return (number & 255) * 256 + number / 256;
  });
  REQUIRE(swapped.warnings.size() == 1);
  CHECK_THAT(swapped.warnings[0], Contains("the two bytes of each number are swapped"));
}

TEST_CASE("numbers that are all multiples of one are of another unit, if nothing states it",
          "[depth][survey]") {
  const Survey tum = survey_of(sensor_format(1e-3, true), 3, desk_times(5));
  REQUIRE(tum.warnings.size() == 1);
  CHECK_THAT(tum.warnings[0], Contains("multiples of 5 steps (median 2.") && Contains("unit") &&
                                  Contains("5000 steps in a metre are --depth-unit 0.2mm"));
  const Survey fourth = survey_of(sensor_format(1e-3, true), 3, desk_times(4));
  REQUIRE(fourth.warnings.size() == 1);
  CHECK_THAT(fourth.warnings[0], Contains("4000 steps") && Contains("--depth-unit 0.25mm"));
  const Survey by_256 = survey_of(sensor_format(1e-3, true), 3, near_in_256ths, {.farthest = 100});
  REQUIRE(by_256.warnings.size() == 1);
  CHECK_THAT(by_256.warnings[0], Contains("a 256th of it (--depth-unit 0.00390625mm)"));
  CHECK(survey_of(sensor_format(1e-3, false), 3, desk_times(5)).warnings.empty());  // stated
}

TEST_CASE("a scene with nothing from 0.1 to 5 m is warned of once, with the unit",
          "[depth][survey]") {
  for (const auto& [unit, says] : {std::pair{1.0, "a step another unit than 1000 mm"},
                                   std::pair{1e-6, "a step another unit than 0.001 mm"}}) {
    for (const int frames : {2, 45}) {
      const Survey survey = survey_of(sensor_format(unit, false), frames, desk, {.farthest = 1e4});
      REQUIRE(survey.warnings.size() == 1);
      CHECK_THAT(survey.warnings[0], Contains("no depths from 0.1 to 5 m") && Contains(says));
    }
  }
}

TEST_CASE("a car's rig may see nothing near, a narrow one may not", "[depth][survey]") {
  SeenFrame seen;
  seen.measured.measured = seen.measured.kept = 0.6;
  for (int k = 0; k < 500; ++k) seen.measured.sample(8 + 0.05F * static_cast<float>(k));
  FrameFormat format;
  for (const auto& [baseline, warnings] : {std::pair{0.54, 0U}, std::pair{0.063, 1U}}) {
    const RectifiedStereo rig{{640, 480, 500, 500, 320, 240}, baseline, 0};
    DepthSurvey survey("", format, &rig);
    for (int n = 0; n < 60; ++n) survey.add(seen);
    survey.finish();
    const std::vector<std::string> lines = survey.take_warnings();
    REQUIRE(lines.size() == warnings);
    if (warnings > 0) CHECK_THAT(lines[0], Contains("baseline of the calibration, 63 mm"));
  }
}

TEST_CASE("what was measured and what was kept are two figures, and hardly any for 30 frames warns",
          "[depth][survey]") {
  // Sensors: nothing is measured; all lies beyond the largest depth.
  const auto nothing = [](int, int, int) { return 0; };
  for (const int frames : {1, 40}) {
    const Survey zero = survey_of(sensor_format(1e-3, true), frames, nothing);
    REQUIRE(zero.warnings.size() == 1);
    CHECK_THAT(zero.warnings[0], Contains("measured in 0 % of the pixels and kept in 0 %"));
    CHECK(zero.figures.median == 0);
    CHECK_THAT(text_of(zero.figures), Contains("measured in 0 % of the pixels, kept in 0 %"));
  }
  const Survey far = survey_of(sensor_format(1e-3, true), 40, desk, {.farthest = 0.3});
  REQUIRE(far.warnings.size() == 1);
  CHECK_THAT(far.warnings[0], Contains("measured in 100 % of the pixels and kept in 0 %") &&
                                  Contains("100 % beyond the largest depth"));
  CHECK(far.figures.measured == 1);
  CHECK(far.figures.kept == 0);
  // Stereo: all is nearer than the searched range.
  SeenFrame close;
  close.measured.measured = close.measured.too_close = 0.93;
  const RectifiedStereo rig{{640, 480, 500, 500, 320, 240}, 0.0025, 0};
  DepthSurvey survey("", FrameFormat(), &rig);
  int first = 0;
  for (int n = 0; n < 60; ++n) {
    survey.add(close);
    const std::vector<std::string> lines = survey.take_warnings();
    if (lines.empty()) continue;
    CHECK(first == 0);
    first = n + 1;
    CHECK_THAT(lines[0], Contains("measured in 93 % of the pixels and kept in 0 %, in 30 frames") &&
                             Contains("baseline, 2.5 mm"));
  }
  CHECK(first == 30);
}

TEST_CASE("a frame adds itself to the survey without memory", "[depth][survey][law]") {
  DepthSurvey survey("clip", sensor_format(1e-3, true), nullptr);
  SeenFrame seen;
  seen.measured.measured = seen.measured.kept = 1;
  for (int k = 1; k < 600; ++k) seen.measured.sample(1e-3F * static_cast<float>(k + 400));
  const auto add = [&] {
    for (int n = 0; n < 100; ++n) survey.add(seen);
  };
  CHECK(test::allocations_during(add) == 0);
  CHECK(survey.frames() == 100);
}

TEST_CASE("the histogram of depths is right to half a percent", "[depth][survey]") {
  for (const float Z : {0.0021F, 0.1F, 0.4999F, 0.5F, 1.0F, 7.77F, 3000.0F}) {
    DepthBins bins;
    bins.add(Z);
    CHECK(bins.percentile(0.5) == Approx(Z).epsilon(0.0041));  // half of the widest bin, 1/128
  }
  DepthBins bins;
  CHECK(bins.percentile(0.5) == 0);
  for (int k = 1; k <= 1000; ++k) bins.add(1e-3F * static_cast<float>(k));
  for (const float Z : {1e-9F, 1e9F}) bins.add(Z);  // outside of the range: at its ends
  CHECK(bins.count() == 1002);
  CHECK(bins.percentile(0.05) == Approx(0.05).epsilon(0.02));
  CHECK(bins.percentile(0.95) == Approx(0.95).epsilon(0.01));
}

TEST_CASE("swapped bytes are told from the differences of neighbours", "[depth][survey]") {
  for (const int frames : {1, 12, 40}) {
    const Survey survey = survey_of(sensor_format(1e-3, true), frames,
                                    [](int x, int y, int n) { return swapped(desk(x, y, n)); });
    REQUIRE(survey.warnings.size() == 1);
    CHECK_THAT(survey.warnings[0], Contains("warning: clip: ") && Contains("bytes") &&
                                       Contains("swapped") && Contains("median"));
  }
}

}  // namespace
}  // namespace palpable
