#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/exported_calibration.h"
#include "palpable/live/sources/source_calibration.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {
namespace {

using test::file_bytes;
using test::replaced;
using test::ScratchFolder;
using test::write_bytes;

constexpr auto kDepth = FrameFormat::Kind::kColorDepth;

StereoRig rig_of_640() {
  StereoRig rig;
  rig.left = {{640, 480, 500, 501, 320, 240}, {-0.05, 0.01, 1e-4, -2e-4, 0}};
  rig.right = {{640, 480, 502, 503, 315, 245}, {-0.04, 0.02, 0, 1e-4, 0}};
  rig.right_from_left.translation() << -0.063, 1e-3, -5e-4;
  return rig;
}

SourceCalibration read_for_640(const std::filesystem::path& path,
                               std::optional<FrameFormat::Kind> kind = std::nullopt) {
  INFO(path);
  return value_or_throw(read_source_calibration(path, 640, 480, kind));
}

std::string refusal_of(const std::filesystem::path& path,
                       std::optional<FrameFormat::Kind> kind = std::nullopt) {
  const auto read = read_source_calibration(path, 640, 480, kind);
  if (read.ok()) return "it is read";
  CHECK(read.problem().message.find('\n') == std::string::npos);
  return read.problem().message;
}

bool tells(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

void check_rig(const FrameFormat& format) {
  const StereoRig truth = rig_of_640();
  CHECK(format.kind == FrameFormat::Kind::kStereo);
  CHECK_FALSE(format.already_rectified);
  CHECK(format.width == 640);
  CHECK(format.rig.left == truth.left);
  CHECK(format.rig.right == truth.right);
  CHECK(
      (format.rig.right_from_left.matrix() - truth.right_from_left.matrix()).cwiseAbs().maxCoeff() <
      test::tolerance(1e-12, "pose from R and P of the text"));
}

// Like those of OpenCV's sample: without a size.
void remove_size(const std::filesystem::path& path) {
  std::string text = file_bytes(path);
  text = replaced(replaced(text, "image_width: 640\n", ""), "image_height: 480\n", "");
  write_bytes(path, text);
}

TEST_CASE("either file of OpenCV's pair, or their folder, gives the rig",
          "[sources][calibration][foreign]") {
  const ScratchFolder all("opencv_pair");
  export_calibration(all.path(), rig_of_640());
  std::filesystem::create_directories(all / "pair");
  for (const char* name : {"intrinsics.yml", "extrinsics.yml"}) {
    std::filesystem::rename(all / name, all / "pair" / name);
  }
  const auto folder = all / "pair";
  check_rig(read_for_640(folder / "intrinsics.yml").format);
  check_rig(read_for_640(folder / "extrinsics.yml").format);
  check_rig(read_for_640(folder).format);
  CHECK(read_for_640(folder).guesses.empty());

  remove_size(folder / "intrinsics.yml");
  const SourceCalibration guessed = read_for_640(folder / "extrinsics.yml");
  check_rig(guessed.format);
  REQUIRE(guessed.guesses.size() == 1);
  CHECK(tells(guessed.guesses.front(), "no picture size is stated in"));
  CHECK(value_or_throw(read_source_calibration(folder, 0, 0)).format.width == 0);
  const auto small = read_source_calibration(folder, 320, 240);
  REQUIRE_FALSE(small.ok());
  CHECK(tells(small.problem().message, "about 640 x 480"));

  // Names that tell nothing.
  std::filesystem::rename(folder / "intrinsics.yml", folder / "a.yaml");
  std::filesystem::rename(folder / "extrinsics.yml", folder / "b.yaml");
  check_rig(read_for_640(folder / "a.yaml").format);
  std::filesystem::copy_file(folder / "b.yaml", folder / "c.yaml");
  CHECK(tells(refusal_of(folder / "a.yaml"), "b.yaml and c.yaml could both be it"));
  std::filesystem::remove(folder / "b.yaml");
  std::filesystem::remove(folder / "c.yaml");
  CHECK(tells(refusal_of(folder / "a.yaml"), "put its extrinsics.yml beside it"));
  CHECK(tells(refusal_of(folder), "put its extrinsics.yml beside it"));
}

TEST_CASE("either of ROS's files gives the rig, and for depth itself",
          "[sources][calibration][foreign]") {
  const ScratchFolder folder("ros_pair");
  export_calibration(folder.path(), rig_of_640());
  for (const char* name : {"left.yaml", "right.yaml"}) {
    check_rig(read_for_640(folder / name).format);
    const SourceCalibration depth = read_for_640(folder / name, kDepth);
    CHECK(depth.format.kind == kDepth);
    const auto& eye = std::string(name) == "left.yaml" ? rig_of_640().left : rig_of_640().right;
    CHECK(depth.format.depth_camera == eye.pinhole);
    REQUIRE(depth.guesses.size() == 1);
    CHECK(tells(depth.guesses.front(), "lens distortion"));
  }
  CHECK(tells(refusal_of(folder.path()), "several calibrations"));  // OpenCV's, too
  CHECK(tells(refusal_of(folder.path(), kDepth), "left.yaml and right.yaml"));
  const auto rename = [&](const char* from, const char* to) {
    std::filesystem::rename(folder / from, folder / to);
  };
  for (const auto& [left, right] :
       {std::pair{"cam0.yml", "cam1.yml"}, {"zed_l.yml", "zed_r.yml"}, {"x.yml", "a.yml"}}) {
    rename("left.yaml", left);
    rename("right.yaml", right);
    check_rig(read_for_640(folder / left).format);
    check_rig(read_for_640(folder / right).format);
    rename(left, "left.yaml");
    rename(right, "right.yaml");
  }
  // Each named for the other eye.
  rename("left.yaml", "a");
  rename("right.yaml", "left.yaml");
  rename("a", "right.yaml");
  CHECK(tells(refusal_of(folder / "left.yaml"), "the eyes are swapped"));
  std::filesystem::remove(folder / "right.yaml");
  CHECK(read_for_640(folder.path(), kDepth).format.kind == kDepth);
  CHECK(tells(refusal_of(folder / "left.yaml"), "camera file of one eye (ROS"));
}

const std::string kChain =
    "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.05, 0.01, 0.0001, -0.0002]\n"
    "  distortion_model: radtan\n  intrinsics: [500.0, 501.0, 320.0, 240.0]\n"
    "  resolution: [640, 480]\ncam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.063]\n"
    "  - [0.0, 1.0, 0.0, 0.001]\n  - [0.0, 0.0, 1.0, -0.0005]\n  - [0.0, 0.0, 0.0, 1.0]\n"
    "  camera_model: pinhole\n  distortion_coeffs: [-0.04, 0.02, 0.0, 0.0001]\n"
    "  distortion_model: radtan\n  intrinsics: [502.0, 503.0, 315.0, 245.0]\n"
    "  resolution: [640, 480]\n";

TEST_CASE("Kalibr's camchain gives the rig, alone, in a folder and with decimal commas",
          "[sources][calibration][foreign]") {
  const ScratchFolder folder("camchain");
  write_bytes(folder / "camchain-left-right.yaml", kChain);
  check_rig(read_for_640(folder / "camchain-left-right.yaml").format);
  check_rig(read_for_640(folder.path()).format);
  CHECK(read_for_640(folder.path(), kDepth).format.depth_camera.fx_px == 500);
  std::string commas = kChain;
  for (char& c : commas) c = c == '.' ? ',' : c;
  write_bytes(folder / "camchain-left-right.yaml", commas);
  check_rig(read_for_640(folder.path()).format);
  write_bytes(folder / "camchain-left-right.yaml", replaced(kChain, "-0.063", "0.063"));
  CHECK(tells(refusal_of(folder.path()), "the eyes are swapped"));
  write_bytes(folder / "camchain-left-right.yaml", replaced(kChain, "-0.063", "-63.0"));
  CHECK(tells(refusal_of(folder.path()), "millimetres"));
  write_bytes(folder / "camchain-left-right.yaml", replaced(kChain, "radtan", "equidistant"));
  CHECK(tells(refusal_of(folder.path()), "equidistant"));
}

TEST_CASE("a RealSense's JSON is a rectified pair, and for depth the depth camera",
          "[sources][calibration][foreign]") {
  const ScratchFolder folder("realsense");
  write_bytes(folder / "rs.json",
              R"({"baseline": "-49.9496", "rectified.0.fx": "970.688", "rectified.0.fy": "970.688",
 "rectified.0.ppx": "955.654", "rectified.0.ppy": "545.571", "rectified.0.width": "1920",
 "rectified.0.height": "1080", "rectified.1.fx": "380.5", "rectified.1.fy": "380.5",
 "rectified.1.ppx": "320.5", "rectified.1.ppy": "240.5", "rectified.1.width": "640",
 "rectified.1.height": "480"})");
  const PinholeCamera truth{640, 480, 380.5, 380.5, 320.5, 240.5};
  const SourceCalibration stereo = read_for_640(folder / "rs.json");
  CHECK(stereo.format.already_rectified);
  CHECK(stereo.format.rectified.camera == truth);
  CHECK(stereo.format.rectified.baseline == Approx(0.0499496));
  CHECK(stereo.has_more_sizes);
  CHECK_FALSE(problem_with(stereo, BaselineRule::kUsual));
  const SourceCalibration depth = read_for_640(folder.path(), kDepth);
  CHECK(depth.format.depth_camera == truth);
  CHECK_FALSE(depth.format.color_sensor);
  REQUIRE(depth.guesses.size() == 1);
  CHECK(tells(depth.guesses.front(), "of the depth's view"));
}

TEST_CASE("one rig's file is read without its first line and with decimal commas",
          "[sources][calibration][foreign]") {
  const ScratchFolder folder("own_variants");
  StereoCalibration own;
  own.rig = rig_of_640();
  write_stereo_calibration(folder / "a.yml", own);
  const std::string text = file_bytes(folder / "a.yml");
  const std::string headless = replaced(text, "%YAML:1.0\n---\n", "");
  write_bytes(folder / "a.yml", headless);
  check_rig(read_for_640(folder / "a.yml").format);
  std::string commas = headless;
  for (char& c : commas) c = c == '.' ? ',' : c;
  write_bytes(folder / "a.yml", "%YAML:1.0\n---\n" + commas);
  check_rig(read_for_640(folder / "a.yml").format);
  // Without a size it is for the pictures.
  remove_size(folder / "a.yml");
  check_rig(read_for_640(folder / "a.yml").format);
}

TEST_CASE("intrinsics with decimal commas are refused as such, in each of their lines",
          "[sources][calibration][refusal]") {
  const ScratchFolder folder("decimal_commas");
  for (const char* text : {"585,5 585,5 320,0 240,0", "585 585 320 240\nunit_m 0,001",
                           "585 585 320 240\ncolor 600,5 600,5 320,5 240,5"}) {
    write_bytes(folder / "intrinsics.txt", text);
    CHECK(tells(refusal_of(folder / "intrinsics.txt", kDepth), "decimal commas"));
  }
}

TEST_CASE("what is read by no reader is refused by its program's name",
          "[sources][calibration][refusal]") {
  const ScratchFolder folder("named_refusals");
  const auto refusal = [&](const char* name, const std::string& text) {
    write_bytes(folder / name, text);
    const std::string said = refusal_of(folder / name);
    CHECK(tells(said, name));
    std::filesystem::remove(folder / name);
    return said;
  };
  CHECK(tells(refusal("cam.yaml",
                      "%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 640\n"
                      "projection_parameters:\n   fx: 500\n"),
              "camodocal's file of one eye (PINHOLE)"));
  CHECK(tells(refusal("cam.yaml", "%YAML:1.0\nCamera.fx: 500.0\nCamera.bf: 40.0\n"), "ORB-SLAM"));
  CHECK(tells(refusal("sensor.yaml", "sensor_type: camera\nT_BS:\n  data: [1.0]\n"), "EuRoC"));
  CHECK(tells(refusal("ost.txt",
                      "# oST\n[image]\n\nwidth\n640\n\n[narrow_stereo/left]\n\ncamera "
                      "matrix\n1 0 0\n"),
              "left.yaml"));
  CHECK(tells(refusal("calib.txt", "P0: 7.1 0 6 0 0 7 1 0 0 0 1 0\n"), "KITTI"));
  CHECK(tells(refusal("calib.txt", "cam0=[500 0 320; 0 500 240; 0 0 1]\n"), "Middlebury"));
  for (const auto& [name, text] : {std::pair{"a.json", "{\"a\": 1}"},
                                   {"a.xml", "<a><b>1</b></a>"},
                                   {"a.yaml", "a: 1\n"},
                                   {"a.yml", "%YAML:1.0\n---\na: 1\n"},
                                   {"notes.txt", "the camera is blue\n"}}) {
    const std::string said = refusal(name, text);
    for (const char* program :
         {"K1", "M1", "camera_matrix", "Kalibr", "RealSense", "ZED", "baseline_m", "fx fy cx cy"}) {
      CHECK(tells(said, program));
    }
  }
  CHECK(tells(refusal_of(folder.path()), "has no calibration"));
}

}  // namespace
}  // namespace palpable
