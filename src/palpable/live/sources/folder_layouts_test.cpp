#include "palpable/live/sources/folder_layouts.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/folder_source.h"
#include "palpable/live/sources/open_source.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>
#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::ScratchFolder;
using test::write_bytes;

constexpr int kWidth = 40;
constexpr int kHeight = 24;

void write_image(const fs::path& path, int level, int width = kWidth, int height = kHeight) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), cv::Mat(height, width, CV_8UC1, cv::Scalar(level)));
}

void write_depth(const fs::path& path, int steps, int width = kWidth, int height = kHeight) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), cv::Mat(height, width, CV_16UC1, cv::Scalar(steps)));
}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

std::string refusal(const fs::path& folder) {
  const auto result = open_folder(folder);
  REQUIRE_FALSE(result.ok());
  CHECK(contains(result.problem().message, folder.string()));
  CHECK(result.problem().message.find('\n') == std::string::npos);
  return result.problem().message;
}

std::string euroc_sensor(double y) {
  return "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [0.0, -1.0, 0.0, 0.1,\n"
         "         1.0, 0.0, 0.0, " +
         std::to_string(y) +
         ",\n         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
         "rate_hz: 20\nresolution: [40, 24]\ncamera_model: pinhole\n"
         "intrinsics: [30.5, 30.25, 20.0, 12.0] #fu, fv, cu, cv\n"
         "distortion_model: radial-tangential\n"
         "distortion_coefficients: [-0.28, 0.07, 0.0002, 1.8e-05]\n";
}

TEST_CASE("partners of different numbers are no pair, though there are as many on each side",
          "[sources][folder]") {
  const ScratchFolder folder("mispaired");
  const auto name = [](int n) { return std::to_string(1000000 + n).substr(1) + ".png"; };
  for (int n = 0; n < 6; ++n) {
    if (n != 2) write_image(folder / "left" / name(n), n);
    if (n != 4) write_image(folder / "right" / name(n), n);
  }
  CHECK(contains(refusal(folder.path()), "000002.png has no partner"));
  write_image(folder / "left" / name(2), 2);
  write_image(folder / "right" / name(4), 4);
  CHECK(recognise_folder(folder.path()).ok());
}

TEST_CASE("each side may count for itself", "[sources][folder]") {
  const ScratchFolder folder("own_counters");
  for (int n = 0; n < 4; ++n) {
    write_image(folder / "left" / (std::to_string(100 + n) + ".png"), n);
    write_image(folder / "right" / (std::to_string(700 + n) + ".png"), n);
  }
  CHECK(recognise_folder(folder.path()).ok());
}

TEST_CASE("a lens of EuRoC that is not radial-tangential is refused by its name",
          "[sources][folder]") {
  const ScratchFolder folder("fisheye");
  const fs::path mav = folder / "mav0";
  for (const char* eye : {"cam0", "cam1"}) {
    write_image(mav / eye / "data/1403636579763555584.png", 10);
    std::string sensor = euroc_sensor(0.02);
    const std::string model = "radial-tangential";
    sensor.replace(sensor.find(model), model.size(), "equidistant");
    write_bytes(mav / eye / "sensor.yaml", sensor);
  }
  CHECK(contains(refusal(folder.path()), "equidistant"));
}

TEST_CASE("a folder of EuRoC: pairs of one stamp, the rig from its files, poses from its truth",
          "[sources][folder][threads]") {
  const ScratchFolder folder("euroc");
  const fs::path mav = folder / "MH_01/mav0";
  for (const char* ns : {"1403636579763555584", "1403636579813555456", "1403636579863555584"}) {
    write_image(mav / "cam0/data" / (std::string(ns) + ".png"), 10);
    write_image(mav / "cam1/data" / (std::string(ns) + ".png"), 20);
  }
  fs::remove(mav / "cam1/data/1403636579813555456.png");
  // The body's x axis points up in the picture: the right eye is 0.11 m along the left camera's X.
  write_bytes(mav / "cam0/sensor.yaml", euroc_sensor(0.02));
  write_bytes(mav / "cam1/sensor.yaml", euroc_sensor(0.13));
  write_bytes(mav / "state_groundtruth_estimate0/data.csv",
              "#timestamp, p_RS_R_x [m]\n1403636579758555392,1,2,3,1,0,0,0,0,0,0\n"
              "1403636579863555500,4,5,6,0.70710678,0,0,0.70710678,0,0,0\n");
  const Recording recording = value_or_throw(recognise_folder(folder / "MH_01"));
  CHECK(recording.layout == "EuRoC");
  CHECK(recording.unmatched == 1);
  REQUIRE(recording.frames.size() == 2);
  CHECK(*recording.frames[1].time == Approx(0.1).epsilon(1e-6));
  REQUIRE(recording.frames[0].world_from_camera);
  CHECK(recording.frames[0].world_from_camera->translation().isApprox(Vector3d(1.1, 2.02, 3)));
  // Rotation by 90 degrees about Z: the camera at (0.1, 0.02, 0) of the body is at (-0.02, 0.1, 0).
  REQUIRE(recording.frames[1].world_from_camera);
  CHECK(
      recording.frames[1].world_from_camera->translation().isApprox(Vector3d(3.98, 5.1, 6), 1e-6));

  const auto source = value_or_throw(open_folder(folder / "MH_01"));
  CHECK(source->format().starts_at == Approx(1403636579.763555584).margin(1e-6));
  const StereoRig& rig = source->format().rig;
  CHECK(rig.left.pinhole == PinholeCamera{kWidth, kHeight, 30.5, 30.25, 20, 12});
  CHECK(rig.left.distortion[3] == 1.8e-05);
  CHECK(rig.right_from_left.translation().isApprox(Vector3d(-0.11, 0, 0)));
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.time == Approx(0.1).epsilon(1e-6));
  CHECK(frame.right(0, 0).r == 20);

  // An invalid rate and a stamp beyond 64 bits are ignored.
  std::string odd = euroc_sensor(0.02);
  odd.replace(odd.find("rate_hz: 20"), 11, "rate_hz:");
  write_bytes(mav / "cam0/sensor.yaml", odd);
  for (const char* eye : {"cam0", "cam1"}) {
    write_image(mav / eye / "data/99999999999999999999.png", 10);
  }
  const Recording again = value_or_throw(recognise_folder(folder / "MH_01"));
  CHECK(again.unmatched == 2);
  CHECK(again.frames.size() == 2);
  odd.replace(odd.find("[40, 24]"), 8, "[1e300, 24]");
  write_bytes(mav / "cam0/sensor.yaml", odd);
  CHECK(contains(refusal(folder / "MH_01"), "cam0/sensor.yaml has an image of 1e+300 x 24 px"));
  write_bytes(mav / "cam0/sensor.yaml", euroc_sensor(0.02));

  write_bytes(mav / "cam1/sensor.yaml", "resolution: [40, 24]\n");
  CHECK(contains(refusal(folder / "MH_01"), "cam1/sensor.yaml is no EuRoC camera"));
}

