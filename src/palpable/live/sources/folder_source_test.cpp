#include "palpable/live/sources/folder_source.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using test::write_bytes;

constexpr int kWidth = 40;
constexpr int kHeight = 24;

void write_image(const fs::path& path, int level, int width = kWidth, int height = kHeight) {
  fs::create_directories(path.parent_path());
  cv::imwrite(path.string(), cv::Mat(height, width, CV_8UC3, cv::Scalar(level, level, level)));
}

void write_depth(const fs::path& path, int millimetres) {
  cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(millimetres));
  depth.at<std::uint16_t>(0, 1) = 0;
  depth.at<std::uint16_t>(0, 2) = 65535;
  cv::imwrite(path.string(), depth);
}

StereoCalibration small_rig(int width = kWidth, int height = kHeight) {
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {width, height, 30, 30, 20, 12};
  calibration.rig.right_from_left.translation().x() = -0.06;
  calibration.frames_per_second = 20;
  return calibration;
}

// Brightness 10 i left, 10 i + 5 right; numbered without leading zeros.
void write_two_folders(const fs::path& folder, int count) {
  for (int i = 0; i < count; ++i) {
    write_image(folder / "left" / (std::to_string(i) + ".png"), 10 * i);
    write_image(folder / "right" / (std::to_string(i) + ".png"), 10 * i + 5);
  }
  write_stereo_calibration(folder / "calibration.yml", small_rig());
}

std::unique_ptr<FrameSource> opened(const fs::path& folder) {
  return value_or_throw(open_folder(folder));
}

// The message of a folder that cannot be opened.
std::string refusal(const fs::path& folder) {
  const auto result = open_folder(folder);
  REQUIRE_FALSE(result.ok());
  const std::string message = result.problem().message;
  CHECK(message.find(folder.string()) != std::string::npos);
  CHECK(message.find('\n') == std::string::npos);
  return message;
}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("pairs of two folders come in the order of their numbers, with their times",
          "[sources][folder][threads]") {
  const ScratchFolder folder("folder_two");
  write_two_folders(folder.path(), 12);
  const auto source = opened(folder.path());
  CHECK(source->frame_count() == 12);
  const FrameFormat& format = source->format();
  CHECK(format.kind == FrameFormat::Kind::kStereo);
  CHECK_FALSE(format.already_rectified);
  CHECK((format.width == kWidth && format.height == kHeight));
  CHECK(format.rig.left == small_rig().rig.left);
  Frame frame;
  for (int i = 0; i < 12; ++i) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.number == i);
    CHECK(frame.time == Approx(i / 20.0));
    CHECK(frame.left ==
          ColorImage(kWidth, kHeight,
                     Rgb{static_cast<std::uint8_t>(10 * i), static_cast<std::uint8_t>(10 * i),
                         static_cast<std::uint8_t>(10 * i)}));
    CHECK(frame.right(3, 2).g == 10 * i + 5);
    CHECK(frame.depth.empty());
  }
  CHECK(source->next(frame) == FrameStatus::kEnd);
  CHECK(source->next(frame) == FrameStatus::kEnd);
  CHECK(source->last_trouble().empty());
}

TEST_CASE("side by side, the left half is the left eye", "[sources][folder][threads]") {
  const ScratchFolder folder("folder_side");
  cv::Mat both(kHeight, 2 * kWidth, CV_8UC3, cv::Scalar(30, 30, 30));
  both.colRange(kWidth, 2 * kWidth).setTo(cv::Scalar(90, 90, 90));
  cv::imwrite((folder / "pair_1.png").string(), both);
  write_rectified_calibration(folder / "rectified.yml",
                              {{{kWidth, kHeight, 30, 30, 20, 12}, 0.06, -2}, 30});
  const auto source = opened(folder.path());
  CHECK(source->format().already_rectified);
  CHECK(source->format().rectified.disparity_at_infinity_px == -2);
  CHECK(source->format().width == kWidth);
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.left == ColorImage(kWidth, kHeight, Rgb{30, 30, 30}));
  CHECK(frame.right == ColorImage(kWidth, kHeight, Rgb{90, 90, 90}));
}

TEST_CASE("colour and depth come in metres, 0 and 65535 as unknown", "[sources][folder][threads]") {
  for (const auto& [intrinsics, unit] :
       {std::pair{"# fx fy cx cy\n30.5 31 20 12\n", 0.001F},
        std::pair{"30.5 31\n20 12  40 24 0.000125 # Kinect-like\n", 0.000125F}}) {
    const ScratchFolder folder("folder_depth");
    for (int i = 0; i < 3; ++i) {
      write_image(folder / ("color_" + std::to_string(i) + ".png"), 50 + i);
      write_depth(folder / ("depth_" + std::to_string(i) + ".png"), 500 + i);
    }
    write_bytes(folder / "intrinsics.txt", intrinsics);
    const auto source = opened(folder.path());
    CHECK(source->format().kind == FrameFormat::Kind::kColorDepth);
    CHECK(source->format().depth_camera == PinholeCamera{kWidth, kHeight, 30.5, 31, 20, 12});
    Frame frame;
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.left(0, 0).r == 51);
    CHECK(frame.right.empty());
    CHECK(frame.depth(5, 5) == 501 * unit);
    CHECK(std::isnan(frame.depth(1, 0)));
    CHECK(std::isnan(frame.depth(2, 0)));
  }
}

