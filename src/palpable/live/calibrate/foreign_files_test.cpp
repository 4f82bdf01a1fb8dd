#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/exported_calibration.h"
#include "palpable/live/calibrate/kalibr_camchain.h"
#include "palpable/live/calibrate/opencv_stereo_files.h"
#include "palpable/live/calibrate/realsense_file.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/calibrate/ros_camera_info.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <string>
#include <vector>

namespace palpable {
namespace {

using test::replaced;
using test::tolerance;

KeyedText keys_of(const std::string& text) { return value_or_throw(KeyedText::parse(text)); }

template <class T>
std::string fault_in(const Result<T>& result) {
  return result.ok() ? std::string() : result.problem().message;
}

bool says(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

// Both eyes differ, and the pose has three different angles and lengths.
StereoRig uneven_rig() {
  StereoRig rig;
  rig.left = {{752, 480, 458.5, 457.25, 367.25, 248.5}, {-0.28, 0.07, 2e-4, 2e-5, 0}};
  rig.right = {{752, 480, 457.5, 456.25, 379.75, 255.25}, {-0.27, 0.06, -1e-4, -3e-5, 0.01}};
  rig.right_from_left.linear() =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  rig.right_from_left.translation() << -0.11, 0.002, -0.003;
  return rig;
}

void check_same(const StereoRig& rig, const StereoRig& truth, double text_digits) {
  CHECK(rig.left == truth.left);
  CHECK(rig.right == truth.right);
  CHECK((rig.right_from_left.matrix() - truth.right_from_left.matrix()).cwiseAbs().maxCoeff() <
        tolerance(text_digits, "digits of the text"));
}

cv::Mat cv_matrix(const Eigen::MatrixXd& m) {
  cv::Mat result(static_cast<int>(m.rows()), static_cast<int>(m.cols()), CV_64F);
  for (int i = 0; i < result.rows; ++i) {
    for (int j = 0; j < result.cols; ++j) result.at<double>(i, j) = m(i, j);
  }
  return result;
}

cv::Mat cv_camera(const DistortedCamera& eye) {
  const PinholeCamera& c = eye.pinhole;
  return (cv::Mat_<double>(3, 3) << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
}

cv::Mat cv_lens(const DistortedCamera& eye, int count = 5) {
  cv::Mat D = cv::Mat::zeros(1, count, CV_64F);
  for (int i = 0; i < 5; ++i) D.at<double>(0, i) = eye.distortion[static_cast<std::size_t>(i)];
  return D;
}

// What OpenCV's sample stereo_calib writes, by OpenCV's writer.
std::string sample_text(const StereoRig& rig, bool lenses, bool pose, int notation,
                        int lens_numbers = 5) {
  cv::FileStorage file("", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | notation);
  if (lenses) {
    file << "M1" << cv_camera(rig.left) << "D1" << cv_lens(rig.left, lens_numbers);
    file << "M2" << cv_camera(rig.right) << "D2" << cv_lens(rig.right, lens_numbers);
  }
  if (pose) {
    file << "R" << cv_matrix(rig.right_from_left.linear());
    file << "T" << cv_matrix(rig.right_from_left.translation());
  }
  return file.releaseAndGetString();
}

TEST_CASE("the files of OpenCV's sample give the rig, in each of OpenCV's notations",
          "[calibrate][foreign]") {
  const StereoRig truth = uneven_rig();
  for (const int notation :
       {cv::FileStorage::FORMAT_YAML, cv::FileStorage::FORMAT_XML, cv::FileStorage::FORMAT_JSON}) {
    for (const int lens_numbers : {5, 8, 14}) {
      const KeyedText lenses = keys_of(sample_text(truth, true, false, notation, lens_numbers));
      const KeyedText pose = keys_of(sample_text(truth, false, true, notation));
      CHECK(has_opencv_lenses(lenses));
      CHECK_FALSE(has_opencv_lenses(pose));
      CHECK(has_opencv_pose(pose));
      check_same(value_or_throw(rig_of_opencv(lenses, pose, 752, 480)), truth, 1e-14);
    }
  }
  const KeyedText both = keys_of(sample_text(truth, true, true, cv::FileStorage::FORMAT_YAML));
  check_same(value_or_throw(rig_of_opencv(both, both, 752, 480)), truth, 1e-14);
  CHECK_FALSE(states_opencv_size(both));
  CHECK(value_or_throw(rig_of_opencv(both, both, 0, 0)).left.pinhole.width == 0);
  const KeyedText sized = keys_of(sample_text(truth, true, true, cv::FileStorage::FORMAT_YAML) +
                                  "imageSize: [ 752, 480 ]\n");
  check_same(value_or_throw(rig_of_opencv(sized, sized, 0, 0)), truth, 1e-14);
}

TEST_CASE("OpenCV's files are refused for another size, a rational lens and what they lack",
          "[calibrate][foreign][refusal]") {
  const std::string text = sample_text(uneven_rig(), true, true, cv::FileStorage::FORMAT_YAML, 8);
  const auto fault = [](const std::string& broken, int width = 752, int height = 480) {
    const KeyedText keys = keys_of(broken);
    return fault_in(rig_of_opencv(keys, keys, width, height));
  };
  CHECK(fault(text).empty());
  CHECK(says(fault(text, 376, 240), "for pictures of about 734 x 497"));
  CHECK(says(fault(text, 1504, 960), "near the middle of these pictures of 1504 x 960"));
  // D1 = k1 k2 p1 p2 k3 k4 k5 k6: the last zero becomes a k6.
  std::string rational = text;
  rational.replace(rational.find("0. ]", rational.find("D1")), 4, "0.3 ]");
  CHECK(says(fault(rational), "rational"));
  CHECK(says(fault(replaced(text, "D2:", "D9:")), "no numbers D2"));
  CHECK(says(fault(replaced(text, "T:", "t:")), "no 3 numbers T"));
}

const std::string kCamchain =
    "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
    "  distortion_coeffs: [-0.28, 0.07, 0.0002, 2.0e-05]\n  distortion_model: radtan\n"
    "  intrinsics: [1073.676, 1073.833, 639.874, 350.286]\n  resolution: [1280, 800]\n"
    "  rostopic: /left/image_raw\n"
    "cam1:\n  T_cn_cnm1:\n  - [0.0, -1.0, 0.0, -0.11988]\n  - [1.0, 0.0, 0.0, 0.0005]\n"
    "  - [0.0, 0.0, 1.0, -0.0007]\n  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [0]\n"
    "  camera_model: pinhole\n  distortion_coeffs: [-0.27, 0.06, -0.0001, 3.0e-05]\n"
    "  distortion_model: radtan\n  intrinsics: [1070.474, 1070.825, 660.855, 357.059]\n"
    "  resolution: [1280, 800]\n  rostopic: /right/image_raw\n";

TEST_CASE("Kalibr's T_cn_cnm1 takes points of cam0 to cam1, the right eye",
          "[calibrate][foreign]") {
  const StereoRig rig = value_or_throw(rig_of_camchain(keys_of(kCamchain)));
  CHECK(rig.left == DistortedCamera{{1280, 800, 1073.676, 1073.833, 639.874, 350.286},
                                    {-0.28, 0.07, 0.0002, 2e-5, 0}});
  CHECK(rig.right.pinhole.cx_px == 660.855);
  CHECK(rig.right.distortion[2] == -0.0001);
  // By hand: x = -Y - 0.11988, y = X + 0.0005, z = Z - 0.0007.
  CHECK((rig.right_from_left * Eigen::Vector3d(1, 2, 3))
            .isApprox(Eigen::Vector3d(-2.11988, 1.0005, 2.9993), 1e-15));
  // Lists of PyYAML's other style.
  const std::string block = replaced(kCamchain, "  - [0.0, -1.0, 0.0, -0.11988]\n",
                                     "  - - 0.0\n    - -1.0\n    - 0.0\n    - -0.11988\n");
  CHECK(value_or_throw(rig_of_camchain(keys_of(block))).right_from_left.matrix() ==
        rig.right_from_left.matrix());
}

TEST_CASE("a camchain without T_cn_cnm1 is read by the poses of the IMU", "[calibrate][foreign]") {
  const auto rows = [](const Rigid3& pose) {
    std::string text;
    for (int i = 0; i < 4; ++i) {
      const auto row = pose.matrix().row(i);
      text += fmt::format("  - [{}, {}, {}, {}]\n", row(0), row(1), row(2), row(3));
    }
    return text;
  };
  const StereoRig truth = uneven_rig();
  Rigid3 cam0_from_imu = Rigid3::Identity();
  cam0_from_imu.linear() =
      Eigen::AngleAxisd(1.5, Eigen::Vector3d(1, 1, 2).normalized()).toRotationMatrix();
  cam0_from_imu.translation() << 0.1, -0.05, 0.02;
  const Rigid3 cam1_from_imu = truth.right_from_left * cam0_from_imu;
  const auto chain = [&](const std::string& key, const Rigid3& first, const Rigid3& second) {
    const std::size_t cam1 = kCamchain.find("cam1:\n"), from = kCamchain.find("  T_cn_cnm1");
    const std::size_t to = kCamchain.find("  cam_overlaps: [0]");
    return kCamchain.substr(0, cam1) + "  " + key + ":\n" + rows(first) + "cam1:\n  " + key +
           ":\n" + rows(second) + kCamchain.substr(to) + (from == to ? "x" : "");
  };
  for (const std::string& text :
       {chain("T_cam_imu", cam0_from_imu, cam1_from_imu),
        chain("T_imu_cam", cam0_from_imu.inverse(), cam1_from_imu.inverse())}) {
    const Rigid3 pose = value_or_throw(rig_of_camchain(keys_of(text))).right_from_left;
    CHECK((pose.matrix() - truth.right_from_left.matrix()).cwiseAbs().maxCoeff() <
          tolerance(1e-14, "rounding of two products"));
  }
}

TEST_CASE("other models of Kalibr are refused by their names", "[calibrate][foreign][refusal]") {
  const auto fault = [](const std::string& from, const std::string& to) {
    return fault_in(rig_of_camchain(keys_of(replaced(kCamchain, from, to))));
  };
  for (const char* model : {"omni", "ds", "eucm"}) {
    CHECK(says(fault("camera_model: pinhole", std::string("camera_model: ") + model),
               std::string("camera model ") + model));
  }
  for (const char* lens : {"equidistant", "fov"}) {
    CHECK(says(fault("radtan", lens), std::string("lens of the model ") + lens));
  }
  CHECK(says(fault("cam1:", "cam2:"), "cam0 alone, one eye"));
  CHECK(says(fault("T_cn_cnm1", "T_other"), "no 4 x 4 numbers cam1.T_cn_cnm1"));
  CHECK(says(fault("[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 2.0]"), "the last one 0 0 0 1"));
  CHECK(says(fault("[1280, 800]", "[1280]"), "cam0.resolution"));
}

// R1 R2 P1 P2 by OpenCV, as camera_calibration computes them.
std::pair<std::string, std::string> ros_texts(const StereoRig& rig) {
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(cv_camera(rig.left), cv_lens(rig.left), cv_camera(rig.right),
                    cv_lens(rig.right), cv::Size(rig.left.pinhole.width, rig.left.pinhole.height),
                    cv_matrix(rig.right_from_left.linear()),
                    cv_matrix(rig.right_from_left.translation()), R1, R2, P1, P2, Q,
                    cv::CALIB_ZERO_DISPARITY, 0);
  const auto list = [](const cv::Mat& m) {
    std::string text;
    for (int i = 0; i < static_cast<int>(m.total()); ++i) {
      text += fmt::format("{}{:.17g}", i == 0 ? "" : ", ", m.ptr<double>()[i]);
    }
    return "[" + text + "]";
  };
  const auto text = [&](const char* name, const DistortedCamera& eye, const cv::Mat& R,
                        const cv::Mat& P) {
    return fmt::format(
        "image_width: {}\nimage_height: {}\ncamera_name: {}\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
        "  data: {}\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n"
        "  data: {}\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: {}\nprojection_matrix:\n"
        "  rows: 3\n  cols: 4\n  data: {}\n",
        eye.pinhole.width, eye.pinhole.height, name, list(cv_camera(eye)), list(cv_lens(eye)),
        list(R), list(P));
  };
  return {text("left", rig.left, R1, P1), text("right", rig.right, R2, P2)};
}

Result<StereoRig> rig_of_texts(const std::string& left, const std::string& right) {
  const auto a = read_ros_camera(keys_of(left));
  if (!a.ok()) return a.problem();
  const auto b = read_ros_camera(keys_of(right));
  if (!b.ok()) return b.problem();
  return rig_of_ros(a.value(), b.value());
}

TEST_CASE("ROS's two files give the pose from which OpenCV computed their R and P",
          "[calibrate][foreign]") {
  const StereoRig truth = uneven_rig();
  const auto [left, right] = ros_texts(truth);
  for (const char* head : {"", "%YAML:1.0\n---\n"}) {
    check_same(value_or_throw(rig_of_texts(head + left, head + right)), truth, 1e-12);
  }
  CHECK_FALSE(rectified_of_ros(value_or_throw(read_ros_camera(keys_of(left))),
                               value_or_throw(read_ros_camera(keys_of(right)))));
}

const std::string kMessage =
    "header:\n  seq: 4\n  stamp:\n    secs: 0\n  frame_id: \"left\"\nheight: 480\nwidth: 640\n"
    "distortion_model: \"plumb_bob\"\nD: [0.0, 0.0, 0.0, 0.0, 0.0]\n"
    "K: [381.36, 0.0, 320.5, 0.0, 381.36, 240.5, 0.0, 0.0, 1.0]\n"
    "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
    "P: [381.36, 0.0, 320.5, 0.0, 0.0, 381.36, 240.5, 0.0, 0.0, 0.0, 1.0, 0.0]\nbinning_x: 0\n";

TEST_CASE("messages of rectified pictures are a rectified pair", "[calibrate][foreign]") {
  const std::string right =
      replaced(kMessage, "P: [381.36, 0.0, 320.5, 0.0,", "P: [381.36, 0.0, 320.5, -19.068,");
  for (const bool ros2 : {false, true}) {
    std::string texts[2] = {kMessage, right};
    for (std::string& text : texts) {
      if (ros2) {
        for (const char* key : {"D: ", "K: ", "R: ", "P: "}) {
          const char small[] = {static_cast<char>(key[0] - 'A' + 'a'), ':', ' ', 0};
          text = replaced(text, std::string("\n") + key, std::string("\n") + small);
        }
      }
      CHECK(is_ros_camera(keys_of(text)));
    }
    const auto stereo = rectified_of_ros(value_or_throw(read_ros_camera(keys_of(texts[0]))),
                                         value_or_throw(read_ros_camera(keys_of(texts[1]))));
    REQUIRE(stereo);
    CHECK(stereo->camera == PinholeCamera{640, 480, 381.36, 381.36, 320.5, 240.5});
    CHECK(stereo->baseline == Approx(0.05).epsilon(1e-14));  // 19.068 / 381.36
    CHECK(stereo->disparity_at_infinity_px == 0);
  }
}

TEST_CASE("ROS's files say what is wrong with them", "[calibrate][foreign][refusal]") {
  const auto [left, right] = ros_texts(uneven_rig());
  const auto fault = [&, l = left, r = right](const std::string& from, const std::string& to) {
    return fault_in(rig_of_texts(replaced(l, from, to), replaced(r, from, to)));
  };
  for (const char* model : {"equidistant", "fisheye", "kannala_brandt4"}) {
    CHECK(says(fault("plumb_bob", model), std::string("lens of the model ") + model));
  }
  CHECK(says(fault("projection_matrix", "other"), "no projection_matrix"));
  CHECK(says(fault("image_width", "size"), "no image_width"));
  CHECK(says(fault("camera_matrix", "matrix"), "no numbers in its camera_matrix"));
  CHECK(says(fault_in(rig_of_texts(replaced(left, "[458.5, 0,", "[0, 0,"), right)),
             "focal lengths of 0"));
  CHECK(says(fault_in(rig_of_texts(left, left)), "no distance of the eyes"));
  // As in introlab/rtabmap_ros issue 1142 (OAK): P is the product with R.
  const std::string skew = replaced(kMessage, "P: [381.36, 0.0,", "P: [381.36, 52.4,");
  CHECK(says(fault_in(read_ros_camera(keys_of(skew))), "projection_matrix that is not fx 0 cx Tx"));
  // Both eyes with the P of the right one (issue 404 there).
  const std::string shifted =
      replaced(kMessage, "P: [381.36, 0.0, 320.5, 0.0", "P: [381.36, 0.0, 320.5, -157.294");
  CHECK(says(what_is_wrong_with(value_or_throw(rig_of_texts(shifted, shifted))), "in one place"));
  // rational_polynomial maps exactly where k4 k5 k6 are 0.
  const auto rational = [&, l = left](const char* k4) {
    std::string text = replaced(l, "plumb_bob", "rational_polynomial");
    const std::size_t at = text.find(']', text.find("distortion_coefficients"));
    text.insert(at, std::string(", ") + k4 + ", 0, 0");
    return read_ros_camera(keys_of(text));
  };
  CHECK(value_or_throw(rational("0")).lens == uneven_rig().left);
  CHECK(says(fault_in(rational("0.1")), "rational_polynomial"));
  // Eyes that are exchanged are called so by the judgement of every rig.
  CHECK(says(what_is_wrong_with(value_or_throw(rig_of_texts(right, left))), "swapped"));
}

const std::string kRealsense =
    R"({"baseline": "-49.9496", "intrinsic_left.x.x": "0.501421",
 "rectified.0.fx": "970.688", "rectified.0.fy": "970.688", "rectified.0.height": "1080",
 "rectified.0.ppx": "955.654", "rectified.0.ppy": "545.571", "rectified.0.width": "1920",
 "rectified.1.fx": "647.125", "rectified.1.fy": "647.25", "rectified.1.height": "720",
 "rectified.1.ppx": "637.103", "rectified.1.ppy": "363.714", "rectified.1.width": "1280",
 "rectified.2.fx": "582.4", "rectified.2.height": "0", "rectified.2.width": "0"})";

TEST_CASE("a RealSense's JSON gives the pair and the depth camera of each size",
          "[calibrate][foreign]") {
  const KeyedText json = keys_of(kRealsense);
  REQUIRE(is_realsense_json(json));
  const RectifiedStereo stereo = value_or_throw(stereo_of_realsense(json, 1920, 1080));
  CHECK(stereo.camera == PinholeCamera{1920, 1080, 970.688, 970.688, 955.654, 545.571});
  CHECK(stereo.baseline == Approx(0.0499496).epsilon(1e-14));
  const PinholeCamera small{1280, 720, 647.125, 647.25, 637.103, 363.714};
  CHECK(value_or_throw(stereo_of_realsense(json, 0, 0)).camera == small);
  CHECK(value_or_throw(depth_of_realsense(json, 1280, 720)) == DistortedCamera{small, {}});
  CHECK(says(fault_in(stereo_of_realsense(json, 640, 480)),
             "1920 x 1080, 1280 x 720 px, not of 640"));
}

const std::string kListing =
    "Device info:\n    Name : \tIntel RealSense D435\n\n"
    " Intrinsic of \"Depth\" / 640x480 / {Z16}\n  Width:      \t640\n  Height:     \t480\n"
    "  PPX:        \t323.402587890625\n  PPY:        \t238.035278320313\n  Fx:         \t383.046\n"
    "  Fy:         \t383.046\n  Distortion: \tBrown Conrady\n  Coeffs:     \t0  \t0  \t0  \t0  \t0 "
    " \n"
    "  FOV (deg):  \t79.75 x 64.14\n\n"
    " Intrinsic of \"Color\" / 640x480 / {YUYV/RGB8}\n  Width: \t640\n  Height: \t480\n"
    "  PPX: \t327\n  PPY: \t240\n  Fx: \t606\n  Fy: \t606\n  Distortion: \tInverse Brown Conrady\n"
    "  Coeffs: \t0  0  0  0  0\n"
    " Intrinsic of \"Infrared 1\" / 640x480 / {Y16}\n  Width: 640\n  Height: 480\n  PPX: 1\n"
    "  PPY: 1\n  Fx: 1\n  Fy: 1\n  Distortion: Brown Conrady\n  Coeffs: 0 0 0 0 0\n"
    " Intrinsic of \"Infrared 1\" / 640x480 / {Y8}\n  Width: \t640\n  Height: \t480\n"
    "  PPX: \t323.402587890625\n  PPY: \t238.035278320313\n  Fx: \t383.046\n  Fy: \t383.046\n"
    "  Distortion: \tBrown Conrady\n  Coeffs: \t0  0  0  0  0\n"
    " Intrinsic of \"Infrared 2\" / 640x480 / {Y8}\n  Width: \t640\n  Height: \t480\n"
    "  PPX: \t323.402587890625\n  PPY: \t238.035278320313\n  Fx: \t383.046\n  Fy: \t383.046\n"
    "  Distortion: \tBrown Conrady\n  Coeffs: \t0  0  0  0  0\n\n"
    "Extrinsic from \"Depth\"\t  To\t  \"Color\" :\n Rotation Matrix:\n   0.9999  0.001  0.002\n"
    "   -0.001 0.9999 0\n -0.002 0 0.9999\n\n Translation Vector: 0.0147  0.0001  0.0003\n\n"
    "Extrinsic from \"Infrared 1\"\t  To\t  \"Infrared 2\" :\n Rotation Matrix:\n"
    "   1                0                0               \n   0                1                "
    "0\n"
    "   0                0                1\n\n Translation Vector: -0.0499585  0  0\n";

TEST_CASE("what rs-enumerate-devices prints gives the pair and the depth camera",
          "[calibrate][foreign]") {
  REQUIRE(is_realsense_listing(kListing));
  const PinholeCamera camera{640, 480, 383.046, 383.046, 323.402587890625, 238.035278320313};
  for (const int width : {0, 640}) {
    const RectifiedStereo stereo =
        value_or_throw(stereo_of_realsense(kListing, width, width * 3 / 4));
    CHECK(stereo.camera == camera);
    CHECK(stereo.baseline == 0.0499585);
    CHECK(value_or_throw(depth_of_realsense(kListing, width, width * 3 / 4)).pinhole == camera);
  }
  CHECK(
      says(fault_in(depth_of_realsense(kListing, 848, 480)), "\"Depth\" of 640 x 480 px, not of"));
  // A lens is refused by its model unless its numbers are 0, as in a RealSense's JSON.
  const std::string inverse = replaced(kListing, "Brown Conrady", "Inverse Brown Conrady");
  CHECK(value_or_throw(depth_of_realsense(inverse, 640, 480)).pinhole == camera);
  CHECK(says(fault_in(depth_of_realsense(replaced(inverse, "\t0  \t0", "\t0.1  \t0"), 640, 480)),
             "Inverse Brown Conrady"));
  CHECK(says(fault_in(stereo_of_realsense(replaced(kListing, "To\t  \"Infrared 2\"", "To \"Gyro\""),
                                          640, 480)),
             "no Extrinsic"));
  CHECK(says(fault_in(stereo_of_realsense(replaced(kListing, "-0.0499585  0", "-0.0499585  0.001"),
                                          640, 480)),
             "not rectified"));
}

TEST_CASE("one camera as JSON is read: pyrealsense2's, Open3D's, and the depth's of several",
          "[calibrate][foreign]") {
  const auto camera = [](const std::string& text) { return camera_of_json(keys_of(text)); };
  const PinholeCamera truth{640, 480, 380.5, 381.5, 320.5, 240.25};
  CHECK(value_or_throw(camera(R"({"width": 640, "height": 480, "ppx": 320.5, "ppy": 240.25,
    "fx": 380.5, "fy": 381.5, "model": "distortion.brown_conrady", "coeffs": [0, 0, 0, 0, 0]})"))
            .pinhole == truth);
  // Column by column.
  CHECK(value_or_throw(camera(R"({"height": 480, "width": 640,
    "intrinsic_matrix": [380.5, 0, 0, 0, 381.5, 0, 320.5, 240.25, 1]})"))
            .pinhole == truth);
  const std::string two = R"({"color": {"fx": 600, "fy": 600, "cx": 1, "cy": 1, "width": 640,
    "height": 480}, "KEY": {"fx": 380.5, "fy": 381.5, "cx": 320.5, "cy": 240.25, "width": 640,
    "height": 480}})";
  CHECK(value_or_throw(camera(replaced(two, "KEY", "Depth"))).pinhole == truth);
  CHECK(says(fault_in(camera(replaced(two, "KEY", "infra"))), "several cameras"));
  CHECK(says(fault_in(camera(R"({"fx": 380.5, "fy": 381.5})")), "ppx"));
  CHECK(says(fault_in(camera(R"({"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 64, "height": 48,
    "model": "kannala_brandt4", "coeffs": [0.1, 0, 0, 0, 0]})")),
             "kannala_brandt4"));
}

