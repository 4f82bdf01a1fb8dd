// Folders of phones, and of data sets whose colour and depth come in lists.
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/folder_source.h"
#include "palpable/live/sources/image_file.h"
#include "palpable/live/sources/picture_sizes.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::ScratchFolder;
using test::write_bytes;

// A phone's sizes, divided by 30 and 8: 3.75 colour pixels for a depth pixel.
constexpr int kColorWidth = 60, kColorHeight = 45;
constexpr int kDepthWidth = 16, kDepthHeight = 12;

void write_color(const fs::path& path, int width = kColorWidth, int height = kColorHeight) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar::all(90)));
}

void write_steps(const fs::path& path, int steps, int width = kDepthWidth,
                 int height = kDepthHeight) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), cv::Mat(height, width, CV_16UC1, cv::Scalar(steps)));
}

std::string number_name(int n) { return fmt::format("{:06d}.png", n); }

std::string message_of(const fs::path& folder) {
  const auto result = open_folder(folder);
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message.find('\n') == std::string::npos);
  return result.problem().message;
}

bool says(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

bool any_says(const std::vector<std::string>& notes, const std::string& part) {
  for (const std::string& note : notes) {
    if (note.find(part) != std::string::npos) return true;
    UNSCOPED_INFO(note);
  }
  return false;
}

// A film whose pictures have the brightness 10 + 20 n.
void write_film(const fs::path& path, int pictures) {
  fs::create_directories(path.parent_path());
  cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                         20, cv::Size(64, 48));
  REQUIRE(writer.isOpened());
  for (int n = 0; n < pictures; ++n) {
    writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10 + 20 * n)));
  }
}

TEST_CASE("a camera's numbers for another size move its pixels' centres with its borders",
          "[sources][sizes]") {
  // The phone of record3d#67: 1920 x 1440 beside 256 x 192.
  const PinholeCamera color{1920, 1440, 1450, 1452, 963.25, 722.5};
  const PinholeCamera depth = resized(color, 256, 192);
  CHECK(depth.fx_px == Approx(1450 / 7.5));
  CHECK(depth.fy_px == Approx(1452 / 7.5));
  CHECK(depth.cx_px == Approx((963.25 + 0.5) / 7.5 - 0.5));
  CHECK(depth.cy_px == Approx((722.5 + 0.5) / 7.5 - 0.5));
  // The left border, half a pixel beside the first centre, is the same ray in both.
  CHECK((-0.5 - depth.cx_px) / depth.fx_px == Approx((-0.5 - color.cx_px) / color.fx_px));
  CHECK((255.5 - depth.cx_px) / depth.fx_px == Approx((1919.5 - color.cx_px) / color.fx_px));
  CHECK(resized(depth, 1920, 1440).cx_px == Approx(963.25));
  CHECK(resized(color, 1920, 1440) == color);
}