TEST_CASE("the unit of depth images is the user's, the file's, or assumed and said",
          "[sources][folder][depth_unit]") {
  const ScratchFolder folder("folder_depth_unit");
  write_image(folder / "color_0.png", 50);
  write_depth(folder / "depth_0.png", 500);
  write_bytes(folder / "intrinsics.txt", "30 30 20 12\n");
  const auto first_depth = [](FrameSource& source) {
    Frame frame;
    CHECK(source.next(frame) == FrameStatus::kFrame);
    return frame.depth(5, 5);
  };
  const auto assumed = opened(folder.path());
  CHECK(first_depth(*assumed) == 0.5F);
  CHECK(assumed->format().depth_unit == 1e-3);
  CHECK(assumed->format().depth_unit_assumed);
  const std::vector<std::string> notes = assumed->take_notes();
  REQUIRE(notes.size() == 1);
  CHECK(contains(notes[0], "nothing states the unit"));
  CHECK(assumed->take_notes().empty());

  const auto asked = value_or_throw(open_folder(folder.path(), {.depth_unit = 2e-4}));
  CHECK(first_depth(*asked) == 500 * 2e-4F);
  CHECK_FALSE(asked->format().depth_unit_assumed);
  CHECK(asked->take_notes().empty());
  write_bytes(folder / "intrinsics.txt", "30 30 20 12\nunit_m 0.0001\n");
  const auto stated = opened(folder.path());
  CHECK(first_depth(*stated) == 500 * 1e-4F);
  CHECK(stated->take_notes().empty());
  CHECK(first_depth(*value_or_throw(open_folder(folder.path(), {.depth_unit = 2e-4}))) ==
        500 * 2e-4F);
}

TEST_CASE("an unreadable image in the middle is skipped and counted, and its neighbours are whole",
          "[sources][folder][threads][refusal]") {
  const ScratchFolder folder("folder_unreadable");
  write_two_folders(folder.path(), 7);
  write_bytes(folder / "left/1.png", "garbage");
  write_bytes(folder / "right/3.png", test::file_bytes(folder / "right/3.png").substr(0, 60));
  write_bytes(folder / "left/4.png", "");
  write_image(folder / "right/5.png", 55, kWidth + 1);
  const auto source = opened(folder.path());
  CHECK(source->frame_count() == 7);
  Frame frame;
  std::vector<int> read;
  std::vector<int> unreadable;
  for (;;) {
    const FrameStatus status = source->next(frame);
    if (status == FrameStatus::kEnd) break;
    (status == FrameStatus::kFrame ? read : unreadable).push_back(frame.number);
    if (status == FrameStatus::kUnreadable && frame.number == 1) {
      CHECK(contains(source->last_trouble(), "left/1.png"));
    }
    if (status == FrameStatus::kFrame) CHECK(frame.right(0, 0).r == 10 * frame.number + 5);
  }
  CHECK(read == std::vector<int>{0, 2, 6});
  CHECK(unreadable == std::vector<int>{1, 3, 4, 5});
  CHECK(contains(source->last_trouble(), "right/5.png is 41 x 24 px; the others are 40 x 24"));
}

TEST_CASE("an unreadable first image does not close the folder", "[sources][folder][threads]") {
  const ScratchFolder folder("folder_first");
  write_two_folders(folder.path(), 3);
  write_bytes(folder / "left/0.png", "garbage");
  const auto source = opened(folder.path());
  Frame frame;
  CHECK(source->next(frame) == FrameStatus::kUnreadable);
  CHECK(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.number == 1);
}

TEST_CASE("a source may be closed at any time", "[sources][folder][threads]") {
  const ScratchFolder folder("folder_closed");
  write_two_folders(folder.path(), 5);
  for (int read = 0; read < 5; ++read) {
    const auto source = opened(folder.path());
    Frame frame;
    for (int i = 0; i < read; ++i) CHECK(source->next(frame) == FrameStatus::kFrame);
  }
}