TEST_CASE("OpenCV and ROS read an exported calibration, and so is it read back",
          "[calibrate][foreign]") {
  const test::ScratchFolder folder("exported");
  const StereoRig truth = uneven_rig();
  export_calibration(folder.path(), truth);
  const cv::FileStorage lenses((folder / "intrinsics.yml").string(), cv::FileStorage::READ);
  const cv::FileStorage pose((folder / "extrinsics.yml").string(), cv::FileStorage::READ);
  const auto matrix = [](const cv::FileStorage& file, const char* name) {
    cv::Mat m;
    file[name] >> m;
    return m;
  };
  CHECK(cv::norm(matrix(lenses, "M1"), cv_camera(truth.left), cv::NORM_INF) == 0);
  CHECK(cv::norm(matrix(lenses, "D2"), cv_lens(truth.right), cv::NORM_INF) == 0);
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(matrix(lenses, "M1"), matrix(lenses, "D1"), matrix(lenses, "M2"),
                    matrix(lenses, "D2"), cv::Size(752, 480), matrix(pose, "R"), matrix(pose, "T"),
                    R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0);
  const double rounding = tolerance(1e-9, "rounding of 1e3 px");
  for (const auto& [name, m] :
       {std::pair{"R1", R1}, {"R2", R2}, {"P1", P1}, {"P2", P2}, {"Q", Q}}) {
    INFO(name);
    CHECK(cv::norm(matrix(pose, name), m, cv::NORM_INF) < rounding);
  }
  const auto text = [&](const char* name) { return test::file_bytes(folder / name); };
  const KeyedText written[] = {keys_of(text("intrinsics.yml")), keys_of(text("extrinsics.yml"))};
  check_same(value_or_throw(rig_of_opencv(written[0], written[1], 0, 0)), truth, 1e-15);
  check_same(value_or_throw(rig_of_texts(text("left.yaml"), text("right.yaml"))), truth, 1e-12);
  CHECK(says(text("right.yaml"), "camera_name: right\n"));
}

}  // namespace
}  // namespace palpable
