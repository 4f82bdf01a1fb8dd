#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/exported_calibration.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/recording_file.h"
#include "palpable/live/sources/source_calibration.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/recording_bytes.h"
#include "tests/support/scratch_folder.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <array>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64, kHeight = 48;
constexpr int kMostFrames = 50;

StereoCalibration some_calibration() {
  StereoCalibration calibration;
  calibration.rig.left = {{kWidth, kHeight, 50, 50.5, 32, 24}, {-0.05, 0.01, 1e-4, -2e-4, 0}};
  calibration.rig.right = {{kWidth, kHeight, 50.2, 50.1, 31.5, 24.5}, {-0.04, 0.01, 0, 0, 0}};
  calibration.rig.right_from_left.translation() << -0.06, 1e-4, -1e-4;
  return calibration;
}

void write_image(const fs::path& path, int type = CV_8UC3) {
  cv::Mat image(kHeight, kWidth, type);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (type == CV_16UC1) image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(500 + 7 * x);
      if (type == CV_8UC3)
        image.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<unsigned char>((x * y) % 256));
    }
  }
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), image);
}

// Opens the folder and plays it. Returns the messages about the source or one of its frames.
std::string play(const std::string& source) {
  CameraRequest request;
  request.device = source;
  return said(open_source(request), [](const std::unique_ptr<FrameSource>& frames) {
    Frame frame;
    for (int i = 0; i < kMostFrames; ++i) {
      if (frames->next(frame) == FrameStatus::kEnd) break;
      (void)frames->last_trouble();
    }
  });
}

std::string play_folder(const fs::path& folder, const fs::path& /*file*/) {
  return play(folder.string());
}

std::vector<std::string> write_pairs(const fs::path& folder) {
  for (const char* name : {"0.png", "1.jpg", "2.ppm", "3.bmp", "4.tiff"}) {
    write_image(folder / "left" / name);
    write_image(folder / "right" / name);
  }
  write_stereo_calibration(folder / "calibration.yml", some_calibration());
  return {"left/0.png",  "left/1.jpg",  "left/2.ppm",     "right/3.bmp",
          "left/4.tiff", "right/1.jpg", "calibration.yml"};
}

const std::string kSensor =
    "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, {},\n"
    "         0.0, 1.0, 0.0, 0.0,\n         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
    "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\n"
    "intrinsics: [50.5, 50.2, 32.0, 24.0]\ndistortion_model: radial-tangential\n"
    "distortion_coefficients: [-0.05, 0.01, 0.0001, 0.0]\n";

std::vector<std::string> write_euroc(const fs::path& folder) {
  for (const char* name : {"1403636579763555584.png", "1403636579813555456.png"}) {
    write_image(folder / "mav0/cam0/data" / name);
    write_image(folder / "mav0/cam1/data" / name);
  }
  test::write_bytes(folder / "mav0/cam0/sensor.yaml", fmt::format(fmt::runtime(kSensor), 0.0));
  test::write_bytes(folder / "mav0/cam1/sensor.yaml", fmt::format(fmt::runtime(kSensor), 0.06));
  test::write_bytes(folder / "mav0/state_groundtruth_estimate0/data.csv",
                    "#timestamp, p_RS_R_x [m]\n1403636579758555392,1,2,3,1,0,0,0,0,0,0\n"
                    "1403636579863555500,4,5,6,0.70710678,0,0,0.70710678,0,0,0\n");
  return {"mav0/cam0/sensor.yaml", "mav0/cam1/sensor.yaml",
          "mav0/state_groundtruth_estimate0/data.csv"};
}