TEST_CASE("depth of fewer pixels than the colour's: the numbers belong to one, and are scaled",
          "[sources][sizes][threads]") {
  const ScratchFolder folder("two_sizes");
  for (int n = 0; n < 3; ++n) {
    write_color(folder / ("color_" + number_name(n)));
    write_steps(folder / ("depth_" + number_name(n)), 1000 + n);
  }
  const double s = 3.75;
  struct Case {
    std::string text;
    double fx;  // px, of the depth
    double cx;
    std::string note;
  };
  for (const Case& c : {
           Case{"48 49 29.5 22 60 45\n", 48 / s, 30 / s - 0.5, "f = 12.8 px there and 48 px here"},
           Case{"12.8 13 7.5 5.5 16 12\n", 12.8, 7.5, "f = 12.8 px there and 48 px here"},
           Case{"48 49 30.5 22\n", 48 / s, 31 / s - 0.5, "taken for the colour's, 60 x 45"},
           Case{"12.8 13 7.5 5.5\n", 12.8, 7.5, "taken for the depth's, 16 x 12"},
       }) {
    INFO(c.text);
    write_bytes(folder / "intrinsics.txt", c.text);
    const auto source = value_or_throw(open_folder(folder.path()));
    const FrameFormat& format = source->format();
    CHECK(format.width == kColorWidth);
    CHECK(format.height == kColorHeight);
    CHECK(depth_size_of(format) == std::pair(kDepthWidth, kDepthHeight));
    CHECK(format.depth_camera.fx_px == Approx(c.fx));
    CHECK(format.depth_camera.cx_px == Approx(c.cx));
    REQUIRE(format.color_sensor);
    CHECK(format.color_sensor->camera.width == kColorWidth);
    CHECK(format.color_sensor->camera.fx_px == Approx(s * c.fx));
    CHECK(format.color_sensor->camera.cx_px == Approx(s * (c.cx + 0.5) - 0.5));
    CHECK(format.color_sensor->color_from_depth.matrix().isIdentity(0));
    CHECK(any_says(source->take_notes(), c.note));
    Frame frame;
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.left.width() == kColorWidth);
    REQUIRE(frame.depth.width() == kDepthWidth);
    CHECK(frame.depth(15, 11) == Approx(1.0F));
  }
  // Two cameras: each has its own numbers, and nothing is scaled.
  write_bytes(folder / "intrinsics.txt",
              "12 12.5 7.5 5.5\ncolor 47 48 29 22 1 0 0 0.01 0 1 0 0 0 0 1 0\n");
  const auto beside = value_or_throw(open_folder(folder.path()));
  CHECK(beside->format().depth_camera == PinholeCamera{16, 12, 12, 12.5, 7.5, 5.5});
  CHECK(beside->format().color_sensor->camera == PinholeCamera{60, 45, 47, 48, 29, 22});
  // Later pictures of the other size are left out.
  write_steps(folder / ("depth_" + number_name(1)), 1000, 60, 45);
  Frame frame;
  const auto again = value_or_throw(open_folder(folder.path()));
  REQUIRE(again->next(frame) == FrameStatus::kFrame);
  CHECK(again->next(frame) == FrameStatus::kUnreadable);
  CHECK(says(again->last_trouble(), "is 60 x 45 px; the others are 16 x 12"));
}

TEST_CASE("two sizes that no one camera explains are refused with what to write",
          "[sources][sizes][refusal]") {
  const ScratchFolder folder("two_sizes_refused");
  write_color(folder / "color_0.png");
  write_steps(folder / "depth_0.png", 1000);
  write_bytes(folder / "intrinsics.txt", "48 49 29.5 22 640 480\n");
  CHECK(says(message_of(folder.path()), "for images of 640 x 480 px but color_0.png is 60 x 45"));
  write_bytes(folder / "intrinsics.txt", "20 20 16 12\n");  // near the middle of neither
  CHECK(says(message_of(folder.path()), "fx fy cx cy width height"));
  write_bytes(folder / "intrinsics.txt", "48 49 29.5 22\n");
  write_steps(folder / "depth_0.png", 1000, 16, 9);
  CHECK(says(message_of(folder.path()), "no two sizes of one view"));
  CHECK(says(message_of(folder.path()), "color fx fy cx cy"));
  write_steps(folder / "depth_0.png", 1000, 12, 16);
  CHECK(says(message_of(folder.path()), "lies on its side"));
}