TEST_CASE("a folder of KITTI: aligned rows, the baseline from its projections",
          "[sources][folder][threads]") {
  const ScratchFolder folder("kitti");
  for (const char* eye : {"image_2", "image_3"}) {
    for (int i = 0; i < 3; ++i) {
      write_image(folder / eye / ("00000" + std::to_string(i) + ".png"), 10 * i);
    }
  }
  write_bytes(folder / "calib.txt",
              "P0: 30 0 20 0 0 30 12 0 0 0 1 0\nP1: 30 0 20 -16.2 0 30 12 0 0 0 1 0\n"
              "P2: 30 0 20 1.8 0 30 12 0 0 0 1 0\nP3: 30 0 20.5 -14.1 0 30 12 0 0 0 1 0\n"
              "Tr: 0 0 0 0 0 0 0 0 0 0 0 0\n");
  write_bytes(folder / "times.txt", "0.5\n0.6e0\n0.75\n");
  write_bytes(folder / "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 7 0 1 0 0 0 0 1 2\n");
  const auto source = value_or_throw(open_folder(folder.path()));
  const FrameFormat& format = source->format();
  CHECK(format.already_rectified);
  CHECK(format.rectified.camera == PinholeCamera{kWidth, kHeight, 30, 30, 20, 12});
  CHECK(format.rectified.baseline == Approx(0.53));
  // d = x_L - x_R = f T / Z + cx_L - cx_R
  CHECK(format.rectified.disparity_at_infinity_px == Approx(-0.5));
  Frame frame;
  for (const double time : {0.0, 0.1, 0.25}) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.time == Approx(time).margin(1e-12));
  }
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  // Camera 2 is 1.8 / 30 m to the left of camera 0, to which the poses belong.
  CHECK(recording.frames[1].world_from_camera->translation().isApprox(Vector3d(6.94, 0, 2)));
  CHECK_FALSE(recording.frames[2].world_from_camera);

  write_bytes(folder / "calib.txt", "P0: 1 2 3\n");
  CHECK(contains(refusal(folder.path()), "has no lines `P2: ` and `P3: ` of 12 numbers"));
}

TEST_CASE("KITTI's projections are taken by their names, and eyes that contradict are refused",
          "[sources][folder]") {
  const ScratchFolder folder("kitti_names");
  for (const char* eye : {"image_0", "image_1"}) write_image(folder / eye / "000000.png", 10);
  const std::string p0 = "P0: 30 0 20 0 0 30 12 0 0 0 1 0\n";
  const std::string p1 = "P1: 30 0 20 -1.89 0 30 12 0 0 0 1 0\n";
  const std::string others =
      "P2: 30 0 20 1.8 0 30 12 0 0 0 1 0\nP3: 30 0 20 -14.4 0 30 12 0 0 0 1 0\n";
  const auto baseline = [&](const std::string& text) {
    write_bytes(folder / "calib.txt", text);
    return value_or_throw(open_folder(folder.path()))->format().rectified.baseline;
  };
  for (const std::string& text : {p0 + p1 + others, others + p0 + p1, p1 + p0, p0 + p0 + p1,
                                  p0.substr(4) + p1.substr(4) + others.substr(0, 3)}) {
    INFO(text);
    CHECK(baseline(text) == Approx(0.063));
  }
  for (const auto& [right, says] :
       {std::pair{"P1: 36 0 20 -1.89 0 36 12 0 0 0 1 0\n", "f of the two eyes"},
        std::pair{"P1: 30 0 20 -1.89 0 36 12 0 0 0 1 0\n", "fy of the two eyes"},
        std::pair{"P1: 30 0 20 -1.89 0 30 32 0 0 0 1 0\n", "cy of the two eyes"},
        std::pair{"P1: 30 0 20 -1.89 0 30 12 0.9 0 0 1 0\n", "heights of the two eyes"},
        std::pair{"P1: 30 0 20 -1.89 0 30 12 0 0 0 1 0\nP1: 30 0 20 -3 0 30 12 0 0 0 1 0\n",
                  "P1 twice"}}) {
    write_bytes(folder / "calib.txt", p0 + right);
    CHECK(contains(refusal(folder.path()), says));
  }
}

