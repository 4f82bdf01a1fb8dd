#include "palpable/live/sources/calibrate_source.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/source_calibration.h"
#include "tests/support/board_picture.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <array>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

constexpr int kWidth = 320;  // px, one eye
constexpr int kHeight = 240;
constexpr double kFocal = 300;      // px
constexpr double kBaseline = 0.07;  // m
const BoardPattern kBoard{7, 4, 0.03};

// left_from_board of a board with centre `middle`, rotated about X and Y.
Rigid3 board_at(double about_x, double about_y, const Vector3d& middle) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = (Eigen::AngleAxisd(about_x, Vector3d::UnitX()) *
                   Eigen::AngleAxisd(about_y, Vector3d::UnitY()))
                      .toRotationMatrix();
  pose.translation() = middle - pose.linear() * Vector3d(3 * kBoard.square, 1.5 * kBoard.square, 0);
  return pose;
}

// The picture of a stereo camera: both eyes side by side, grey.
std::vector<std::uint8_t> seen_by_both(const Rigid3& left_from_board) {
  const DistortedCamera eye{{kWidth, kHeight, kFocal, kFocal, 159.5, 119.5}, {}};
  Rigid3 right_from_left = Rigid3::Identity();
  right_from_left.translation() = Vector3d(-kBaseline, 0, 0);
  const ColorImage left = test::board_picture(eye, left_from_board, kBoard, 4);
  const ColorImage right = test::board_picture(eye, right_from_left * left_from_board, kBoard, 4);
  std::vector<std::uint8_t> bytes;
  for (int v = 0; v < kHeight; ++v) {
    for (const ColorImage* image : {&left, &right})
      for (int u = 0; u < kWidth; ++u) bytes.push_back((*image)(u, v).g);
  }
  return bytes;
}

test::FakeVideo camera_that_sees(const std::vector<std::vector<std::uint8_t>>& pictures) {
  test::FakeVideo video;
  test::FakeDevice& camera = video.cameras.emplace_back();
  camera.path = "/dev/video0";
  camera.card = "Two Eyes";
  camera.modes = {{four_letters("GREY"), 2 * kWidth, kHeight, {30}}};
  for (const auto& bytes : pictures)
    camera.shots.push_back(
        {video.time + 0.5 + static_cast<double>(camera.shots.size()) / 30, bytes});
  return video;
}

BoardOrder order_in(const test::ScratchFolder& folder, int views) {
  BoardOrder order;
  order.source.device = "/dev/video0";
  order.source.folders = {folder.path() / "kept"};
  order.pattern = kBoard;
  order.views = views;
  return order;
}

void quietly(const BoardSearchStep& /*step*/) {}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("a board shown to a live camera becomes the calibration that cameras and live find",
          "[sources][camera][calibrate]") {
  const test::ScratchFolder folder("calibration_run");
  const std::array boards{
      board_at(0.4, 0, {0.03, 0, 0.40}),      board_at(-0.4, 0.1, {0.05, 0.02, 0.42}),
      board_at(0, 0.5, {0, -0.02, 0.40}),     board_at(0.1, -0.5, {0.06, 0.01, 0.42}),
      board_at(0.3, 0.3, {0.03, 0.04, 0.45}), board_at(-0.3, -0.3, {0.02, -0.03, 0.38})};
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const Rigid3& board : boards) pictures.push_back(seen_by_both(board));
  // One board stays for a second picture and is then absent for one; two boards more than
  // required follow.
  const std::vector<std::uint8_t> nothing(pictures[0].size(), 90);
  pictures.insert(pictures.begin() + 1, {pictures[0], nothing});
  pictures.push_back(pictures[0]);
  pictures.push_back(nothing);
  test::FakeVideo video = camera_that_sees(pictures);

  std::vector<int> done;
  const CalibratedSource made =
      calibrate_source(order_in(folder, 6), {}, video, [&](const BoardSearchStep& step) {
        CHECK(step.is_live);
        CHECK(step.total == 6);
        if (step.searched) done.push_back(step.done);
      });
  CHECK(made.seen.views.size() == 6);
  CHECK(made.seen.pairs == 8);
  CHECK(made.seen.alike == 1);
  CHECK(done == std::vector<int>{1, 1, 1, 2, 3, 4, 5, 6});
  CHECK(video.cameras[0].shots.size() == 2);  // the search ended before these
  CHECK(video.opened == 0);

  const std::filesystem::path kept = folder.path() / "kept/two-eyes-320x240.yml";
  CHECK(made.file == kept);
  const StereoRig rig = value_or_throw(read_source_calibration(kept, kWidth, kHeight)).format.rig;
  const double percent = tolerance(0.02, "corners of a sixteenth of a pixel, six boards");
  CHECK(rig.left.pinhole.fx_px == Approx(kFocal).epsilon(percent));
  CHECK(rig.right.pinhole.fy_px == Approx(kFocal).epsilon(percent));
  CHECK(-rig.right_from_left.translation().x() == Approx(kBaseline).epsilon(percent));
  // The file is found again, and its error on the remaining pictures is small.
  CHECK(known_calibration("Two Eyes", kWidth, kHeight, {folder.path() / "kept"}) == kept);
  video = camera_that_sees({pictures[0], pictures[3]});
  const CheckedCalibration checked = check_calibration(order_in(folder, 2), kept, video, quietly);
  CHECK(checked.seen.views.size() == 2);
  CHECK(checked.row_error_px < tolerance(0.1, "corners of a sixteenth of a pixel"));
}

TEST_CASE("what is wrong with a live calibration is said before or after boards are shown",
          "[sources][camera][calibrate][refusal]") {
  const test::ScratchFolder folder("calibration_run");
  const std::vector<std::uint8_t> board = seen_by_both(board_at(0.4, 0, {0.03, 0, 0.40}));
  test::FakeVideo video = camera_that_sees({board});
  const BoardOrder order = order_in(folder, 1);
  try {
    (void)calibrate_source(order, {}, video, quietly);
    FAIL("one board is no calibration");
  } catch (const Error& error) {
    CHECK(contains(error.what(), "/dev/video0: no calibration: "));
    CHECK(contains(error.what(), "at least 6"));
  }
  CHECK(std::filesystem::is_empty(folder.path() / "kept"));

  // A file that cannot be written is reported before a picture is read: the camera still has it.
  video = camera_that_sees({board});
  CHECK_THROWS_WITH(
      calibrate_source(order, folder.path() / "no such folder/calibration.yml", video, quietly),
      Catch::Contains("cannot be written"));
  CHECK(video.cameras[0].shots.size() == 1);
  // The same when the calibration to check cannot be read.
  CHECK_THROWS_WITH(check_calibration(order, folder.path() / "none.yml", video, quietly),
                    Catch::Contains("none.yml"));
  CHECK(video.cameras[0].shots.size() == 1);
  CHECK(video.opened == 0);
}

}  // namespace
}  // namespace palpable