TEST_CASE("a folder of Stray Scanner: film, depth in mm, confidence, poses of the camera",
          "[sources][folder][phones][threads]") {
  const ScratchFolder root("stray");
  const fs::path folder = root / "ab12";
  write_film(folder / "rgb.mp4", 6);
  for (int n = 0; n < 7; ++n) {  // one more than pictures, as the app writes
    if (n == 3) continue;        // lost
    write_steps(folder / "depth" / number_name(n), 1000 + n);
    cv::Mat sure(kDepthHeight, kDepthWidth, CV_8UC1, cv::Scalar(2));
    sure.at<std::uint8_t>(4, 5) = 0;
    sure.at<std::uint8_t>(4, 6) = 1;
    fs::create_directories(folder / "confidence");
    cv::imwrite((folder / "confidence" / number_name(n)).string(), sure);
  }
  write_bytes(folder / "camera_matrix.csv", "48.0,0.0,31.5\n0.0,48.5,23.5\n0.0,0.0,1.0\n");
  std::string lines = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
  for (int n = 0; n < 7; ++n) {
    // A quarter turn about y: the camera's Z axis points along the world's x.
    lines += fmt::format("{}, {:06d}, 1.0, {}.5, 3.0, 0.0, 0.70710678, 0.0, 0.70710678\n",
                         5000.25 + 0.1 * n, n, n);
  }
  write_bytes(folder / "odometry.csv", lines);
  const Recording recording = value_or_throw(recognise_folder(folder));
  CHECK(recording.layout == "Stray Scanner");
  REQUIRE(recording.frames.size() == 6);
  CHECK(recording.starts_at == Approx(5000.25));
  REQUIRE(recording.frames[3].world_from_camera);
  CHECK((*recording.frames[3].world_from_camera * Vector3d(0, 0, 1) - Vector3d(2, 4.5, 3)).norm() <
        1e-7);
  const auto source = value_or_throw(open_folder(folder));
  const FrameFormat& format = source->format();
  CHECK(format.depth_unit == 0.001);
  CHECK(format.width == 64);
  CHECK(depth_size_of(format) == std::pair(kDepthWidth, kDepthHeight));
  CHECK(format.color_sensor->camera.fx_px == Approx(48));
  CHECK(format.depth_camera.fx_px == Approx(12));
  CHECK(format.depth_camera.cx_px == Approx(7.5));
  CHECK(source->frame_count() == 5);
  Frame frame;
  for (const int n : {0, 1, 2, 4, 5}) {
    INFO("picture " << n);
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(std::abs(frame.left(30, 20).g - (10 + 20 * n)) <= 8);  // MPEG-4's loss; half a step: 10
    CHECK(frame.depth(0, 0) == Approx(1.0 + 0.001 * n));
    CHECK(std::isnan(frame.depth(5, 4)));
    CHECK(frame.depth(6, 4) == Approx(1.0 + 0.001 * n));
    CHECK(frame.time == Approx(0.1 * n).margin(1e-9));
  }
  CHECK(source->next(frame) == FrameStatus::kEnd);
}

TEST_CASE("Stray Scanner's lens is the middle of all frames' where they have one",
          "[sources][folder][phones]") {
  const ScratchFolder folder("stray_lens");
  for (int n = 0; n < 5; ++n) {
    write_color(folder / "rgb" / fmt::format("{}.jpg", n));
    write_steps(folder / "depth" / number_name(n), 500);
  }
  write_bytes(folder / "camera_matrix.csv", "55,0,29.5\n0,55,22\n0,0,1\n");
  std::string lines = "timestamp, frame, x, y, z, qx, qy, qz, qw, fx, fy, cx, cy\n";
  for (int n = 0; n < 5; ++n) {
    lines +=
        fmt::format("{}, {:06d}, 0, 0, 0, 0, 0, 0, 1, {}, {}, 29.5, 22.0\n", n, n, 50 + n, 51 + n);
  }
  write_bytes(folder / "odometry.csv", lines);
  const auto source = value_or_throw(open_folder(folder.path()));
  CHECK(source->format().color_sensor->camera.fx_px == Approx(52));
  CHECK(source->format().color_sensor->camera.fy_px == Approx(53));
  CHECK(any_says(source->take_notes(), "f from 50.0 to 54.0 px"));
  // The oldest version has poses alone, and without odometry the matrix counts.
  write_bytes(folder / "odometry.csv", "1, 2, 3, 0, 0, 0, 1\n4, 5, 6, 0, 0, 0, 1\n");
  const Recording old = value_or_throw(recognise_folder(folder.path()));
  CHECK(old.frames[1].world_from_camera->translation() == Vector3d(4, 5, 6));
  CHECK_FALSE(old.frames[1].time);
  CHECK(old.calibration->format.depth_camera.fx_px == 55);

  write_bytes(folder / "camera_matrix.csv", "55,0\n");
  CHECK(says(message_of(folder.path()), "camera_matrix.csv should hold the nine numbers"));
  write_bytes(folder / "camera_matrix.csv", "55,5 0 29,5\n0 55,5 22,0\n0 0 1\n");
  CHECK(says(message_of(folder.path()), "decimal commas"));
  write_bytes(folder / "camera_matrix.csv", "55,0,29.5\n0,55,22\n0,0,1\n");
  fs::remove_all(folder / "rgb");
  CHECK(says(message_of(folder.path()), "has no rgb.mp4"));
  write_bytes(folder / "rgb.mp4", "no film");
  CHECK(says(message_of(folder.path()), "rgb.mp4 is no video that can be decoded"));
  fs::remove_all(folder / "depth");
  write_bytes(folder / "depth/000000.npy", "x");
  CHECK(says(message_of(folder.path()), "of an old Stray Scanner"));
}