TEST_CASE("a folder of TUM: colour and depth of one moment, depth in fifths of a millimetre",
          "[sources][folder][threads]") {
  const ScratchFolder folder("tum");
  const fs::path set = folder / "rgbd_dataset_freiburg2_desk";
  write_image(set / "rgb/a.png", 50, 640, 480);
  write_image(set / "rgb/b.png", 51, 640, 480);
  write_image(set / "rgb/c.png", 52, 640, 480);
  write_depth(set / "depth/a.png", 2500, 640, 480);
  write_depth(set / "depth/b.png", 5000, 640, 480);
  write_bytes(set / "rgb.txt",
              "# color images\n1311868164.36 rgb/a.png\n1311868164.40 rgb/b.png\n"
              "1311868164.43 rgb/c.png\n");
  write_bytes(set / "depth.txt", "1311868164.37 depth/a.png\n1311868164.445 depth/b.png\n");
  write_bytes(set / "groundtruth.txt",
              "# timestamp tx ty tz qx qy qz qw\n1311868164.43 1 2 3 0 0 1 0\n");
  const Recording recording = value_or_throw(recognise_folder(set));
  CHECK(recording.layout == "TUM");
  CHECK(recording.unmatched == 1);  // b.png: the nearest depth image is 30 ms away
  REQUIRE(recording.frames.size() == 2);
  CHECK_FALSE(recording.frames[0].world_from_camera);
  REQUIRE(recording.frames[1].world_from_camera);
  CHECK(recording.frames[1].world_from_camera->linear().isApprox(
      Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix()));

  const auto source = value_or_throw(open_folder(set));
  const std::vector<std::string> notes = source->take_notes();
  REQUIRE(notes.size() == 3);
  CHECK(contains(notes[0], "no intrinsics.txt: those of freiburg2 are assumed from its name"));
  CHECK_THAT(notes[1], Catch::Matchers::EndsWith("one step of its depth is 0.2 mm, as known of "
                                                 "recordings of TUM; --depth-unit overrides it"));
  CHECK(notes[2] ==
        "1 images have no partner of the same moment, or no stamp of their own, and are left out");
  CHECK(source->format().depth_unit == 1 / 5000.0);
  CHECK_FALSE(source->format().depth_unit_assumed);
  CHECK(source->take_notes().empty());
  CHECK(source->format().depth_camera.fx_px == 520.9);
  CHECK(source->format().depth_camera.width == 640);
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 4) == Approx(0.5));
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.left(0, 0).r == 52);
  CHECK(frame.depth(3, 4) == Approx(1.0));
  CHECK(frame.time == Approx(0.07));
  CHECK(source->format().starts_at == Approx(1311868164.36).margin(1e-6));

  // intrinsics.txt overrides the published numbers; without a unit in it, TUM's unit remains.
  write_bytes(set / "intrinsics.txt", "31 31 320 240");
  const auto own = value_or_throw(open_folder(set));
  CHECK(own->format().depth_camera.fx_px == 31);
  for (const std::string& note : own->take_notes()) CHECK_FALSE(contains(note, "assumed"));
  REQUIRE(own->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 4) == Approx(0.5));

  fs::rename(set, folder / "desk");
  fs::remove(folder / "desk/intrinsics.txt");
  CHECK(contains(refusal(folder / "desk"), "no intrinsics.txt"));
  write_bytes(folder / "desk/depth.txt", "7 depth/a.png\n");
  CHECK(contains(refusal(folder / "desk"), "no two of its images belong together"));
}

// A set of one frame in TUM's layout, with pictures of this width.
void write_tum(const fs::path& set, int width = 640, int height = 480) {
  write_image(set / "rgb/a.png", 50, width, height);
  write_depth(set / "depth/a.png", 2500, width, height);
  write_bytes(set / "rgb.txt", "7.00 rgb/a.png\n");
  write_bytes(set / "depth.txt", "7.01 depth/a.png\n");
}

TEST_CASE("TUM's published numbers are assumed by the innermost name, for pictures of their size",
          "[sources][folder]") {
  const ScratchFolder folder("tum_names");
  const fs::path set = folder / "freiburg3/rgbd_dataset_freiburg1_xyz";
  write_tum(set);
  CHECK(value_or_throw(open_folder(set))->format().depth_camera.fx_px == 517.3);
  write_tum(folder / "freiburg1/freiburg3_walk");
  CHECK(value_or_throw(open_folder(folder / "freiburg1/freiburg3_walk"))
            ->format()
            .depth_camera.fx_px == 535.4);
  // What a file or the user states comes first.
  write_bytes(set / "camera-intrinsics.txt", "543 0 316\n0 544 238\n0 0 1\n");
  CHECK(value_or_throw(open_folder(set))->format().depth_camera.fx_px == 543);
  write_bytes(folder / "own.txt", "510 511 321 241");
  CHECK(value_or_throw(open_folder(set, {.calibration = folder / "own.txt"}))
            ->format()
            .depth_camera.fy_px == 511);
  // Numbers for 640 x 480 do not hold for another size.
  write_tum(folder / "freiburg2_small", 320, 240);
  CHECK(
      contains(refusal(folder / "freiburg2_small"), "a.png is 320 x 240: write its `fx fy cx cy`"));
}

