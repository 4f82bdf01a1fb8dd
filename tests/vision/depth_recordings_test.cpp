// Recordings of other groups with published truth. A case is skipped with a message if its
// data is missing.
#include "palpable/common/base/order_statistics.h"
#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/factory_calibration.h"
#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/sources/folder_source.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

// Tests run in the source folder; the data is beside it.
const fs::path kData = "../shared/data";

double known_share(const DepthImage& depth) {
  const auto known =
      std::count_if(depth.begin(), depth.end(), [](float Z) { return !std::isnan(Z); });
  return static_cast<double>(known) / static_cast<double>(depth.size());
}

double median(std::vector<double> values) {
  REQUIRE_FALSE(values.empty());
  return upper_median(values);
}

// --- hands_squirrel: colour + depth, 320 x 240 -------------------------------------------------
// A desk with a ball at the left, a plush toy in the middle; behind it, right of x = 190 and above
// y = 110, a man sits and moves from frame 19 on. His hand is over the ball in frames 40 to 89.

const fs::path kSquirrel = kData / "hands_squirrel";

std::vector<SeenFrame> squirrel_frames() {
  auto source = value_or_throw(open_folder(kSquirrel));
  auto camera = value_or_throw(DepthCamera::make(source->format()));
  std::vector<SeenFrame> frames;
  Frame frame;
  while (source->next(frame) == FrameStatus::kFrame) camera.see(frame, frames.emplace_back());
  return frames;
}

TEST_CASE("the squirrel recording opens as 90 frames of colour and depth in metres",
          "[vision][real]") {
  if (!fs::exists(kSquirrel)) PALPABLE_SKIP("no folder " + kSquirrel.string());
  const auto source = value_or_throw(open_folder(kSquirrel));
  CHECK(source->frame_count() == 90);
  CHECK(source->format().kind == FrameFormat::Kind::kColorDepth);
  CHECK(source->format().depth_camera == PinholeCamera{320, 240, 275, 275, 160, 120});
  const auto frames = squirrel_frames();
  REQUIRE(frames.size() == 90);
  for (const SeenFrame& seen : frames) {
    CHECK(known_share(seen.depth) > 0.7);
    // The desk in front of the ball, and the ball's top (data README: a desk at 0.45 to 1.0 m).
    CHECK((seen.depth(110, 180) > 0.45F && seen.depth(110, 180) < 0.7F));
  }
  // A desk is a plane: along a line of the image 1 / Z is linear.
  const DepthImage& Z = frames[0].depth;
  const double bend = 2 / Z(110, 190) - 1 / Z(90, 190) - 1 / Z(130, 190);
  CHECK(std::abs(bend) * Z(110, 190) <= test::tolerance(0.03, "1 % of noise in each of the three"));
}

TEST_CASE("the time-of-flight camera's resting desk scatters no more than the model says",
          "[vision][real]") {
  if (!fs::exists(kSquirrel)) PALPABLE_SKIP("no folder " + kSquirrel.string());
  const auto frames = squirrel_frames();
  const DepthNoise model = time_of_flight_noise();
  std::vector<double> ratios;
  for (int y = 120; y < 200; y += 2) {
    for (int x = 30; x < 130; x += 2) {
      double sum = 0;
      double squares = 0;
      int count = 0;
      for (std::size_t i = 0; i < 15; ++i) {
        const double Z = frames[i].depth(x, y);
        if (std::isnan(Z)) continue;
        sum += Z;
        squares += Z * Z;
        ++count;
      }
      if (count < 15) continue;
      const double mean = sum / count;
      const double sigma = std::sqrt(std::max(0.0, squares / count - mean * mean));
      ratios.push_back(sigma / model.sigma(mean));
    }
  }
  REQUIRE(ratios.size() > 1000);
  std::sort(ratios.begin(), ratios.end());
  INFO("median " << ratios[ratios.size() / 2] << ", 90 % " << ratios[ratios.size() * 9 / 10]);
  CHECK(ratios[ratios.size() / 2] <= 1.0);
  CHECK(ratios[ratios.size() * 9 / 10] <= 1.5);
  CHECK(ratios[ratios.size() / 2] >= 0.25);  // a model that is far too wide would hide hands
}

// --- ZED Mini, serial 10027514: raw 1280 x 720 pairs --------------------------------------------

const fs::path kZed = kData / "zed";