// Depth in metres as Record3D writes it: one channel R of floats.
void write_exr(const fs::path& path, const cv::Mat& metres) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), metres);
  std::string bytes = test::file_bytes(path);
  const std::size_t at = bytes.find("chlist") + 7 + 4;
  REQUIRE(bytes.at(at) == 'Y');
  bytes[at] = 'R';
  write_bytes(path, bytes);
}

TEST_CASE("a folder of Record3D: EXR in metres, K by columns, poses with OpenGL's axes",
          "[sources][folder][phones][threads]") {
  const ScratchFolder root("record3d");
  const fs::path folder = root / "EXR_RGBD";
  for (int n = 0; n < 3; ++n) {
    write_color(folder / fmt::format("rgb/{}.jpg", n));
    cv::Mat metres(kDepthHeight, kDepthWidth, CV_32FC1, cv::Scalar(0.5 + 0.25 * n));
    metres.at<float>(3, 2) = std::nanf("");
    metres.at<float>(3, 3) = 0;
    write_exr(folder / fmt::format("depth/{}.exr", n), metres);
  }
  const std::string half = "0.7071067811865476";
  const std::string metadata =
      R"({"w":60,"h":45,"dw":16,"dh":12,"fps":30,"K":[48,0,0,0,49,0,29,22,1],)"
      R"("frameTimestamps":[10.5,10.6,10.7],"poses":[[0,0,0,1,1,2,3],[0,)" +
      half + ",0," + half + R"(,0,0,0],[0,0,0,1,0,0,0]]})";
  write_bytes(folder / "metadata.json", metadata);
  const Recording recording = value_or_throw(recognise_folder(root.path()));
  CHECK(recording.layout == "Record3D");
  REQUIRE(recording.frames.size() == 3);
  // Not turned, the camera looks along the world's -z, and its Y axis, down, is the world's -y.
  const Rigid3& first = *recording.frames[0].world_from_camera;
  CHECK((first * Vector3d(0, 0, 1) - Vector3d(1, 2, 2)).norm() < 1e-12);
  CHECK((first * Vector3d(0, 1, 0) - Vector3d(1, 1, 3)).norm() < 1e-12);
  CHECK((first * Vector3d(1, 0, 0) - Vector3d(2, 2, 3)).norm() < 1e-12);
  // A quarter turn about y takes -z to -x.
  CHECK((*recording.frames[1].world_from_camera * Vector3d(0, 0, 1) - Vector3d(-1, 0, 0)).norm() <
        1e-12);
  const auto source = value_or_throw(open_folder(root.path()));
  CHECK(source->format().color_sensor->camera == PinholeCamera{60, 45, 48, 49, 29, 22});
  CHECK(source->format().depth_camera.fx_px == Approx(48 / 3.75));
  CHECK(source->format().depth_unit == 0);
  CHECK_FALSE(any_says(source->take_notes(), "unit"));
  Frame frame;
  for (int n = 0; n < 3; ++n) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.time == Approx(0.1 * n).margin(1e-9));
    CHECK(frame.depth(8, 8) == 0.5F + 0.25F * static_cast<float>(n));
    CHECK(std::isnan(frame.depth(2, 3)));
    CHECK(std::isnan(frame.depth(3, 3)));
  }
  CHECK(says(open_folder(root.path(), {.depth_unit = 0.001}).problem().message, "is in metres"));
  // Of lenses that focus, the middle; it takes the place of K.
  std::string focusing = metadata;
  focusing.replace(focusing.find(R"("fps")"), 0,
                   R"("perFrameIntrinsicCoeffs":[[50,50,29,22],[52,51,29,22],[60,52,29,22]],)");
  write_bytes(folder / "metadata.json", focusing);
  CHECK(value_or_throw(recognise_folder(folder)).calibration->format.depth_camera.fx_px == 52);
}

