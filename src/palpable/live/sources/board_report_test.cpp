#include "palpable/live/sources/board_report.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

constexpr double kRightAngle = 1.5707963267948966;

// A calibration from two boards in which every number has other digits.
struct Example {
  SeenBoards seen;
  BoardCalibration found;
  BoardPattern pattern{9, 6, 0.02};

  Example() {
    seen.views = {{3, {}, {}}, {12, {}, {}}};
    seen.pairs = 40;
    StereoRig& rig = found.calibration.rig;
    rig.left = {{640, 480, 500.25, 501.5, 320.5, 240.125}, {0.01, -0.02, 0.003, 0.004, 0.05}};
    rig.right = {{640, 480, 502.75, 503, 321, 239.5}, {-0.0125, 0.25, 0, 0, 0}};
    rig.right_from_left = Rigid3::Identity();
    rig.right_from_left.translation() = Eigen::Vector3d(-0.06, 0, 0);
    found.reprojection_px = 0.125;
    found.reprojections_px = {0.0625, 0.5};
    found.row_error_px = 0.25;
    found.focal_sigma = 0.005;
    found.tilt = kRightAngle / 3;
    found.covered = 0.75;
  }
};

TEST_CASE("people read each view's error, both lenses, the baseline in squares, and what is known",
          "[sources][calibration]") {
  Example example;
  CHECK(text_of(example.found, example.seen, example.pattern) ==
        "pair    3  reprojection 0.062 px\n"
        "pair   12  reprojection 0.500 px\n"
        "2 boards in 40 pairs; tilt 30 degrees, 75 % of the picture covered\n"
        "left   f 500.25 501.50 px, centre 320.50 240.12 px, k1 0.0100 k2 -0.0200\n"
        "right  f 502.75 503.00 px, centre 321.00 239.50 px, k1 -0.0125 k2 0.2500\n"
        "baseline 60.00 mm (3.000 squares); focal length known to 0.50 %\n"
        "reprojection 0.125 px rms, rows after rectification 0.250 px rms\n");
  example.seen.alike = 7;
  CHECK_THAT(text_of(example.found, example.seen, example.pattern),
             Contains("2 boards in 40 pairs (7 more were where another had been); tilt"));
  CHECK(json_of(example.found, example.seen)["weakness"].is_null());
  example.found.weakness = "the boards are few";
  CHECK_THAT(text_of(example.found, example.seen, example.pattern),
             Contains("\naccepted although the boards are few\n"));
  CHECK(json_of(example.found, example.seen)["weakness"].get<std::string>() ==
        example.found.weakness);
}

TEST_CASE("programs read the same numbers of a calibration", "[sources][calibration]") {
  const Example example;
  const Json json = json_of(example.found, example.seen);
  CHECK(json["pairs"].get<int>() == 40);
  CHECK(json["boards"].get<int>() == 2);
  CHECK(json["left"].dump() == R"({"fx_px":500.25,"fy_px":501.5,"cx_px":320.5,"cy_px":240.125,)"
                               R"("distortion":[0.01,-0.02,0.003,0.004,0.05]})");
  CHECK(json["right"]["fx_px"].get<double>() == 502.75);
  CHECK(json["baseline_m"].get<double>() == 0.06);
  CHECK(json["reprojection_px"].get<double>() == 0.125);
  CHECK(json["row_error_px"].get<double>() == 0.25);
  CHECK(json["focal_sigma"].get<double>() == 0.005);
  CHECK(json["tilt_degrees"].get<double>() == Approx(30));
  CHECK(json["covered"].get<double>() == 0.75);
}

}  // namespace
}  // namespace palpable