TEST_CASE("lists of TUM and KITTI whose times are no seconds are refused with their unit",
          "[sources][folder][refusal]") {
  const ScratchFolder folder("times");
  write_tum(folder / "tum");
  for (const auto& [stamp, unit] : {std::pair{"1305031102175304000", "nanoseconds"},
                                    std::pair{"1305031102175304", "microseconds"},
                                    std::pair{"1305031102175", "milliseconds"}}) {
    INFO(stamp);
    write_bytes(folder / "tum/rgb.txt", std::string(stamp) + " rgb/a.png\n");
    write_bytes(folder / "tum/depth.txt", std::string(stamp) + " depth/a.png\n");
    CHECK(contains(refusal(folder / "tum"), "rgb.txt: the times are"));
    CHECK(contains(refusal(folder / "tum"), unit));
  }
  for (const char* eye : {"kitti/image_0", "kitti/image_1"}) {
    for (const char* name : {"0.png", "1.png", "2.png"}) write_image(folder / eye / name, 10);
  }
  write_bytes(folder / "kitti/calib.txt",
              "P0: 30 0 20 0 0 30 12 0 0 0 1 0\nP1: 30 0 20 -16.2 0 30 12 0 0 0 1 0\n");
  write_bytes(folder / "kitti/times.txt", "0\n103736000\n207472000\n");
  CHECK(contains(refusal(folder / "kitti"), "times.txt: the times are"));
  CHECK(contains(refusal(folder / "kitti"), "nanoseconds"));
  fs::remove(folder / "kitti/times.txt");
  CHECK(contains(value_or_throw(open_folder(folder / "kitti"))->take_notes().at(0),
                 "10 Hz is assumed"));
}

TEST_CASE("a calib.txt of KITTI is judged as every calibration is", "[sources][folder][refusal]") {
  const ScratchFolder folder("kitti_judged");
  for (const char* eye : {"image_0", "image_1"}) write_image(folder / eye / "0.png", 10);
  const auto with = [&](const std::string& cx, const std::string& P3, double scale = 1) {
    write_bytes(folder / "calib.txt", "P0: 30 0 " + cx + " 0 0 30 12 0 0 0 1 0\nP1: 30 0 " + cx +
                                          " " + std::to_string(scale * std::stod(P3)) +
                                          " 0 30 12 0 0 0 1 0\n");
    const auto source = open_folder(folder.path());
    return source.ok() ? std::string() : source.problem().message;
  };
  CHECK(with("20", "-16.2") == "");
  CHECK(contains(with("20", "16.2"), "the eyes are swapped"));
  CHECK(contains(with("20", "0"), "in one place"));
  CHECK(contains(with("20", "-16.2", 1000), "looks like millimetres"));
  CHECK(contains(with("20", "-75.6"), "2.52 squares of 25 mm"));
  CHECK(contains(with("50", "-16.2"), "principal point (50, 12) px lies outside"));
  CHECK(contains(with("50", "-16.2"), "calib.txt"));
  write_bytes(folder / "calib.txt",
              "P0: 0.35 0 20 0 0 0.35 12 0 0 0 1 0\nP1: 0.35 0 20 -0.189 0 0.35 12 0 0 0 1 0\n");
  CHECK(contains(open_folder(folder.path()).problem().message, "0.35 px"));
}

TEST_CASE("EuRoC's sensor files are judged as every calibration is", "[sources][folder][refusal]") {
  const ScratchFolder folder("euroc_judged");
  for (const char* camera : {"cam0", "cam1"}) {
    write_image(folder / camera / "data/1000.png", 10);
  }
  write_bytes(folder / "cam0/sensor.yaml", euroc_sensor(0.02));
  const auto with_right = [&](const std::string& sensor) {
    write_bytes(folder / "cam1/sensor.yaml", sensor);
    const auto source = open_folder(folder.path());
    return source.ok() ? std::string() : source.problem().message;
  };
  CHECK(with_right(euroc_sensor(0.13)) == "");
  CHECK(contains(with_right(euroc_sensor(-0.09)), "the eyes are swapped"));
  CHECK(contains(with_right(euroc_sensor(11.02)), "the eyes are 11 m apart"));
  CHECK(contains(with_right(euroc_sensor(2.54)), "2.52 squares of 25 mm"));
  CHECK(contains(with_right(euroc_sensor(2.54)), "cam1/sensor.yaml"));
  std::string off = euroc_sensor(0.13);
  off = test::replaced(off, "20.0, 12.0]", "41.0, 12.0]");
  CHECK(contains(with_right(off), "the right principal point"));
}

TEST_CASE("damaged lines of a TUM list are left out and counted", "[sources][folder]") {
  const ScratchFolder folder("tum_damaged");
  for (const char* name : {"a", "b", "c"}) {
    write_image(folder / "rgb" / (std::string(name) + ".png"), 50);
    write_depth(folder / "depth" / (std::string(name) + ".png"), 2500);
  }
  write_bytes(folder / "depth.txt", "# depth\n1.0 depth/a.png\n2.0 depth/b.png\n3.0 depth/c.png\n");
  write_bytes(folder / "rgb.txt",
              "# color\n\n1.0 rgb/a.png\n1.0 rgb/b.png\nnan rgb/b.png\nrgb/b.png\n2.0 \n"
              "3.0 rgb/c.png\n");
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  CHECK(recording.layout == "TUM");
  REQUIRE(recording.frames.size() == 2);
  CHECK(recording.frames[0].first.filename() == "a.png");  // the earlier line counts
  CHECK(recording.unmatched == 4);
}