StereoRig zed_rig() {
  return value_or_throw(read_factory_calibration(kZed / "SN10027514.conf", 1280, 720)).rig;
}

// The raw pairs as a folder, left_* beside right_*, with the camera's own file.
std::unique_ptr<FrameSource> zed_source() {
  return value_or_throw(open_folder(kZed / "raw", {.calibration = kZed / "SN10027514.conf"}));
}

// Row in the right image minus row in the left one, for corners whose best match by normalised
// correlation within +-20 rows and 0 to 60 columns is unambiguous.
std::vector<double> row_differences(const GrayImage& left, const GrayImage& right) {
  constexpr int kHalf = 7;
  constexpr int kRows = 20;
  constexpr int kDisparity = 60;
  const cv::Mat left_view = view(left);
  const cv::Mat right_view = view(right);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(left_view, corners, 400, 0.01, 10);
  std::vector<double> differences;
  for (const cv::Point2f& corner : corners) {
    const int x = static_cast<int>(corner.x);
    const int y = static_cast<int>(corner.y);
    const cv::Rect where(x - kHalf - kDisparity, y - kHalf - kRows, 2 * kHalf + 1 + kDisparity,
                         2 * kHalf + 1 + 2 * kRows);
    if ((where & cv::Rect(0, 0, right_view.cols, right_view.rows)) != where ||
        x + kHalf >= left_view.cols) {
      continue;
    }
    cv::Mat score;
    cv::matchTemplate(right_view(where),
                      left_view(cv::Rect(x - kHalf, y - kHalf, 2 * kHalf + 1, 2 * kHalf + 1)),
                      score, cv::TM_CCOEFF_NORMED);
    double best = 0;
    cv::Point at;
    cv::minMaxLoc(score, nullptr, &best, nullptr, &at);
    if (best < 0.9 || at.y == 0 || at.y == score.rows - 1) continue;
    const double before = score.at<float>(at.y - 1, at.x);
    const double after = score.at<float>(at.y + 1, at.x);
    const double curve = before - 2 * best + after;
    const double part = curve < 0 ? 0.5 * (before - after) / curve : 0;
    differences.push_back(at.y + part - kRows);
  }
  return differences;
}

GrayImage gray_of(const ColorImage& color) {
  GrayImage gray(color.width(), color.height());
  cv::Mat target = view(gray);
  cv::cvtColor(view(color), target, cv::COLOR_RGB2GRAY);
  return gray;
}

TEST_CASE("a real ZED Mini's rows agree after rectification with its factory numbers",
          "[vision][real][Sec3.3]") {
  if (!fs::exists(kZed / "raw")) PALPABLE_SKIP("no folder " + (kZed / "raw").string());
  const auto source = zed_source();
  CHECK(source->format().rig.left == zed_rig().left);
  Rectification rectification(source->format().rig);
  Frame frame;
  for (const char* distance : {"05m", "10m"}) {
    INFO(distance);
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    const ColorImage& left = frame.left;
    const ColorImage& right = frame.right;
    const auto raw = row_differences(gray_of(left), gray_of(right));
    GrayImage left_rows;
    GrayImage right_rows;
    rectification.rectify_luma(Rectification::Eye::kLeft, left, left_rows);
    rectification.rectify_luma(Rectification::Eye::kRight, right, right_rows);
    const auto rectified = row_differences(left_rows, right_rows);
    INFO(raw.size() << " and " << rectified.size() << " matches");
    REQUIRE(rectified.size() > 50);
    CHECK(std::abs(median(raw)) > 10);  // data README: 12 rows
    CHECK(std::abs(median(rectified)) <= test::tolerance(0.5,
                                                         "the bar that the factory's numbers "
                                                         "can reach; the vendor's own are at 0"));
  }
}