std::vector<std::string> write_kitti(const fs::path& folder) {
  for (const char* name : {"000000.png", "000001.png"}) {
    write_image(folder / "image_2" / name);
    write_image(folder / "image_3" / name);
  }
  test::write_bytes(folder / "calib.txt",
                    "P0: 50 0 32 0 0 50 24 0 0 0 1 0\nP1: 50 0 32 -16.2 0 50 24 0 0 0 1 0\n"
                    "P2: 50 0 32 1.8 0 50 24 0 0 0 1 0\nP3: 50 0 32.5 -14.1 0 50 24 0 0 0 1 0\n");
  test::write_bytes(folder / "times.txt", "0.5\n0.6e0\n");
  test::write_bytes(folder / "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 7 0 1 0 0 0 0 1 2\n");
  return {"calib.txt", "times.txt", "poses.txt"};
}

std::vector<std::string> write_tum(const fs::path& folder) {
  for (const char* name : {"a.png", "b.png"}) {
    write_image(folder / "rgb" / name);
    write_image(folder / "depth" / name, CV_16UC1);
  }
  test::write_bytes(folder / "rgb.txt",
                    "# color images\n1311868164.36 rgb/a.png\n1311868164.40 rgb/b.png\n");
  test::write_bytes(folder / "depth.txt", "1311868164.37 depth/a.png\n1311868164.41 depth/b.png\n");
  test::write_bytes(folder / "groundtruth.txt", "1311868164.36 1 2 3 0 0 0 1\n");
  test::write_bytes(folder / "intrinsics.txt",
                    "50 51 32 24 64 48 0.0002\ncolor 52 52 32 24 1 0 0 0.02 0 1 0 0 0 0 1 0\n");
  return {"rgb.txt", "depth.txt", "groundtruth.txt", "intrinsics.txt", "depth/a.png"};
}

