#include "palpable/live/calibrate/calibration_file.h"

#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::repeated;
using test::replaced;
using test::ScratchFolder;
using test::write_bytes;

StereoCalibration some_calibration() {
  StereoCalibration calibration;
  calibration.rig.left = {{1280, 720, 700.21, 700.19, 650.413, 360.661},
                          {-0.174219, 0.0277628, -3.10761e-05, -3.35258e-05, 0}};
  calibration.rig.right = {{1280, 720, 699.838, 699.8, 654.776, 350.501},
                           {-0.176395, 0.0290527, 1.50278e-05, 0.00018937, 1e-4}};
  const Eigen::Vector3d turn(0.00300136, 0.000189208, -0.000855091);
  calibration.rig.right_from_left.linear() =
      Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  calibration.rig.right_from_left.translation() << -0.0630226, 3.02386e-06, -3.60835e-05;
  calibration.frames_per_second = 29.97;
  return calibration;
}

std::string text_of_some_calibration(const ScratchFolder& folder) {
  write_stereo_calibration(folder / "good.yml", some_calibration());
  return test::file_bytes(folder / "good.yml");
}

TEST_CASE("a calibration comes back with every bit", "[calibrate][calibration]") {
  const ScratchFolder folder("calibration_round_trip");
  const StereoCalibration written = some_calibration();
  write_stereo_calibration(folder / "calibration.yml", written);
  const StereoCalibration read =
      value_or_throw(read_stereo_calibration(folder / "calibration.yml"));
  CHECK(read.rig.left == written.rig.left);
  CHECK(read.rig.right == written.rig.right);
  CHECK(read.rig.right_from_left.matrix() == written.rig.right_from_left.matrix());
  CHECK(read.frames_per_second == written.frames_per_second);

  const RectifiedCalibration rectified{
      {{741, 500, 994.978, 994.978, 311.193, 254.877}, 0.193001, -31.086}, 12.5};
  write_rectified_calibration(folder / "rectified.yml", rectified);
  const RectifiedCalibration back =
      value_or_throw(read_rectified_calibration(folder / "rectified.yml"));
  CHECK(back.stereo.camera == rectified.stereo.camera);
  CHECK(back.stereo.baseline == rectified.stereo.baseline);
  CHECK(back.stereo.disparity_at_infinity_px == -31.086);
  CHECK(back.frames_per_second == 12.5);
}

TEST_CASE("OpenCV reads what we write, and we read what OpenCV writes",
          "[calibrate][calibration]") {
  const ScratchFolder folder("calibration_opencv");
  write_stereo_calibration(folder / "ours.yml", some_calibration());
  const cv::FileStorage ours((folder / "ours.yml").string(), cv::FileStorage::READ);
  REQUIRE(ours.isOpened());
  cv::Mat K1;
  cv::Mat T;
  ours["K1"] >> K1;
  ours["T"] >> T;
  REQUIRE(K1.size() == cv::Size(3, 3));
  CHECK(K1.at<double>(0, 2) == 650.413);
  REQUIRE(T.total() == 3);
  CHECK(T.at<double>(0) == -0.0630226);

  {
    cv::FileStorage theirs((folder / "theirs.yml").string(), cv::FileStorage::WRITE);
    const StereoRig rig = some_calibration().rig;
    const auto K = [](const PinholeCamera& c) {
      return cv::Mat(cv::Matx33d(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1));
    };
    theirs << "image_width" << 1280 << "image_height" << 720 << "K1" << K(rig.left.pinhole) << "D1"
           << cv::Mat(cv::Vec4d(-0.17, 0.02, 0, 0)) << "K2" << K(rig.right.pinhole) << "D2"
           << cv::Mat(cv::Matx<double, 1, 5>(-0.17, 0.02, 0, 0, 0)) << "R"
           << cv::Mat(cv::Mat::eye(3, 3, CV_64F)) << "T" << cv::Mat(cv::Vec3d(-0.063, 0, 0));
  }
  const StereoCalibration read = value_or_throw(read_stereo_calibration(folder / "theirs.yml"));
  CHECK(read.rig.left.pinhole == some_calibration().rig.left.pinhole);
  CHECK(read.rig.left.distortion == std::array<double, 5>{-0.17, 0.02, 0, 0, 0});
  CHECK(read.rig.right_from_left.translation() == Eigen::Vector3d(-0.063, 0, 0));
  CHECK(read.frames_per_second == 30);
}

