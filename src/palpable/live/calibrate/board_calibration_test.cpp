#include "palpable/live/calibrate/board_calibration.h"

#include "tests/support/board_picture.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <cmath>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::tolerance;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
const BoardPattern kBoard{7, 5, 0.03};

StereoRig true_rig() {
  StereoRig rig;
  rig.left = {{kWidth, kHeight, 530, 532, 325, 236}, {-0.17, 0.03, 0.0004, -0.0003, 0}};
  rig.right = {{kWidth, kHeight, 526, 528, 315, 244}, {-0.16, 0.02, -0.0002, 0.0005, 0}};
  rig.right_from_left.linear() =
      Eigen::AngleAxisd(0.02, Vector3d(0.3, 0.8, 0.5).normalized()).toRotationMatrix();
  rig.right_from_left.translation() = Vector3d(-0.07, 0.001, 0.002);
  return rig;
}

// The pose of a board that is tilted about an axis in the image by up to `tilt` (rad), 0.4 to 0.7 m
// away, with its middle in the central part of the picture.
Rigid3 board_pose(std::mt19937_64& random, double tilt) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double direction = 3.1416 * unit(random);
  Rigid3 pose = Rigid3::Identity();
  pose.linear() =
      Eigen::AngleAxisd(tilt * unit(random), Vector3d(std::cos(direction), std::sin(direction), 0))
          .toRotationMatrix();
  const double Z = 0.55 + 0.15 * unit(random);
  const Vector3d middle(0.09, 0.06, 0);  // of the board
  pose.translation() =
      Vector3d(0.035 + 0.2 * Z * unit(random), 0.15 * Z * unit(random), Z) - pose.linear() * middle;
  return pose;
}

std::vector<BoardView> views_of(const StereoRig& rig, int count, double tilt, double noise_px,
                                unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> unit(0, 1);
  const auto noise = [&](std::mt19937_64& r) { return noise_px * unit(r); };
  std::vector<BoardView> views;
  for (int n = 0; n < count; ++n) {
    const Rigid3 left_from_board = board_pose(random, tilt);
    BoardView& seen = views.emplace_back();
    seen.number = n;
    for (int row = 0; row < kBoard.rows; ++row) {
      for (int column = 0; column < kBoard.columns; ++column) {
        const Vector3d x =
            left_from_board * Vector3d(column * kBoard.square, row * kBoard.square, 0);
        seen.left.push_back(rig.left.project(x) + Vector2d(noise(random), noise(random)));
        seen.right.push_back(rig.right.project(rig.right_from_left * x) +
                             Vector2d(noise(random), noise(random)));
      }
    }
  }
  return views;
}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

std::string refusal(const std::vector<BoardView>& views, const BoardPattern& pattern = kBoard) {
  const auto result = calibrate_boards(views, pattern, kWidth, kHeight);
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message.find('\n') == std::string::npos);
  return result.problem().message;
}

TEST_CASE("boards without noise give back the rig that saw them", "[calibrate][Sec3.3]") {
  const StereoRig rig = true_rig();
  const auto found =
      value_or_throw(calibrate_boards(views_of(rig, 12, 0.6, 0, 1), kBoard, kWidth, kHeight));
  const StereoRig& got = found.calibration.rig;
  const double exact = tolerance(1e-3, "corners pass through OpenCV's 32-bit points: 3e-5 px");
  CHECK(got.left.pinhole.fx_px == Approx(530).epsilon(exact));
  CHECK(got.right.pinhole.fy_px == Approx(528).epsilon(exact));
  CHECK(got.right.pinhole.cx_px == Approx(315).epsilon(exact));
  CHECK(got.left.distortion[0] == Approx(-0.17).margin(0.01));
  CHECK((got.right_from_left.translation() - rig.right_from_left.translation()).norm() <= 1e-4);
  CHECK((got.right_from_left.linear() - rig.right_from_left.linear()).norm() <= exact);
  CHECK(found.row_error_px <= 0.01);
  CHECK(found.reprojections_px.size() == 12);
  CHECK(found.covered > 0.2);
}