TEST_CASE("a folder that cannot be used says why and what to do", "[sources][folder][refusal]") {
  const ScratchFolder root("folder_refusals");
  CHECK(contains(refusal(root / "nowhere"), "no folder"));
  write_bytes(root / "file", "x");
  CHECK(contains(refusal(root / "file"), "not a folder"));
  fs::create_directories(root / "empty");
  CHECK(contains(refusal(root / "empty"), "no images in a layout that is known. Read are: left/"));
  fs::create_directories(root / "empty_eyes/left");
  CHECK(contains(refusal(root / "empty_eyes"), "no images in left/ and right/"));

  write_two_folders(root / "unequal", 5);
  fs::remove(root / "unequal/right/2.png");
  CHECK(contains(refusal(root / "unequal"), "5 left and 4 right"));
  write_two_folders(root / "one_eye", 2);
  fs::remove_all(root / "one_eye/right");
  CHECK(contains(refusal(root / "one_eye"), "2 left and 0 right"));

  write_two_folders(root / "uncalibrated", 2);
  fs::remove(root / "uncalibrated/calibration.yml");
  CHECK(contains(refusal(root / "uncalibrated"), "no calibration: put calibration.yml"));
  write_bytes(root / "uncalibrated/calibration.yml", "%YAML:1.0\n---\nimage_width: 40\n");
  CHECK(contains(refusal(root / "uncalibrated"), "calibration.yml has no number 'image_height'"));
  write_rectified_calibration(root / "uncalibrated/rectified.yml",
                              {{{kWidth, kHeight, 30, 30, 20, 12}, 0.06, 0}, 30});
  CHECK(contains(refusal(root / "uncalibrated"), "both calibration.yml and rectified.yml"));

  write_two_folders(root / "other_size", 2);
  write_stereo_calibration(root / "other_size/calibration.yml", small_rig(80, 48));
  const std::string size = refusal(root / "other_size");
  CHECK(contains(size, "80 x 48"));
  CHECK(contains(size, "40 x 24"));
  CHECK(contains(size, "calibrate"));

  write_image(root / "single/a.png", 1);
  write_stereo_calibration(root / "single/calibration.yml", small_rig());
  CHECK(contains(refusal(root / "single"), "was not recognised: a.png is 40 x 24"));
  CHECK(contains(refusal(root / "single"), "imL and imR"));
  const auto alone = open_patterns(root / "single/a.png", "", false);
  REQUIRE_FALSE(alone.ok());
  CHECK(contains(alone.problem().message, "name the other eye's with --right"));

  // Colour images with depth files in another program's format.
  write_image(root / "npz/rgb_0.png", 1);
  write_bytes(root / "npz/depth_0.npz", "PK");
  CHECK(contains(refusal(root / "npz"), "was not recognised: rgb_0.png is 40 x 24"));
  CHECK(contains(refusal(root / "npz"), "depth_* (16-bit images)"));

  write_two_folders(root / "garbage", 2);
  for (const char* name : {"0.png", "1.png"}) write_bytes(root / "garbage/left" / name, "x");
  CHECK(contains(refusal(root / "garbage"), "none of the 2 images"));
  CHECK(contains(refusal(root / "garbage"), "0.png is no image"));
}

TEST_CASE("a colour and depth folder that cannot be used says why", "[sources][folder][refusal]") {
  const ScratchFolder root("folder_depth_refusals");
  const fs::path folder = root / "d";
  write_image(folder / "color_0.png", 1);
  write_depth(folder / "depth_0.png", 500);
  CHECK(contains(refusal(folder), "no intrinsics.txt"));
  for (const char* text : {"", "1 2 3", "a b c d", "275 275 160 120 5", "275 275 nan 120",
                           "1 2 3 4 5 6 7 8", "275x 275 160 120"}) {
    INFO(text);
    write_bytes(folder / "intrinsics.txt", text);
    CHECK(contains(refusal(folder), "should have the numbers"));
  }
  write_bytes(folder / "intrinsics.txt", "-275 275 160 120");
  CHECK(contains(refusal(folder), "positive"));
  write_bytes(folder / "intrinsics.txt", "275 275 160 120 320 240");
  const std::string size = refusal(folder);
  CHECK(contains(size, "320 x 240"));
  CHECK(contains(size, "40 x 24"));
  write_bytes(folder / "intrinsics.txt", "27 27 20 12 40 24 1000");
  CHECK(contains(refusal(folder), "0.001"));
  write_bytes(folder / "intrinsics.txt", "27 27 20 12");
  cv::imwrite((folder / "depth_0.png").string(), cv::Mat(15, 20, CV_16UC1, cv::Scalar(500)));
  const std::string smaller = refusal(folder);
  CHECK(contains(smaller, "depth_0.png is 20 x 15 px"));
  CHECK(contains(smaller, "no two sizes of one view"));
  write_depth(folder / "depth_0.png", 500);
  write_two_folders(root / "stereo", 2);
  const auto stereo = open_folder(root / "stereo", {.depth_unit = 1e-3});
  REQUIRE_FALSE(stereo.ok());
  CHECK(contains(stereo.problem().message, "--depth-unit is of depth images"));
  write_image(folder / "color_1.png", 1);
  CHECK(contains(refusal(folder), "2 colour and 1 depth"));
}

}  // namespace
}  // namespace palpable