TEST_CASE("a folder of 7-Scenes: its names, its poses, its published camera",
          "[sources][folder][threads]") {
  const ScratchFolder folder("seven_scenes");
  for (const char* n : {"000000", "000001"}) {
    const std::string name = std::string("frame-") + n;
    write_image(folder / (name + ".color.jpg"), 70, 640, 480);
    write_depth(folder / (name + ".depth.png"), 1250, 640, 480);
  }
  write_bytes(folder / "frame-000001.pose.txt", "1 0 0 0.5\t\n0 1 0 -0.25\n0 0 1 2e0\n0 0 0 1\n");
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  CHECK(recording.layout == "7-Scenes");
  CHECK_FALSE(recording.frames[0].world_from_camera);
  CHECK(recording.frames[1].world_from_camera->translation() == Vector3d(0.5, -0.25, 2));
  const auto source = value_or_throw(open_folder(folder.path()));
  CHECK(source->format().depth_camera == PinholeCamera{640, 480, 585, 585, 320, 240});
  CHECK(contains(source->take_notes().at(0), "those of 7-Scenes are assumed"));
  // Its colour sensor has another lens, 25 mm beside the depth sensor; numbers in the folder's
  // files override it.
  REQUIRE(source->format().color_sensor);
  CHECK(source->format().color_sensor->camera == PinholeCamera{640, 480, 525, 525, 320, 240});
  const Rigid3 color_from_depth = source->format().color_sensor->color_from_depth;
  CHECK(color_from_depth.translation().x() == Approx(-0.0256).epsilon(0.01));
  CHECK(color_from_depth.linear().isUnitary(1e-9));
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(0, 0) == Approx(1.25));
  const auto with = [&](const char* intrinsics) {
    write_bytes(folder / "camera-intrinsics.txt", intrinsics);
    return value_or_throw(open_folder(folder.path()));
  };
  const auto format_with = [&](const char* intrinsics) { return with(intrinsics)->format(); };
  CHECK(format_with("31 0 20\n0 32 12\n0 0 1\n").depth_camera.fy_px == 32);
  // f is not that of 7-Scenes' Kinect.
  CHECK_FALSE(format_with("31 0 20\n0 32 12\n0 0 1\n").color_sensor);
  const auto published = with("585 0 320\n0 585 240\n0 0 1\n");
  CHECK(published->format().color_sensor->camera == PinholeCamera{640, 480, 525, 525, 320, 240});
  CHECK(contains(published->take_notes().at(0), "has the numbers of 7-Scenes"));
  CHECK(format_with("585 585 320 240\ncolor 530 531 322 243\n").color_sensor->camera ==
        PinholeCamera{640, 480, 530, 531, 322, 243});
  // Other numbers with f = 585, or all that the file can state: nothing is added to what it says.
  for (const char* own : {"585 586 320 240", "585 585 319.5 239.5", "585 585 320 240 640 480",
                          "585 585 320 240 640 480 0.001"}) {
    INFO(own);
    const auto source_of_own = with(own);
    CHECK_FALSE(source_of_own->format().color_sensor);
    for (const std::string& note : source_of_own->take_notes()) {
      CHECK_FALSE(contains(note, "the numbers of 7-Scenes"));
    }
  }
}

// A rotation about an axis of three different components.
Eigen::Quaterniond some_turn() { return Eigen::Quaterniond(0.8, 0.1, -0.3, 0.5).normalized(); }

std::string rows_of(const Rigid3& pose, int rows) {
  std::string text;
  for (int k = 0; k < 4 * rows; ++k) text += fmt::format("{} ", pose.matrix()(k / 4, k % 4));
  return text;
}

TEST_CASE("poses that turn about three axes are read the same from TUM, KITTI and 7-Scenes",
          "[sources][folder]") {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = some_turn().toRotationMatrix();
  pose.translation() = Vector3d(0.1, -0.2, 0.5);
  const auto check = [&](const fs::path& folder) {
    INFO(folder.string());
    const Recording recording = value_or_throw(recognise_folder(folder));
    REQUIRE(recording.frames.at(0).world_from_camera);
    CHECK(recording.frames[0].world_from_camera->isApprox(pose, 1e-9));
  };
  const ScratchFolder folder("three_axes");
  const Eigen::Quaterniond q = some_turn();
  write_tum(folder / "tum", kWidth, kHeight);
  write_bytes(folder / "tum/groundtruth.txt",
              fmt::format("7.0 0.1 -0.2 0.5 {} {} {} {}\n", q.x(), q.y(), q.z(), q.w()));
  check(folder / "tum");
  for (const char* eye : {"image_0", "image_1"}) write_image(folder / "kitti" / eye / "0.png", 10);
  write_bytes(folder / "kitti/calib.txt",
              "P0: 30 0 20 0 0 30 12 0 0 0 1 0\nP1: 30 0 20 -16.2 0 30 12 0 0 0 1 0\n");
  write_bytes(folder / "kitti/poses.txt", rows_of(pose, 3) + "\n");
  check(folder / "kitti");
  write_image(folder / "seven/frame-0.color.png", 70);
  write_depth(folder / "seven/frame-0.depth.png", 1250);
  write_bytes(folder / "seven/frame-0.pose.txt", rows_of(pose, 4));
  check(folder / "seven");

  // KITTI's left colour camera stands beside camera 0, whose poses are given: by its own X axis.
  for (const char* eye : {"image_2", "image_3"}) write_image(folder / "color" / eye / "0.png", 10);
  write_bytes(folder / "color/calib.txt",
              "P0: 30 0 20 0 0 30 12 0 0 0 1 0\nP1: 30 0 20 -16.2 0 30 12 0 0 0 1 0\n"
              "P2: 30 0 20 1.8 0 30 12 0 0 0 1 0\nP3: 30 0 20 -14.1 0 30 12 0 0 0 1 0\n");
  write_bytes(folder / "color/poses.txt", rows_of(pose, 3) + "\n");
  const Recording recording = value_or_throw(recognise_folder(folder / "color"));
  REQUIRE(recording.frames.at(0).world_from_camera);
  CHECK(recording.frames[0].world_from_camera->translation().isApprox(
      pose.translation() - 0.06 * pose.linear().col(0), 1e-9));
}