std::vector<std::string> write_scenes(const fs::path& folder) {
  for (const char* frame : {"frame-000000", "frame-000001"}) {
    write_image(folder / fmt::format("{}.color.png", frame));
    write_image(folder / fmt::format("{}.depth.png", frame), CV_16UC1);
    test::write_bytes(folder / fmt::format("{}.pose.txt", frame),
                      "1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  }
  test::write_bytes(folder / "intrinsics.txt", "50 0 32\n0 50 24\n0 0 1\n");
  return {"frame-000000.pose.txt", "intrinsics.txt"};
}

std::vector<std::string> write_openloris(const fs::path& folder) {
  for (const char* name : {"a.png", "b.png"}) {
    write_image(folder / "color" / name);
    write_image(folder / "aligned_depth" / name, CV_16UC1);
  }
  test::write_bytes(folder / "color.txt", "1.0 color/a.png\n1.1 color/b.png\n");
  test::write_bytes(folder / "aligned_depth.txt",
                    "1.0 aligned_depth/a.png\n1.1 aligned_depth/b.png\n");
  test::write_bytes(folder / "groundtruth.txt", "1.0 1 2 3 0 0 0 1\n");
  test::write_bytes(folder / "sensors.yaml",
                    "%YAML:1.0\nd400_color_optical_frame:\n   fps: 30\n   width: 64\n"
                    "   height: 48\n   intrinsics: !!opencv-matrix\n      rows: 1\n"
                    "      data: [ 61., 32., 61., 24. ]\n");
  test::write_bytes(folder / "trans_matrix.yaml",
                    "%YAML:1.0\ntrans_matrix:\n   -\n      parent_frame: base_link\n"
                    "      child_frame: d400_color_optical_frame\n      matrix: !!opencv-matrix\n"
                    "         data: [ 0., 0., 1., 0.3, -1., 0., 0., 0., 0., -1., 0., 0.4,\n"
                    "             0., 0., 0., 1. ]\n");
  return {"color.txt", "aligned_depth.txt", "sensors.yaml", "trans_matrix.yaml"};
}

std::vector<std::string> write_stray(const fs::path& folder) {
  fs::create_directories(folder);
  cv::VideoWriter out((folder / "rgb.mp4").string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                      10, cv::Size(2 * kWidth, 2 * kHeight));
  for (int f = 0; f < 3; ++f)
    out.write(cv::Mat(2 * kHeight, 2 * kWidth, CV_8UC3, cv::Scalar::all(40 * f)));
  out.release();
  for (const char* name : {"000000.png", "000001.png", "000002.png"}) {
    write_image(folder / "depth" / name, CV_16UC1);
    fs::create_directories(folder / "confidence");
    cv::imwrite((folder / "confidence" / name).string(),
                cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(2)));
  }
  test::write_bytes(folder / "camera_matrix.csv", "100.0,0.0,64.0\n0.0,100.0,48.0\n0,0,1\n");
  test::write_bytes(folder / "odometry.csv",
                    "timestamp, frame, x, y, z, qx, qy, qz, qw\n"
                    "5.0, 000000, 0, 0, 0, 0, 0, 0, 1\n5.1, 000001, 0, 0, 0, 0, 0, 0, 1\n"
                    "5.2, 000002, 0, 0, 0, 0, 0, 0, 1\n");
  return {"rgb.mp4", "camera_matrix.csv", "odometry.csv", "depth/000001.png",
          "confidence/000001.png"};
}

std::vector<std::string> write_record3d(const fs::path& folder) {
  for (const char* name : {"0", "1"}) {
    write_image(folder / "rgb" / fmt::format("{}.jpg", name));
    const fs::path depth = folder / "depth" / fmt::format("{}.exr", name);
    fs::create_directories(depth.parent_path());
    cv::imwrite(depth.string(), cv::Mat(kHeight / 2, kWidth / 2, CV_32FC1, cv::Scalar(0.75)));
  }
  test::write_bytes(folder / "metadata.json",
                    R"({"w":64,"h":48,"fps":30,"K":[50,0,0,0,50,0,32,24,1],)"
                    R"("perFrameIntrinsicCoeffs":[[50,50,32,24],[51,51,32,24]],)"
                    R"("frameTimestamps":[1,2],"poses":[[0,0,0,1,0,0,0],[0,0,0,1,0,0,0]]})");
  return {"metadata.json", "depth/0.exr", "depth/1.exr"};
}

const std::string kFactory =
    "[LEFT_CAM_HD]\nfx=700\nfy=701\ncx=640\ncy=360\nk1=-0.17\nk2=0.027\n"
    "[RIGHT_CAM_HD]\nfx=699\nfy=700\ncx=641\ncy=361\nk1=-0.17\nk2=0.027\np1=0.0001\n"
    "[STEREO]\nBaseline=63.5\nTY=0.1\nCV_HD=0.02\nRX_HD=0\nRZ_HD=0\n";

const std::string kCamchain =
    "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.05, 0.01, 0.0001, -0.0002]\n"
    "  distortion_model: radtan\n  intrinsics: [50.0, 50.5, 32.0, 24.0]\n"
    "  resolution: [64, 48]\ncam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.063]\n"
    "  - [0.0, 1.0, 0.0, 0.001]\n  - [0.0, 0.0, 1.0, -0.0005]\n  - [0.0, 0.0, 0.0, 1.0]\n"
    "  camera_model: pinhole\n  distortion_coeffs: [-0.04, 0.02, 0.0, 0.0001]\n"
    "  distortion_model: radtan\n  intrinsics: [50.2, 50.3, 31.5, 24.5]\n"
    "  resolution: [64, 48]\n";

const std::string kRealsense =
    R"({"baseline": "-49.9496", "rectified.0.fx": "50.5", "rectified.0.fy": "50.5",
 "rectified.0.ppx": "32.5", "rectified.0.ppy": "24.5", "rectified.0.width": "64",
 "rectified.0.height": "48", "rectified.1.width": "0"})";