TEST_CASE("depth in metres is read from any names", "[sources][folder]") {
  const ScratchFolder root("exr_names");
  write_color(root / "a/color_0.png");
  write_exr(root / "a/depth_0.exr", cv::Mat(kDepthHeight, kDepthWidth, CV_32FC1, cv::Scalar(2.5)));
  write_bytes(root / "a/intrinsics.txt", "48 49 29.5 22 60 45\n");
  Frame frame;
  REQUIRE(value_or_throw(open_folder(root / "a"))->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 3) == 2.5F);
  REQUIRE(value_or_throw(open_patterns(root / "a/color_*.png", root / "a/depth_*.exr", true))
              ->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 3) == 2.5F);
}

TEST_CASE("a folder of Record3D that cannot be read says what to export",
          "[sources][folder][phones][refusal]") {
  const ScratchFolder root("record3d_refused");
  write_bytes(root / "r3d/metadata", "{}");
  write_bytes(root / "r3d/rgbd/0.depth", "bvx-");
  CHECK(says(message_of(root / "r3d"), "export the recording in the app as EXR + RGB"));
  write_color(root / "exr/rgb/0.jpg");
  write_exr(root / "exr/depth/0.exr", cv::Mat(12, 16, CV_32FC1, cv::Scalar(1)));
  write_bytes(root / "exr/metadata.json", "{\"w\":60,");
  CHECK(says(message_of(root / "exr"), "metadata.json"));
  write_bytes(root / "exr/metadata.json", R"({"w":60,"h":45,"K":[1,2]})");
  CHECK(says(message_of(root / "exr"), "should have K, nine numbers"));
  write_bytes(root / "exr/metadata.json", R"({"w":1920,"h":1440,"K":[48,0,0,0,49,0,29,22,1]})");
  CHECK(says(message_of(root / "exr"), "for images of 1920 x 1440 px"));
}

TEST_CASE("EXR files that are no depth are refused by what they are", "[sources][image][refusal]") {
  const ScratchFolder folder("exr");
  const auto refused = [&](const std::string& bytes) {
    write_bytes(folder / "a.exr", bytes);
    ImageFileReader reader;
    DepthImage image;
    const auto read = reader.read_metres(folder / "a.exr", image);
    return read.ok() ? "was read" : read.problem().message;
  };
  write_exr(folder / "good.exr", cv::Mat(12, 16, CV_32FC1, cv::Scalar(1.5)));
  const std::string good = test::file_bytes(folder / "good.exr");
  CHECK(refused(good) == "was read");
  CHECK(says(refused(""), "is no OpenEXR file"));
  CHECK(says(refused("hello"), "is no OpenEXR file"));
  CHECK(says(refused(good.substr(0, 90)), "is cut off"));
  CHECK(refused(good.substr(0, good.size() - 20)) != "was read");
  std::string tiles = good;
  tiles[5] = 2;
  CHECK(says(refused(tiles), "tiles or parts"));
  std::string huge = good;
  huge[huge.find("box2i") + 6 + 4 + 10] = 0x7f;  // third byte of the right border
  CHECK(says(refused(huge), "pixels"));
  std::string lossy = good;
  lossy[lossy.rfind("compression") + 12 + 4] = 6;
  CHECK(says(refused(lossy), "with loss"));
  cv::imwrite((folder / "rgb.exr").string(), cv::Mat(12, 16, CV_32FC3, cv::Scalar::all(1)));
  CHECK(says(refused(test::file_bytes(folder / "rgb.exr")), "has 3 channels"));
}