TEST_CASE("corners with a tenth of a pixel of noise give the rig to what the noise allows",
          "[calibrate][Sec3.3]") {
  const StereoRig rig = true_rig();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    INFO("seed " << seed);
    const auto found = value_or_throw(
        calibrate_boards(views_of(rig, 14, 0.6, 0.1, seed), kBoard, kWidth, kHeight));
    const StereoRig& got = found.calibration.rig;
    CHECK(std::abs(got.left.pinhole.fx_px - 530) <=
          tolerance(4 * found.focal_sigma * 530, "four standard deviations, as it says itself"));
    CHECK((found.focal_sigma > 0.001 && found.focal_sigma < 0.01));
    CHECK(std::abs(got.right_from_left.translation().norm() - 0.07) <=
          tolerance(0.0007, "one percent"));
    // The distance between two coordinates with a noise of 0.1 px each.
    CHECK(found.reprojection_px == Approx(0.141).epsilon(0.15));
    CHECK(found.row_error_px == Approx(0.141).epsilon(0.15));
    // The row error of the true rig is the noise, too.
    CHECK(value_or_throw(row_error_px(views_of(rig, 14, 0.6, 0.1, seed), rig)) ==
          Approx(0.141).epsilon(0.15));
  }
}

TEST_CASE("a bad calibration is refused with its reason", "[calibrate][refusal]") {
  const StereoRig rig = true_rig();
  const auto good = views_of(rig, 10, 0.6, 0.05, 5);
  CHECK(contains(refusal({good.begin(), good.begin() + 2}),
                 "7 x 5 inner corners in 2 pairs; at least 6"));
  CHECK(contains(refusal({}), "in 0 pairs"));

  auto swapped = good;
  for (BoardView& seen : swapped) std::swap(seen.left, seen.right);
  CHECK(contains(refusal(swapped), "the eyes are swapped"));

  auto moved = good;  // in one pair the images were not taken at the same instant
  for (Vector2d& corner : moved[3].right) corner += Vector2d(14, -17);
  const std::string off = refusal(moved);
  CHECK(contains(off, "px (rms)"));
  CHECK(contains(off, "pair 3"));
  CHECK(contains(off, "inner corners"));  // the most frequent mistake

  BoardPattern metres = kBoard;
  metres.square = 30;
  CHECK(contains(refusal(good, metres), "squares as large as was said"));

  BoardLimits strict;
  strict.largest_row_error_px = 0.01;
  const auto rows = calibrate_boards(good, kBoard, kWidth, kHeight, strict);
  REQUIRE_FALSE(rows.ok());
  CHECK(contains(rows.problem().message, "rows are"));
}

TEST_CASE("weak boards are refused with the uncertainty that follows, or accepted with it",
          "[calibrate][refusal]") {
  const StereoRig rig = true_rig();
  BoardLimits accepting;
  accepting.accept_weak = true;
  accepting.largest_row_error_px = 1;  // that of the noisy boards is 0.83
  const auto good = views_of(rig, 10, 0.6, 0.05, 5);
  const auto few = std::vector<BoardView>(good.begin(), good.begin() + 4);
  const auto flat = views_of(rig, 10, 0.09, 0.05, 5);
  const auto noisy = views_of(rig, 6, 0.3, 0.6, 5);
  struct Case {
    const std::vector<BoardView>& views;
    const char* why;
  };
  for (const auto& [views, why] :
       {Case{few, "in 4 pairs; 6 are wanted: so"}, Case{flat, "tilted by at most"},
        Case{noisy, "so the focal length, and with it every depth, is known to"}}) {
    INFO(why);
    const std::string refused = refusal(views);
    CHECK(contains(refused, why));
    CHECK(contains(refused, "--accept"));
    const auto taken = value_or_throw(calibrate_boards(views, kBoard, kWidth, kHeight, accepting));
    // The stated uncertainty agrees with the actual error.
    CHECK(std::abs(taken.calibration.rig.left.pinhole.fx_px / 530 - 1) <=
          tolerance(4 * taken.focal_sigma, "four standard deviations, as it says itself"));
    CHECK(contains(taken.weakness, why));
    CHECK_FALSE(contains(taken.weakness, "--accept"));
    const double percent = 100 * taken.focal_sigma;
    CHECK(contains(taken.weakness, fmt::format("to {:.{}f} % (one standard deviation)", percent,
                                               percent < 1 ? 2 : 1)));
  }
  CHECK(value_or_throw(calibrate_boards(good, kBoard, kWidth, kHeight, accepting)).weakness == "");
  // Boards without any information are still refused.
  const auto two = std::vector<BoardView>(good.begin(), good.begin() + 2);
  CHECK_FALSE(calibrate_boards(two, kBoard, kWidth, kHeight, accepting).ok());
  auto swapped = few;
  for (BoardView& seen : swapped) std::swap(seen.left, seen.right);
  const auto still = calibrate_boards(swapped, kBoard, kWidth, kHeight, accepting);
  REQUIRE_FALSE(still.ok());
  CHECK(contains(still.problem().message, "the eyes are swapped"));
}