// Each pair has a folder of its own: among several files no other half is chosen.
std::vector<std::string> write_foreign_calibrations(const fs::path& folder) {
  for (const char* name : {"opencv", "ros"}) {
    fs::create_directories(folder / name);
    export_calibration(folder / name, some_calibration().rig);
  }
  for (const char* name :
       {"ros/intrinsics.yml", "ros/extrinsics.yml", "opencv/left.yaml", "opencv/right.yaml"}) {
    fs::remove(folder / name);
  }
  fs::create_directories(folder / "one");
  test::write_bytes(folder / "one/camchain.yaml", kCamchain);
  test::write_bytes(folder / "one/rs.json", kRealsense);
  const std::string eye =
      "Width: \t64\n  Height: \t48\n  PPX: \t32.5\n  PPY: \t24.5\n  Fx: \t50.5\n  Fy: 50.5\n"
      "  Distortion: Brown Conrady\n  Coeffs: 0 0 0 0 0\n";
  std::string listing;
  for (const char* stream : {"Depth", "Infrared 1", "Infrared 2"}) {
    listing += fmt::format(" Intrinsic of \"{}\" / 64x48 / {{Y8}}\n  {}", stream, eye);
  }
  listing +=
      "Extrinsic from \"Infrared 1\" To \"Infrared 2\" :\n Rotation Matrix:\n 1 0 0\n 0 1 0\n"
      " 0 0 1\n Translation Vector: -0.05 0 0\n";
  test::write_bytes(folder / "one/rs.txt", listing);
  test::write_bytes(folder / "one/camera.json",
                    "{\"width\": 64, \"height\": 48, \"ppx\": 32.5, \"ppy\": 24.5, \"fx\": 50, "
                    "\"fy\": 50, \"coeffs\": [0, 0, 0, 0, 0]}");
  std::string xml = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
  for (const char* entry :
       {"M1>50. 0. 32. 0. 50. 24. 0. 0. 1.", "M2>50. 0. 32. 0. 50. 24. 0. 0. 1.", "D1>0. 0. 0. 0.",
        "D2>0. 0. 0. 0.", "R>1. 0. 0. 0. 1. 0. 0. 0. 1.", "T>-0.06 0. 0."}) {
    const std::string text = entry, name = text.substr(0, text.find('>'));
    xml += fmt::format("<{0} type_id=\"opencv-matrix\"><dt>d</dt><data>\n{1}</data></{0}>\n", name,
                       text.substr(name.size() + 1));
  }
  test::write_bytes(folder / "one/rig.xml", xml + "</opencv_storage>\n");
  return {"opencv/intrinsics.yml",
          "opencv/extrinsics.yml",
          "ros/left.yaml",
          "ros/right.yaml",
          "one/camchain.yaml",
          "one/rs.json",
          "one/rs.txt",
          "one/camera.json",
          "one/rig.xml"};
}

std::string read_foreign(const fs::path& /*folder*/, const fs::path& file) {
  (void)read_source_calibration(file, 64, 48, FrameFormat::Kind::kColorDepth);
  return said(read_source_calibration(file, 64, 48), [](const SourceCalibration&) {});
}

std::vector<std::string> write_calibrations(const fs::path& folder) {
  write_stereo_calibration(folder / "stereo.yml", some_calibration());
  write_rectified_calibration(folder / "rectified.yml",
                              {{{kWidth, kHeight, 50, 50, 32, 24}, 0.1, 2}, 25});
  test::write_bytes(folder / "SN1.conf", kFactory);
  test::write_bytes(folder / "intrinsics.txt",
                    "475 476 320 240 640 480 0.001\ncolor 600 601 322 243\n");
  return {"stereo.yml", "rectified.yml", "SN1.conf", "intrinsics.txt"};
}

std::string read_calibration(const fs::path& /*folder*/, const fs::path& file) {
  return said(read_source_calibration(file, 0, 0), [](const SourceCalibration&) {});
}