TEST_CASE("EuRoC's rig is right_from_left of two cameras that are turned in the body",
          "[sources][folder]") {
  const ScratchFolder folder("euroc_turned");
  Rigid3 body_from_left = Rigid3::Identity();
  body_from_left.linear() = some_turn().toRotationMatrix();
  body_from_left.translation() = Vector3d(0.1, -0.2, 0.05);
  Rigid3 right_from_left = Rigid3::Identity();
  right_from_left.linear() =
      Eigen::AngleAxisd(0.03, Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  right_from_left.translation() = Vector3d(-0.11, 0.003, -0.002);
  const Rigid3 body_from_right = body_from_left * right_from_left.inverse();
  for (const auto& [camera, pose] :
       {std::pair{"cam0", body_from_left}, std::pair{"cam1", body_from_right}}) {
    write_image(folder / camera / "data/1000.png", 10);
    std::string rows;
    for (int k = 0; k < 16; ++k) {
      rows += fmt::format("{}{}", k > 0 ? ", " : "", pose.matrix()(k / 4, k % 4));
    }
    write_bytes(folder / camera / "sensor.yaml", "T_BS:\n  data: [" + rows +
                                                     "]\nrate_hz: 20\nresolution: [40, 24]\n"
                                                     "intrinsics: [30.5, 30.25, 20.0, 12.0]\n"
                                                     "distortion_model: radial-tangential\n"
                                                     "distortion_coefficients: [0, 0, 0, 0]\n");
  }
  const StereoRig rig = value_or_throw(open_folder(folder.path()))->format().rig;
  CHECK(rig.right_from_left.isApprox(right_from_left, 1e-9));
}

TEST_CASE("left* and right* in one folder, or any two patterns of names, are pairs",
          "[sources][folder][threads]") {
  const ScratchFolder folder("patterns");
  for (int i = 8; i < 11; ++i) {
    write_image(folder / ("left_" + std::to_string(i) + "m.png"), i);
    write_image(folder / ("right_" + std::to_string(i) + "m.png"), 100 + i);
    write_image(folder / ("other/L" + std::to_string(i) + ".png"), i);
    write_image(folder / ("other/R" + std::to_string(i) + ".png"), 100 + i);
    write_depth(folder / ("other/D" + std::to_string(i) + ".png"), 500);
  }
  write_bytes(folder / "left_notes.txt", "no image");
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 30, 30, 20, 12};
  calibration.rig.right_from_left.translation().x() = -0.06;
  write_stereo_calibration(folder / "calibration.yml", calibration);
  CHECK(is_pattern(folder / "other/L*.png"));
  CHECK_FALSE(is_pattern(folder / "other"));
  for (const auto& source :
       {value_or_throw(open_folder(folder.path())).release(),
        value_or_throw(open_patterns(folder / "other/L*.png", folder / "other/R?*.png", false,
                                     {.calibration = folder / "calibration.yml"}))
            .release()}) {
    const std::unique_ptr<FrameSource> owned(source);
    CHECK(owned->frame_count() == 3);
    Frame frame;
    REQUIRE(owned->next(frame) == FrameStatus::kFrame);
    CHECK(frame.left(0, 0).r == 8);
    CHECK(frame.right(0, 0).r == 108);
  }
  write_bytes(folder / "other/intrinsics.txt", "30 30 20 12");
  const auto depth =
      value_or_throw(open_patterns(folder / "other/L*.png", folder / "other/D*.png", true));
  Frame frame;
  REQUIRE(depth->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(0, 0) == Approx(0.5));

  const auto refused = [](const auto& result) {
    REQUIRE_FALSE(result.ok());
    return result.problem().message;
  };
  CHECK(contains(refused(open_patterns(folder / "x*.png", "", false)), "no image is called"));
  CHECK(contains(refused(open_patterns(folder / "other/L*.png", folder / "other/R1*.png", false)),
                 "3 left and 1"));
  CHECK(contains(refused(open_patterns(folder / "other/L*.png", folder / "other/D*.png", true,
                                       {.calibration = folder / "calibration.yml"})),
                 "holds a stereo rig but"));
}

// Checks the brightness of both eyes.
void check_pair(const std::unique_ptr<FrameSource>& source, int left, int right) {
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(static_cast<int>(frame.left(0, 0).r) == left);
  CHECK(static_cast<int>(frame.right(0, 0).r) == right);
}