TEST_CASE("a rotation that is rounded in the file is made a rotation again",
          "[calibrate][calibration]") {
  const ScratchFolder folder("calibration_rounded");
  StereoCalibration calibration = some_calibration();
  calibration.rig.right_from_left.linear() =
      (calibration.rig.right_from_left.linear() * 1e4).array().round() / 1e4;
  write_stereo_calibration(folder / "rounded.yml", calibration);
  const Eigen::Matrix3d R =
      value_or_throw(read_stereo_calibration(folder / "rounded.yml")).rig.right_from_left.linear();
  CHECK((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <=
        test::tolerance(1e-14, "a product of orthogonal factors"));
  CHECK((R - calibration.rig.right_from_left.linear()).cwiseAbs().maxCoeff() <=
        test::tolerance(1e-4, "the rounding in the file"));
}

TEST_CASE("a calibration that cannot be right is refused with its reason",
          "[calibrate][calibration][refusal]") {
  const ScratchFolder folder("calibration_refusals");
  const std::string good = text_of_some_calibration(folder);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "not OpenCV YAML"},
      {"hello", "not OpenCV YAML"},
      {"<?xml version=\"1.0\"?><opencv_storage></opencv_storage>", "not OpenCV YAML"},
      {"%YAML:1.0\n---\n", "no number 'image_width'"},
      {replaced(good, "image_width: 1280", "image_width: wide"), "no number 'image_width'"},
      {replaced(good, "image_width: 1280", "image_width: 0"), "image_width = 0"},
      {replaced(good, "image_width: 1280", "image_width: 12.5"), "image_width = 12.5"},
      {replaced(good, "fps: 29.97", "fps: -1"), "fps = -1"},
      {replaced(good, "700.21", "-700.21"), "focal lengths of -700.21"},
      {replaced(good, "700.21", ".nan"), "not finite"},
      {replaced(good, "700.21, 0.0", "700.21, 5.0"), "K1 that is not"},
      {replaced(good, "650.413", "99999.0"), "principal point"},
      {replaced(good, "-0.174219", ".inf"), "distortion"},
      {replaced(good, "-0.0630226", "-63.0226"), "looks like millimetres"},
      {replaced(good, "-0.0630226", "0.0630226"), "swap"},
      {replaced(good, "-0.0630226, 3.02386e-06", "3.02386e-06, -0.0630226"), "side by side"},
      {replaced(good, "T: !!opencv-matrix\n   rows: 3", "T: !!opencv-matrix\n   rows: 2"), ""},
      {replaced(good, "R: !!opencv-matrix\n   rows: 3", "R: !!opencv-matrix\n   rows: 99999"),
       "'R', which is no matrix of 1 to 100 rows"},
      {replaced(good, "R: !!opencv-matrix", "Q: !!opencv-matrix"), "no matrix 'R'"},
      {replaced(good, "K2: !!opencv-matrix", "K2: 7\nL2: !!opencv-matrix"), "'K2', which is no"},
  };
  for (const auto& [text, reason] : cases) {
    write_bytes(folder / "bad.yml", text);
    const auto result = read_stereo_calibration(folder / "bad.yml");
    INFO(text);
    REQUIRE_FALSE(result.ok());
    INFO(result.problem().message);
    CHECK(result.problem().message.find("bad.yml") != std::string::npos);
    CHECK(result.problem().message.find(reason) != std::string::npos);
    CHECK(result.problem().message.find('\n') == std::string::npos);
  }
  const auto missing = read_stereo_calibration(folder / "nowhere.yml");
  REQUIRE_FALSE(missing.ok());
  CHECK(missing.problem().message.find("nowhere.yml") != std::string::npos);
  CHECK_FALSE(read_stereo_calibration(folder.path()).ok());
}