TEST_CASE("a ZED Mini whose right eye was knocked finds its rows again", "[vision][real][rows]") {
  if (!fs::exists(kZed / "raw")) PALPABLE_SKIP("no folder " + (kZed / "raw").string());
  const auto source = zed_source();
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  double as_delivered = 0;                          // px, row error with the factory's numbers
  for (const double knocked : {0.0, 0.1, -0.08}) {  // degrees; 0.1 are 1.2 rows
    FrameFormat format = source->format();
    const double angle = knocked * M_PI / 180;
    format.rig.right_from_left =
        Rigid3(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX())) * format.rig.right_from_left;
    auto camera = value_or_throw(DepthCamera::make(format));
    SeenFrame seen;
    double first = 0;
    for (int i = 0; i < 24; ++i) {
      camera.see(frame, seen);
      if (i == 0) first = seen.row_error_px;
    }
    INFO("knocked by " << knocked << " degrees: " << first << " px at first, " << seen.row_error_px
                       << " in the end, corrected by " << seen.row_correction_px);
    if (knocked == 0) as_delivered = first;
    CHECK(std::abs(std::abs(first - as_delivered) - std::abs(angle) * 700) <=
          test::tolerance(0.15, "px; other points are followed"));
    CHECK(std::abs(seen.row_error_px) <= test::tolerance(0.2, "px; the bar"));
  }
}

TEST_CASE("a real ZED Mini pair gives depth, from raw images", "[vision][real][Sec3.3]") {
  if (!fs::exists(kZed / "raw")) PALPABLE_SKIP("no folder " + (kZed / "raw").string());
  const auto source = zed_source();
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  auto camera = value_or_throw(DepthCamera::make(source->format()));
  SeenFrame seen;
  camera.see(frame, seen);
  INFO("known " << known_share(seen.depth));
  CHECK(known_share(seen.depth) > 0.5);  // a bare corridor
  // The board is 5 m away, here in the rectified picture at half size.
  std::vector<double> board;
  for (int y = 220; y < 237; ++y) {
    for (int x = 312; x < 330; ++x) {
      if (!std::isnan(seen.depth(x, y))) board.push_back(seen.depth(x, y));
    }
  }
  INFO("board at " << median(board) << " m from " << board.size() << " pixels");
  CHECK(board.size() > 200);
  CHECK(std::abs(median(board) - 5) <=
        test::tolerance(0.35, "a quarter of a pixel of 4.4 px at half resolution is 0.28 m"));
}

TEST_CASE("raw ZED pairs taken for rectified ones, and swapped eyes of KITTI's car, are called so",
          "[vision][real][refusal]") {
  const fs::path kitti = kData / "stereo_video_kitti1";
  if (!fs::exists(kZed / "raw") || !fs::exists(kitti)) {
    PALPABLE_SKIP("no folders " + kZed.string() + " and " + kitti.string());
  }
  const auto first_misfit = [](const FrameFormat& format, const Frame& frame) {
    auto camera = value_or_throw(DepthCamera::make(format));
    SeenFrame seen;
    camera.see(frame, seen);
    return seen.misfit;
  };
  Frame frame;
  const auto zed = zed_source();
  REQUIRE(zed->next(frame) == FrameStatus::kFrame);
  CHECK_FALSE(first_misfit(zed->format(), frame));
  FrameFormat taken_for_rectified = zed->format();
  taken_for_rectified.already_rectified = true;
  taken_for_rectified.rectified = {{1280, 720, 700, 700, 640, 360}, 0.063, 0};
  const auto rows = first_misfit(taken_for_rectified, frame);
  REQUIRE(rows);
  CHECK_FALSE(rows->swapped);
  CHECK(std::abs(std::abs(rows->rows_px) - 12) <=
        test::tolerance(2, "12 px is the median of these pairs; it differs over the picture"));

  const auto car = value_or_throw(open_folder(kitti));
  REQUIRE(car->next(frame) == FrameStatus::kFrame);
  CHECK_FALSE(first_misfit(car->format(), frame));
  std::swap(frame.left, frame.right);
  const auto eyes = first_misfit(car->format(), frame);
  REQUIRE(eyes);
  CHECK(eyes->swapped);
}

// --- pairs with true disparity ------------------------------------------------------------------

struct Truth {
  double known_share = 0;  // share of the pixels with a known truth
  double within_5 = 0;     // share of those with both
};

// `disparity` is the truth at full size, px of the left image, NaN where unknown.
Truth against_truth(const SeenFrame& seen, const RectifiedStereo& stereo,
                    const DepthImage& disparity) {
  int with_truth = 0;
  int both = 0;
  int good = 0;
  const int factor = stereo.camera.width / seen.depth.width();
  for (int y = 0; y < seen.depth.height(); ++y) {
    for (int x = 0; x < seen.depth.width(); ++x) {
      const double d = disparity(factor * x, factor * y);
      if (std::isnan(d)) continue;
      ++with_truth;
      const double Z = seen.depth(x, y);
      if (std::isnan(Z)) continue;
      ++both;
      if (std::abs(Z / stereo.depth(d) - 1) <= 0.05) ++good;
    }
  }
  return {static_cast<double>(both) / with_truth, static_cast<double>(good) / both};
}