TEST_CASE("one pair is read by the names of its two images, or as Middlebury calls them",
          "[sources][folder]") {
  const ScratchFolder root("one_pair");
  constexpr std::array kNames{std::pair{"im0", "im1"}, std::pair{"imL", "imR"},
                              std::pair{"view1", "view5"}};
  for (const auto& [left, right] : kNames) {
    const fs::path folder = root / left;
    INFO(folder.string());
    write_image(folder / (std::string(left) + ".png"), 11);
    write_image(folder / (std::string(right) + ".png"), 99);
    write_image(folder / "groundtruth.png", 50);  // a file that does not belong to the pair
    CHECK(contains(refusal(folder), "no calibration: put calibration.yml"));
    write_rectified_calibration(folder / "rectified.yml",
                                {{{kWidth, kHeight, 30, 30, 20, 12}, 0.06, 4}, 30});
    const auto source = value_or_throw(open_folder(folder));
    CHECK(source->frame_count() == 1);
    check_pair(source, 11, 99);
    CameraRequest request;
    request.device = (folder / (std::string(left) + ".png")).string();
    request.right = (folder / (std::string(right) + ".png")).string();
    check_pair(value_or_throw(open_source(request)), 11, 99);
  }
}

TEST_CASE("a calib.txt of Middlebury is read: mm, and the offset of its disparities",
          "[sources][folder]") {
  const ScratchFolder folder("middlebury");
  write_image(folder / "im0.png", 11);
  write_image(folder / "im1.png", 99);
  const std::string begin =
      "cam0=[30.5 0 20.25; 0 30.5 12.5; 0 0 1]\n"
      "cam1=[30.5 0 24.25; 0 30.5 12.5; 0 0 1]\ndoffs=4\n";
  write_bytes(folder / "calib.txt", begin + "baseline=193.001\nwidth=40\nheight=24\nndisp=70\n");
  const auto source = value_or_throw(open_folder(folder.path()));
  const RectifiedStereo& stereo = source->format().rectified;
  CHECK(source->format().already_rectified);
  CHECK(stereo.camera == PinholeCamera{kWidth, kHeight, 30.5, 30.5, 20.25, 12.5});
  CHECK(stereo.baseline == Approx(0.193001));
  // d = x_L - x_R = f T / Z + cx_L - cx_R
  CHECK(stereo.disparity_at_infinity_px == -4);
  for (const char* wrong : {"", "baseline=193\nwidth=40\n", "baseline=193\nwidth=1e9\nheight=24\n",
                            "baseline=x\nwidth=40\n"}) {
    INFO(wrong);
    write_bytes(folder / "calib.txt", begin + wrong);
    CHECK(contains(refusal(folder.path()), "calib.txt is no calib.txt of Middlebury"));
  }
  const std::string size = "\nwidth=40\nheight=24\n";
  for (const auto& [baseline, fault] :
       {std::pair{"0", "in one place"}, std::pair{"-193", "the eyes are swapped"},
        std::pair{"2520", "2.52 squares of 25 mm"}, std::pair{"0.193", "divided by 1000"}}) {
    INFO(baseline);
    write_bytes(folder / "calib.txt", begin + "baseline=" + baseline + size);
    CHECK(contains(refusal(folder.path()), fault));
    CHECK(contains(refusal(folder.path()), "calib.txt"));
  }
  write_bytes(folder / "calib.txt",
              test::replaced(test::replaced(begin, "20.25", "-20.25"), "24.25", "-16.25") +
                  "baseline=193" + size);
  CHECK(contains(refusal(folder.path()), "principal point"));
  for (const auto& [from, to] :
       {std::pair{"cam1=[30.5 0 24.25; 0 30.5", "cam1=[36.6 0 24.25; 0 36.6"},
        std::pair{"24.25; 0 30.5 12.5", "24.25; 0 30.5 32.5"},
        std::pair{"24.25; 0 30.5 12.5", "24.25; 0 36.6 12.5"}, std::pair{"doffs=4", "doffs=0"}}) {
    write_bytes(folder / "calib.txt", test::replaced(begin, from, to) + "baseline=193" + size);
    CHECK(contains(refusal(folder.path()), "cam1 contradicts cam0 and doffs"));
  }
  write_bytes(folder / "calib.txt", begin + "baseline=193\nbaseline=120" + size);
  CHECK(contains(refusal(folder.path()), "each once"));
  write_bytes(folder / "calib.txt",
              begin + "cam1=[30.5 0 25; 0 30.5 12.5; 0 0 1]\nbaseline=193" + size);
  CHECK(contains(refusal(folder.path()), "cam1= should be 9 numbers, and stand there once"));
  write_rectified_calibration(folder / "rectified.yml",
                              {{{kWidth, kHeight, 30, 30, 20, 12}, 0.06, 0}, 30});
  CHECK(value_or_throw(open_folder(folder.path()))->format().rectified.baseline == 0.06);
}