TEST_CASE("a board's corners are found where they are, in the same order by both eyes",
          "[calibrate]") {
  const StereoRig rig = true_rig();
  auto random = test::random_case(4);
  const Rigid3 left_from_board = board_pose(random, 0.5);
  const ColorImage left = test::board_picture(rig.left, left_from_board, kBoard);
  const ColorImage right =
      test::board_picture(rig.right, rig.right_from_left * left_from_board, kBoard);
  auto found = find_board(left, right, kBoard);
  REQUIRE(found);
  const Vector3d first = left_from_board * Vector3d::Zero();
  // A board of 7 x 5 corners looks the same upside down: either corner may be the first, but it
  // must be the same one in both images.
  const bool upside_down = (found->left.front() - rig.left.project(first)).norm() > 5;
  double worst = 0;
  for (int k = 0; k < kBoard.columns * kBoard.rows; ++k) {
    const int at = upside_down ? kBoard.columns * kBoard.rows - 1 - k : k;
    const int row = at / kBoard.columns, column = at % kBoard.columns;
    const Vector3d x = left_from_board * Vector3d(column * kBoard.square, row * kBoard.square, 0);
    const auto i = static_cast<std::size_t>(k);
    worst = std::max({worst, (found->left[i] - rig.left.project(x)).norm(),
                      (found->right[i] - rig.right.project(rig.right_from_left * x)).norm()});
  }
  INFO("worst corner " << worst << " px");
  CHECK(worst <= tolerance(0.25, "an edge falls between 7 samples of a pixel: a step of 0.14"));

  CHECK_FALSE(find_board(left, ColorImage(kWidth, kHeight, Rgb{90, 90, 90}), kBoard));
  CHECK_FALSE(find_board(left, right, {9, 6, 0.03}));
  CHECK_FALSE(find_board(ColorImage(4, 4, Rgb{}), ColorImage(4, 4, Rgb{}), kBoard));
}

TEST_CASE("one picture says where its board stands, whichever way up it is held",
          "[calibrate][board]") {
  const DistortedCamera eye{{kWidth, kHeight, 530, 532, 325, 236}, {}};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    Rigid3 camera_from_board = board_pose(random, 0.6);  // its Z away from the camera
    const Vector3d middle(0.5 * (kBoard.columns - 1) * kBoard.square,
                          0.5 * (kBoard.rows - 1) * kBoard.square, 0);
    const Vector3d place = camera_from_board * middle;
    // Each case turns the board by another quarter turn.
    camera_from_board.linear() =
        camera_from_board.linear() *
        Eigen::AngleAxisd(1.5707963 * seed, Vector3d::UnitZ()).toRotationMatrix();
    camera_from_board.translation() = place - camera_from_board.linear() * middle;
    const auto found =
        find_board_pose(test::board_picture(eye, camera_from_board, kBoard), eye.pinhole, kBoard);
    REQUIRE(found);
    CHECK((found->translation() - place).norm() <=
          tolerance(0.001, "corners of 0.1 px on 100 px of board: 0.1 % of 0.7 m"));
    const Eigen::Matrix3d R = found->linear();
    CHECK((R.col(2) + camera_from_board.linear().col(2)).norm() <=
          tolerance(0.01, "corners of 0.1 px, 35 of them, on a board 100 px wide"));
    CHECK((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() <= 1e-9);
    CHECK(R.determinant() > 0);
    // X is along a side of the board, and within 45 degrees of the picture's X axis.
    CHECK(R(0, 0) > 0.7);
    const double along = std::max(std::abs(R.col(0).dot(camera_from_board.linear().col(0))),
                                  std::abs(R.col(0).dot(camera_from_board.linear().col(1))));
    CHECK(along > 0.999);
  }
  CHECK_FALSE(find_board_pose(ColorImage(kWidth, kHeight, Rgb{90, 90, 90}), eye.pinhole, kBoard));
  CHECK_FALSE(find_board_pose(ColorImage(4, 4, Rgb{}), eye.pinhole, kBoard));
}

}  // namespace
}  // namespace palpable