DepthImage disparity_of(const cv::Mat& steps, double steps_per_px) {
  REQUIRE_FALSE(steps.empty());
  DepthImage disparity(steps.cols, steps.rows, std::nanf(""));
  for (int y = 0; y < steps.rows; ++y) {
    for (int x = 0; x < steps.cols; ++x) {
      const double step = steps.depth() == CV_16U
                              ? steps.at<std::uint16_t>(y, x)
                              : static_cast<double>(steps.at<std::uint8_t>(y, x));
      if (step > 0) disparity(x, y) = static_cast<float>(step / steps_per_px);
    }
  }
  return disparity;
}

SeenFrame first_seen(const fs::path& folder, const DepthSettings& settings = {}) {
  const auto source = value_or_throw(open_folder(folder));
  auto camera = value_or_throw(DepthCamera::make(source->format(), settings));
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  SeenFrame seen;
  camera.see(frame, seen);
  return seen;
}

TEST_CASE("the motorcycle pair of python3-skimage comes out at its true depth",
          "[vision][real][Sec3.3]") {
  const fs::path data = "/usr/lib/python3/dist-packages/skimage/data";
  if (!fs::exists(data / "motorcycle_left.png")) {
    PALPABLE_SKIP("no motorcycle pair in " + data.string());
  }
  const ScratchFolder folder("motorcycle");
  const std::string command = "tools/motorcycle_to_folder.py '" + folder.path().string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);
  const RectifiedStereo stereo =
      value_or_throw(read_rectified_calibration(folder / "rectified.yml")).stereo;
  CHECK(stereo.disparity_at_infinity_px == -31.086);
  const DepthImage disparity = disparity_of(
      cv::imread((folder / "truth/disparity.png").string(), cv::IMREAD_UNCHANGED), 256);
  for (const bool full : {false, true}) {
    const SeenFrame seen = first_seen(folder.path(), {.full_resolution = full});
    const Truth truth = against_truth(seen, stereo, disparity);
    INFO((full ? "full" : "half") << " resolution: known " << truth.known_share << ", within 5 % "
                                  << truth.within_5);
    CHECK(truth.known_share >= 0.75);
    CHECK(truth.within_5 >= 0.80);
  }
}

TEST_CASE("Middlebury pairs come out at their true disparity", "[vision][real][Sec3.3]") {
  if (!fs::exists(kData / "stereo_gt")) {
    PALPABLE_SKIP("no folder " + (kData / "stereo_gt").string());
  }
  struct Set {
    const char *folder, *left, *right, *truth;
    double steps_per_px;
  };
  for (const Set& set : {Set{"teddy", "imL.png", "imR.png", "groundtruth.png", 4},
                         Set{"Cloth3", "view1.png", "view5.png", "disp1.png", 2}}) {
    INFO(set.folder);
    const fs::path source = kData / "stereo_gt" / set.folder;
    const ScratchFolder folder(set.folder);
    fs::create_directories(folder / "left");
    fs::create_directories(folder / "right");
    fs::copy_file(source / set.left, folder / "left/0.png");
    fs::copy_file(source / set.right, folder / "right/0.png");
    const DepthImage disparity = disparity_of(
        cv::imread((source / set.truth).string(), cv::IMREAD_GRAYSCALE), set.steps_per_px);
    // Focal length and baseline are unknown for these pairs; any values will do, because 5 %
    // of Z is 5 % of d.
    const RectifiedStereo stereo{
        {disparity.width(), disparity.height(), 500, 500, 200, 150}, 0.1, 0};
    write_rectified_calibration(folder / "rectified.yml", {stereo, 30});
    const SeenFrame seen = first_seen(folder.path(), {.nearest = 0.5, .full_resolution = true});
    const Truth truth = against_truth(seen, stereo, disparity);
    INFO("known " << truth.known_share << ", within 5 % " << truth.within_5);
    CHECK(truth.known_share >= 0.75);
    CHECK(truth.within_5 >= 0.90);
  }
}

}  // namespace
}  // namespace palpable