std::string openloris_sensors() {
  return "%YAML:1.0\n---\nt265_fisheye1_optical_frame:\n   width: 848\n   height: 800\n"
         "   intrinsics: !!opencv-matrix\n      rows: 1\n      cols: 4\n      dt: d\n"
         "      data: [ 284.9, 425.2, 285.1, 398.4 ]\n"
         "d400_color_optical_frame:\n   sensor_type: camera\n   fps: 30\n   width: 40\n"
         "   height: 24\n   model: pinhole\n   intrinsics: !!opencv-matrix\n      rows: 1\n"
         "      cols: 4\n      dt: d\n"
         "      data: [ 61.1, 20.3,\n          61.2, 11.9 ]\n"
         "   distortion_model: radial-tangential\n"
         "   distortion_coefficients: !!opencv-matrix\n      rows: 1\n      cols: 5\n      dt: d\n"
         "      data: [ 0., 0., 0., 0., 0. ]\n";
}

TEST_CASE(
    "a folder of OpenLORIS: aligned depth, the colour camera of its sensors, the robot's path",
    "[sources][folder][threads]") {
  const ScratchFolder folder("openloris");
  std::string colors = "#timestamp file\n", aligned;
  for (int n = 0; n < 3; ++n) {
    write_color(folder / "color" / number_name(n), 40, 24);
    write_steps(folder / "aligned_depth" / number_name(n), 2000, 40, 24);
    write_steps(folder / "depth" / number_name(n), 3000, 40, 24);
    colors += fmt::format("{:.6f} color/{}\n", 100 + 0.033 * n, number_name(n));
    aligned += fmt::format("{:.6f} aligned_depth/{}\n", 100.002 + 0.033 * n, number_name(n));
  }
  write_bytes(folder / "color.txt", colors);
  write_bytes(folder / "aligned_depth.txt", aligned);
  write_bytes(folder / "depth.txt", "100.0 depth/000000.png\n");
  write_bytes(folder / "sensors.yaml", openloris_sensors());
  // The camera looks forward, along the robot's x, 0.3 m in front of the laser, which is 0.2 m in
  // front of the robot's middle; rows may begin with a negative number.
  write_bytes(
      folder / "trans_matrix.yaml",
      "%YAML:1.0\n---\ntrans_matrix:\n   -\n      parent_frame: laser\n"
      "      child_frame: d400_color_optical_frame\n      matrix: !!opencv-matrix\n"
      "         rows: 4\n         cols: 4\n         dt: d\n"
      "         data: [ 0., 0., 1., 0.3,\n -1., 0., 0., 0.,\n 0., -1., 0., 0.4,\n"
      "             0., 0., 0., 1. ]\n   -\n      parent_frame: base_link\n"
      "      child_frame: laser\n      matrix: !!opencv-matrix\n         rows: 4\n"
      "         cols: 4\n         dt: d\n"
      "         data: [ 1., 0., 0., 0.2, 0., 1., 0., 0., 0., 0., 1., 0.1, 0., 0., 0., 1. ]\n");
  write_bytes(folder / "groundtruth.txt", "100.0 1 2 3 0 0 0 1\n100.033 1 2 3 0 0 1 0\n");
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  CHECK(recording.layout == "OpenLORIS");
  REQUIRE(recording.frames.size() == 3);
  const Rigid3& first = *recording.frames[0].world_from_camera;
  CHECK((first.translation() - Vector3d(1.5, 2, 3.5)).norm() < 1e-12);
  CHECK((first.linear() * Vector3d(0, 0, 1) - Vector3d(1, 0, 0)).norm() < 1e-12);
  // Half a turn about z: the camera is behind the robot's middle.
  CHECK((recording.frames[1].world_from_camera->translation() - Vector3d(0.5, 2, 3.5)).norm() <
        1e-12);
  CHECK_FALSE(recording.frames[2].world_from_camera);
  const auto source = value_or_throw(open_folder(folder.path()));
  CHECK(source->format().depth_camera == PinholeCamera{40, 24, 61.1, 61.2, 20.3, 11.9});
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 3) == 2.0F);
  CHECK(any_says(source->take_notes(), "1 mm, as known of recordings of OpenLORIS"));
  // Without the robot's transforms its path is not the camera's.
  fs::remove(folder / "trans_matrix.yaml");
  CHECK_FALSE(value_or_throw(recognise_folder(folder.path())).frames[0].world_from_camera);
  write_bytes(folder / "sensors.yaml", "%YAML:1.0\nd400_depth_optical_frame:\n   width: 40\n");
  CHECK(says(message_of(folder.path()), "sensors.yaml has no d400_color_optical_frame"));
  fs::remove(folder / "aligned_depth.txt");
  CHECK(says(message_of(folder.path()), "has no aligned_depth.txt"));
}