TEST_CASE("names that end in _0 and _1, _left and _right, _L and _R are pairs, if all are",
          "[sources][folder]") {
  const ScratchFolder root("endings");
  constexpr std::array kEndings{std::pair{"_0", "_1"}, std::pair{"_left", "_right"},
                                std::pair{"_L", "_R"}};
  const RectifiedCalibration calibration{{{kWidth, kHeight, 30, 30, 20, 12}, 0.06, 0}, 30};
  for (const auto& [left, right] : kEndings) {
    const fs::path folder = root / left;
    INFO(folder.string());
    for (int n = 8; n < 11; ++n) {
      write_image(folder / ("a" + std::to_string(n) + left + ".png"), n);
      write_image(folder / ("a" + std::to_string(n) + right + ".png"), 100 + n);
    }
    write_rectified_calibration(folder / "rectified.yml", calibration);
    const auto source = value_or_throw(open_folder(folder));
    CHECK(source->frame_count() == 3);
    for (int n = 8; n < 11; ++n) check_pair(source, n, 100 + n);  // in natural order
    write_image(folder / "another.png", 1);
    CHECK(contains(refusal(folder), "was not recognised"));
  }
  // Two numbered images, each with both eyes side by side.
  const fs::path both = root / "both";
  fs::create_directories(both);
  for (const char* name : {"pair_0.png", "pair_1.png"}) {
    cv::imwrite((both / name).string(), cv::Mat(kHeight, 2 * kWidth, CV_8UC1, cv::Scalar(7)));
  }
  write_rectified_calibration(both / "rectified.yml", calibration);
  CHECK(value_or_throw(open_folder(both))->frame_count() == 2);
  // A calibration for pictures as wide as a street's says that they are one eye's.
  write_rectified_calibration(both / "rectified.yml",
                              {{{2 * kWidth, kHeight, 60, 60, 40, 12}, 0.54, 0}, 30});
  CHECK(value_or_throw(open_folder(both))->frame_count() == 1);
  CHECK(value_or_throw(open_folder(both))->format().width == 2 * kWidth);
  fs::rename(both / "pair_0.png", both / "street_left.png");
  fs::rename(both / "pair_1.png", both / "street_right.png");
  CHECK(value_or_throw(open_folder(both, {.without_calibration = true}))->frame_count() == 1);
}

TEST_CASE("images laid out as EuRoC's whose lenses are not understood take another calibration",
          "[sources][folder]") {
  const ScratchFolder folder("euroc_fisheye");
  for (const char* camera : {"cam0", "cam1"}) {
    write_image(folder / "mav0" / camera / "data/1000.png", camera[3] == '0' ? 11 : 99);
  }
  CHECK(contains(refusal(folder.path()), "has no cam0/sensor.yaml: name a calibration"));
  for (const char* camera : {"cam0", "cam1"}) {
    std::string sensor = euroc_sensor(0);
    sensor.replace(sensor.find("radial-tangential"), 17, "equidistant");
    write_bytes(folder / "mav0" / camera / "sensor.yaml", sensor);
  }
  CHECK(contains(refusal(folder.path()), "name the file with --calibration"));
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 30, 30, 20, 12};
  calibration.rig.right_from_left.translation().x() = -0.06;
  write_stereo_calibration(folder / "own.yml", calibration);
  check_pair(value_or_throw(open_folder(folder.path(), {.calibration = folder / "own.yml"})), 11,
             99);
}

TEST_CASE("stereo images open without a calibration for whoever looks for one",
          "[sources][folder][threads]") {
  const ScratchFolder folder("without");
  write_image(folder / "left/0.png", 1);
  write_image(folder / "right/0.png", 2);
  const auto source = value_or_throw(open_folder(folder.path(), {.without_calibration = true}));
  CHECK((source->format().width == kWidth && source->format().height == kHeight));
  CHECK(contains(refusal(folder.path()), "palpable calibrate"));

  cv::imwrite((folder / "single.png").string(), cv::Mat(kHeight, 2 * kWidth, CV_8UC1));
  fs::remove_all(folder / "left");
  fs::remove_all(folder / "right");
  const auto side = value_or_throw(open_folder(folder.path(), {.without_calibration = true}));
  CHECK(side->format().width == kWidth);
  write_image(folder / "single.png", 1);
  const auto one = open_folder(folder.path(), {.without_calibration = true});
  REQUIRE_FALSE(one.ok());
  CHECK(contains(one.problem().message, "is 40 x 24 px, which is no pair side by side"));
}

// Original data of other groups.
TEST_CASE("real sets of KITTI and 7-Scenes open with their poses", "[sources][folder][real]") {
  const fs::path data = "../shared/data";
  if (!fs::exists(data / "stereo_video_kitti1") || !fs::exists(data / "rgbd_pose_7scenes")) {
    PALPABLE_SKIP("no stereo_video_kitti1 or rgbd_pose_7scenes in " + data.string());
  }
  const auto kitti = value_or_throw(open_folder(data / "stereo_video_kitti1"));
  CHECK(kitti->frame_count() == 16);
  CHECK(kitti->format().width == 1226);
  CHECK(kitti->format().rectified.baseline == Approx(379.8145 / 707.0912));
  const Recording drive = value_or_throw(recognise_folder(data / "stereo_video_kitti1"));
  // The camera of a car: about 1 m forward per frame (poses.txt).
  for (std::size_t i = 1; i < drive.frames.size(); ++i) {
    REQUIRE(drive.frames[i].world_from_camera);
    const Vector3d step = drive.frames[i].world_from_camera->translation() -
                          drive.frames[i - 1].world_from_camera->translation();
    CHECK((step.norm() > 0.8 && step.norm() < 1.6));
    CHECK(step.z() > 0.7);
  }
  const auto kitchen = value_or_throw(open_folder(data / "rgbd_pose_7scenes"));
  CHECK(kitchen->frame_count() == 90);
  CHECK(kitchen->format().depth_camera == PinholeCamera{640, 480, 585, 585, 320, 240});
  CHECK(kitchen->format().color_sensor);
  Frame frame;
  REQUIRE(kitchen->next(frame) == FrameStatus::kFrame);
  const Recording walk = value_or_throw(recognise_folder(data / "rgbd_pose_7scenes"));
  for (const RecordedFrame& recorded : walk.frames) CHECK(recorded.world_from_camera);
}

}  // namespace
}  // namespace palpable