std::vector<std::string> write_video(const fs::path& folder) {
  for (const auto& [name, codec] :
       {std::pair{"clip.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G')},
        {"film.mp4", cv::VideoWriter::fourcc('m', 'p', '4', 'v')}}) {
    cv::VideoWriter out((folder / name).string(), codec, 10, cv::Size(2 * kWidth, kHeight));
    for (int f = 0; f < 5; ++f)
      out.write(cv::Mat(kHeight, 2 * kWidth, CV_8UC3, cv::Scalar::all(40 * f)));
  }
  write_stereo_calibration(folder / "calibration.yml", some_calibration());
  return {"clip.avi", "film.mp4"};
}

std::string play_video(const fs::path& /*folder*/, const fs::path& file) {
  return play(file.string());
}

std::vector<std::string> write_recording(const fs::path& folder) {
  const FrameFormat format = format_of(some_calibration().rig);
  RecordingWriter writer(folder / "a.palprec", format, {{"who", "a test"}});
  Frame frame;
  for (int n = 0; n < 3; ++n) {
    frame.number = n;
    frame.time = n / 30.0;
    frame.left = ColorImage(kWidth, kHeight, Rgb{10, 20, static_cast<std::uint8_t>(n)});
    frame.right = frame.left;
    writer.add_frame(frame, n == 0 ? std::nullopt : std::optional(1.0 * n));
    writer.add_refinement({true, Eigen::Matrix3Xf::Constant(3, 4, 0.1F)});
    writer.add_state({n, 17, "{}\n"});
  }
  writer.add_unreadable(3, "torn");
  writer.add_silence(SourceState::kGone, "unplugged");
  writer.add_frame(frame, {});
  writer.finish();
  return {"a.palprec"};
}

std::string play_recording(const fs::path& /*folder*/, const fs::path& file) {
  if (Result<RecordedRefinements> refined = RecordedRefinements::open(file); refined.ok()) {
    RecordedRefinement refinement;
    for (int n = -1; n < 5; ++n) refined.value().read(n, refinement);
  }
  const std::string read = said(read_recording(file), [](const RecordingContents&) {});
  return read.empty() ? play(file.string()) : read;
}

// Damages a recording and corrects the checksums of its chunks.
std::string spoilt_recording(const std::string& bytes, Random& random) {
  const std::vector<std::string> relatives{bytes};
  return test::with_right_checksums(mutated(bytes, relatives, random));
}

// A picture as sent by a camera. The device has no file, so that the message names this one.
std::string convert_picture(const fs::path& /*folder*/, const fs::path& file) {
  const std::string bytes = test::file_bytes(file);
  RawPicture raw;
  raw.format = four_letters("MJPG");
  raw.width = kWidth;
  raw.height = kHeight;
  raw.data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  raw.size = bytes.size();
  ColorImage image;
  const std::string why = to_color(raw, image);
  return why.empty() ? why : fmt::format("{}: {}", file.string(), why);
}

}  // namespace

void add_source_readers(std::vector<FuzzReader>& readers) {
  readers.push_back(
      {.name = "source.calibration", .write = write_calibrations, .read = read_calibration});
  readers.push_back(
      {.name = "source.foreign", .write = write_foreign_calibrations, .read = read_foreign});
  const auto add = [&](const char* name, auto write) {
    readers.push_back({.name = name, .write = write, .read = play_folder, .names_folder = true});
  };
  add("source.pairs", write_pairs);
  add("source.euroc", write_euroc);
  add("source.kitti", write_kitti);
  add("source.tum", write_tum);
  add("source.scenes", write_scenes);
  add("source.openloris", write_openloris);
  add("source.stray", write_stray);
  add("source.record3d", write_record3d);
  readers.push_back({.name = "camera.jpeg",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       write_image(folder / "frame.jpg");
                       return {"frame.jpg"};
                     },
                     .read = convert_picture});
  readers.push_back({.name = "recording.file", .write = write_recording, .read = play_recording});
  readers.push_back({.name = "recording.values",
                     .write = write_recording,
                     .read = play_recording,
                     .mutate = spoilt_recording});
  readers.push_back({.name = "source.video", .write = write_video, .read = play_video});
}

}  // namespace palpable::fuzz