TEST_CASE("a folder of Bonn: TUM's layout and unit, its own published camera",
          "[sources][folder]") {
  const ScratchFolder root("bonn");
  const fs::path folder = root / "rgbd_bonn_balloon";
  write_color(folder / "rgb/1.png", 640, 480);
  write_steps(folder / "depth/1.png", 5000, 640, 480);
  write_bytes(folder / "rgb.txt", "1548266470.5 rgb/1.png\n");
  write_bytes(folder / "depth.txt", "1548266470.51 depth/1.png\n");
  const auto source = value_or_throw(open_folder(folder));
  CHECK(source->format().depth_camera ==
        PinholeCamera{640, 480, 542.822841, 542.576870, 315.593520, 237.756098});
  CHECK(source->format().depth_unit == 0.0002);
  CHECK(any_says(source->take_notes(), "those of rgbd_bonn are assumed"));
  // Numbers of TUM are not assumed for a recording of another name.
  fs::rename(folder, root / "balloon");
  CHECK(says(message_of(root / "balloon"), "has no intrinsics.txt"));
}

TEST_CASE("a depth image belongs to one colour image, the nearest", "[sources][folder]") {
  const ScratchFolder folder("one_to_one");
  std::string colors, depths;
  for (int n = 0; n < 21; ++n) {
    write_color(folder / "rgb" / number_name(n));
    colors += fmt::format("{:.3f} rgb/{}\n", 10 + 0.030 * n, number_name(n));
    // Each seventh is lost; the clock is 14 ms late, so that the one before is 16 ms away.
    if (n % 7 == 5) continue;
    write_steps(folder / "depth" / number_name(n), 1000 + n, kColorWidth, kColorHeight);
    depths += fmt::format("{:.3f} depth/{}\n", 10.014 + 0.030 * n, number_name(n));
  }
  write_bytes(folder / "rgb.txt", colors);
  write_bytes(folder / "depth.txt", depths);
  write_bytes(folder / "intrinsics.txt", "48 49 29.5 22\n");
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  CHECK(recording.frames.size() == 18);
  CHECK(recording.unmatched == 3);
  for (const RecordedFrame& frame : recording.frames) {
    CHECK(frame.first.filename() == frame.second.filename());
  }
}