TEST_CASE("a calibration that OpenCV's reader would not survive is refused with file and line",
          "[calibrate][calibration][refusal]") {
  const ScratchFolder folder("calibration_deep");
  const std::string good = text_of_some_calibration(folder);
  const auto refused = [&](const std::string& text) {
    write_bytes(folder / "deep.yml", text);
    const std::string message = read_stereo_calibration(folder / "deep.yml").problem().message;
    CHECK_THAT(message, Catch::Contains("deep.yml: "));
    return message;
  };
  const std::string line = fmt::format("line {}: nested more than 64 deep",
                                       1 + std::count(good.begin(), good.end(), '\n'));
  CHECK_THAT(refused(good + "fps: " + repeated("[", 60'000)), Catch::Contains(line));
  CHECK_THAT(refused(good + repeated("a: ", 60'000) + "1\n"), Catch::Contains(line));
  CHECK_THAT(refused(good + repeated("- ", 60'000) + "1\n"), Catch::Contains(line));
  CHECK_THAT(refused(good + std::string(2'500'000, '\n')),
             Catch::Contains("2.5 MB, where 1 are read at most"));
}

TEST_CASE("lens models beyond k3 are refused unless they are zero",
          "[calibrate][calibration][refusal]") {
  const ScratchFolder folder("calibration_lens");
  const std::string good = text_of_some_calibration(folder);
  const std::string before = "D2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ ";
  const auto with_D2 = [&](const std::string& count, const std::string& numbers) {
    const auto start = good.find("D2:");
    const auto end = good.find("R: !!");
    write_bytes(folder / "lens.yml",
                good.substr(0, start) + "D2: !!opencv-matrix\n   rows: 1\n   cols: " + count +
                    "\n   dt: d\n   data: [ " + numbers + " ]\n" + good.substr(end));
    return read_stereo_calibration(folder / "lens.yml");
  };
  CHECK(good.find(before) != std::string::npos);
  CHECK(with_D2("4", "0.1, 0.2, 0., 0.").ok());
  CHECK(with_D2("8", "0.1, 0.2, 0., 0., 0.3, 0., 0., 0.").ok());
  const auto rational = with_D2("8", "0.1, 0.2, 0., 0., 0.3, 0., 0.5, 0.");
  REQUIRE_FALSE(rational.ok());
  CHECK(rational.problem().message.find("CALIB_RATIONAL_MODEL") != std::string::npos);
  CHECK_FALSE(with_D2("3", "0.1, 0.2, 0.").ok());
}

TEST_CASE("what is not a rotation, or not two equal eyes, is called so",
          "[calibrate][calibration]") {
  const auto said = [](const std::function<void(StereoRig&)>& change) {
    StereoRig rig = some_calibration().rig;
    change(rig);
    return what_is_wrong_with(rig);
  };
  CHECK(said([](StereoRig&) {}).empty());
  CHECK(said([](StereoRig& r) { r.right_from_left.linear() *= 1.01; }).find("rotation") !=
        std::string::npos);
  CHECK(said([](StereoRig& r) { r.right_from_left.linear().col(0) *= -1; }).find("rotation") !=
        std::string::npos);
  CHECK(said([](StereoRig& r) {
          r.right_from_left.linear()(1, 2) = std::numeric_limits<double>::quiet_NaN();
        }).find("finite") != std::string::npos);
  CHECK(said([](StereoRig& r) { r.right.pinhole.width += 2; }).find("equal") != std::string::npos);
  CHECK(said([](StereoRig& r) {
          r.right_from_left.translation().setZero();
        }).find("in one place") != std::string::npos);
  StereoCalibration unsound = some_calibration();
  unsound.rig.left.pinhole.fx_px = 0;
  CHECK_THROWS_AS(write_stereo_calibration("never_written.yml", unsound), ContractViolation);
  CHECK_THROWS_AS(write_stereo_calibration("/no/such/folder/c.yml", some_calibration()), Error);
}

TEST_CASE("a calibration file that is cut off anywhere never gives an unsound rig",
          "[calibrate][calibration][fuzz]") {
  const ScratchFolder folder("calibration_cut");
  const std::string good = text_of_some_calibration(folder);
  for (std::size_t length = 0; length + 3 < good.size(); length += 7) {
    INFO("cut to " << length << " of " << good.size() << " bytes");
    write_bytes(folder / "cut.yml", good.substr(0, length));
    CHECK_FALSE(read_stereo_calibration(folder / "cut.yml").ok());
    CHECK_FALSE(read_rectified_calibration(folder / "cut.yml").ok());
  }
}

TEST_CASE("a calibration file with bytes changed at random never gives an unsound rig",
          "[calibrate][calibration][fuzz]") {
  const ScratchFolder folder("calibration_noise");
  const std::string good = text_of_some_calibration(folder);
  int refused = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::string text = good;
    for (unsigned change = 0; change <= seed % 8; ++change) {
      const std::size_t at = std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random);
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 40);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 60));
          break;
      }
    }
    write_bytes(folder / "noise.yml", text);
    const auto result = read_stereo_calibration(folder / "noise.yml");
    if (result.ok()) {
      CHECK(what_is_wrong_with(result.value().rig).empty());
    } else {
      ++refused;
      CHECK(result.problem().message.find("noise.yml") != std::string::npos);
    }
  }
  CHECK(refused > 100);  // otherwise the changes had no effect on the reader
}

}  // namespace
}  // namespace palpable