TEST_CASE("lists, poses and intrinsics are read in any encoding of lines, not with decimal commas",
          "[sources][folder][encodings]") {
  const ScratchFolder folder("list_encodings");
  for (const char* kind : {"rgb", "depth"}) {
    for (int n = 0; n < 2; ++n) {
      const fs::path path = folder / kind / number_name(n);
      if (kind[0] == 'r')
        write_color(path, 60, 45);
      else
        write_steps(path, 5000, 60, 45);
    }
  }
  const auto write = [&](const char* end) {
    const auto text = [&](std::string lines) {
      std::string written = "\xef\xbb\xbf";
      for (const char c : lines) written += c == '\n' ? std::string(end) : std::string(1, c);
      return written;
    };
    write_bytes(folder / "rgb.txt", text("1.0 rgb/000000.png\n1.1 rgb/000001.png\n"));
    write_bytes(folder / "depth.txt", text("1.0\tdepth/000000.png\n1.1 depth/000001.png\n"));
    write_bytes(folder / "groundtruth.txt", text("1.0 1 2 3 0 0 0 1\n1.1 4 5 6 0 0 0 1\n"));
    write_bytes(folder / "intrinsics.txt", text("48 49 29.5 22\nunit_m 0.001\n"));
  };
  for (const char* end : {"\n", "\r\n", "\r"}) {
    write(end);
    const Recording recording = value_or_throw(recognise_folder(folder.path()));
    REQUIRE(recording.frames.size() == 2);
    CHECK(recording.unmatched == 0);
    CHECK(recording.frames[0].world_from_camera->translation() == Vector3d(1, 2, 3));
    CHECK(recording.frames[1].world_from_camera->translation() == Vector3d(4, 5, 6));
    const auto source = value_or_throw(open_folder(folder.path()));
    CHECK(source->format().depth_camera.fx_px == 48);
    CHECK(source->format().depth_unit == 0.001);
  }
  for (const auto& [file, text] : {std::pair{"rgb.txt", "1,0 rgb/000000.png\n1,1 rgb/000001.png\n"},
                                   std::pair{"groundtruth.txt", "1,0 1,5 2,5 3 0 0 0 1\n"},
                                   std::pair{"intrinsics.txt", "48,5 49,5 29,5 22,5\n"}}) {
    INFO(file);
    write("\n");
    write_bytes(folder / file, text);
    const std::string message = message_of(folder.path());
    CHECK(says(message, file));
    CHECK(says(message, "decimal commas"));
  }
}

TEST_CASE("a pose of 7-Scenes with decimal commas is refused, not left out",
          "[sources][folder][encodings]") {
  const ScratchFolder folder("scenes_commas");
  write_color(folder / "frame-000000.color.png");
  write_steps(folder / "frame-000000.depth.png", 1000, kColorWidth, kColorHeight);
  write_bytes(folder / "frame-000000.pose.txt", "1 0 0 0,5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  CHECK(says(message_of(folder.path()), "frame-000000.pose.txt has decimal commas"));
  write_bytes(folder / "frame-000000.pose.txt",
              "\xef\xbb\xbf"
              "1 0 0 0.5\r0 1 0 0\r0 0 1 0\r0 0 0 1\r");
  const Recording recording = value_or_throw(recognise_folder(folder.path()));
  CHECK(recording.frames[0].world_from_camera->translation() == Vector3d(0.5, 0, 0));
}

TEST_CASE("color/ or rgb/ with depth/ belong together by their numbers", "[sources][folder]") {
  const ScratchFolder root("rgb_depth_folders");
  for (const char* name : {"color", "rgb"}) {
    const fs::path folder = root / name;
    for (const int n : {2, 10, 1}) {
      write_color(folder / name / fmt::format("{}.jpg", n));
      if (n != 2) write_steps(folder / "depth" / fmt::format("{}.png", n), n);
    }
    write_bytes(folder / "intrinsics.txt", "48 49 29.5 22 60 45\n");
    const Recording recording = value_or_throw(recognise_folder(folder));
    REQUIRE(recording.frames.size() == 2);
    CHECK(recording.unmatched == 1);
    CHECK(recording.frames[0].second.filename() == "1.png");
    CHECK(recording.frames[1].second.filename() == "10.png");
    CHECK(open_folder(folder).ok());
  }
  write_color(root / "stamps/rgb/1000.png");
  write_steps(root / "stamps/depth/1012.png", 1000);
  CHECK(says(message_of(root / "stamps"), "write rgb.txt and depth.txt"));
}

}  // namespace
}  // namespace palpable
