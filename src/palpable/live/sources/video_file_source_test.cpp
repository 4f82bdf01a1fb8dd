#include "palpable/live/sources/video_file_source.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/open_source.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// Motion JPEG in AVI by OpenCV's own writer, which does not need FFmpeg. Brightness base + 8 i.
void write_video(const fs::path& path, int width, int frames, int base, int step_at = -1) {
  fs::create_directories(path.parent_path());
  cv::VideoWriter writer(path.string(), cv::CAP_OPENCV_MJPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20, cv::Size(width, kHeight));
  REQUIRE(writer.isOpened());
  for (int i = 0; i < frames; ++i) {
    cv::Mat image(kHeight, width, CV_8UC3, cv::Scalar::all(base + 8 * i));
    if (step_at > 0) image.colRange(step_at, width).setTo(cv::Scalar::all(base + 8 * i + 100));
    writer.write(image);
  }
}

void write_rig(const fs::path& path) {
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 60, 60, 32, 24};
  calibration.rig.right_from_left.translation().x() = -0.06;
  write_stereo_calibration(path, calibration);
}

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("a video of both eyes, or a file for each, gives every frame with its time",
          "[sources][video][threads]") {
  const ScratchFolder folder("video");
  write_video(folder / "both.avi", 2 * kWidth, 6, 10, kWidth);
  write_video(folder / "l.avi", kWidth, 6, 10);
  write_video(folder / "r.avi", kWidth, 6, 110);
  write_rig(folder / "both.yml");
  CHECK(is_video_name("clip.MP4"));
  CHECK_FALSE(is_video_name("clip"));
  for (const bool two : {false, true}) {
    INFO((two ? "two files" : "side by side"));
    const auto source = value_or_throw(
        two ? open_video(folder / "l.avi", folder / "r.avi", {folder / "both.yml", false})
            : open_video(folder / "both.avi", ""));
    CHECK(source->frame_count() == 6);
    CHECK_FALSE(source->is_live());
    CHECK(source->format().width == kWidth);
    CHECK(source->format().rig.left.pinhole.fx_px == 60);
    Frame frame;
    for (int i = 0; i < 6; ++i) {
      REQUIRE(source->next(frame) == FrameStatus::kFrame);
      CHECK(frame.number == i);
      CHECK(frame.time == Approx(i / 20.0));
      const int loss = 4;  // JPEG's loss
      CHECK(std::abs(frame.left(20, 20).g - (10 + 8 * i)) <= loss);
      CHECK(std::abs(frame.right(20, 20).g - (110 + 8 * i)) <= loss);
    }
    CHECK(source->next(frame) == FrameStatus::kEnd);
    CHECK(source->next(frame) == FrameStatus::kEnd);
  }
}

TEST_CASE("a video that is cut off ends there, and one that is none is refused",
          "[sources][video][refusal]") {
  const ScratchFolder folder("video_refusals");
  write_video(folder / "both.avi", 2 * kWidth, 20, 10);
  write_video(folder / "one.avi", kWidth, 3, 10);
  const auto refusal = [](const fs::path& left, const fs::path& right,
                          const VideoSettings& settings) {
    const auto result = open_video(left, right, settings);
    REQUIRE_FALSE(result.ok());
    CHECK(contains(result.problem().message, left.string()));
    CHECK(result.problem().message.find('\n') == std::string::npos);
    return result.problem().message;
  };
  CHECK(contains(refusal(folder / "none.avi", "", {}), "does not exist"));
  test::write_bytes(folder / "x.avi", "RIFF this is no video");
  CHECK(contains(refusal(folder / "x.avi", "", {}), "no video that can be decoded"));
  CHECK(contains(refusal(folder / "both.avi", "", {}), "put both.yml beside it"));
  CHECK(contains(refusal(folder / "one.avi", "", {}), "no pair side by side"));
  CHECK(contains(refusal(folder / "one.avi", folder / "both.avi", {}), "should be equal"));
  write_rectified_calibration(folder / "small.yml", {{{32, 24, 30, 30, 16, 12}, 0.06, 0}, 30});
  CHECK(
      contains(refusal(folder / "both.avi", "", {folder / "small.yml", false}), "eyes of 32 x 24"));

  const std::string bytes = test::file_bytes(folder / "both.avi");
  test::write_bytes(folder / "cut.avi", bytes.substr(0, bytes.size() / 2));
  const auto cut = open_video(folder / "cut.avi", "", {{}, true});
  if (!cut.ok()) return;  // a reader may need the index at the end
  Frame frame;
  int frames = 0;
  while (cut.value()->next(frame) == FrameStatus::kFrame) ++frames;
  CHECK(frames < 20);
}

TEST_CASE("a calibration says whether a video shows both eyes, whatever its aspect",
          "[sources][video]") {
  const ScratchFolder folder("video_aspect");
  // Two eyes of 40 x 48 px: 1.67 times as wide as high.
  write_video(folder / "both.avi", 80, 3, 10, 40);
  write_rectified_calibration(folder / "narrow.yml", {{{40, 48, 60, 60, 20, 24}, 0.06, 0}, 30});
  const auto open = [&](const char* calibration) {
    return open_video(folder / "both.avi", "", {.calibration = folder / calibration});
  };
  const auto source = value_or_throw(open("narrow.yml"));
  CHECK(source->format().width == 40);
  Frame frame;
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.left.width() == 40);
  CHECK(frame.right(5, 5).r > frame.left(5, 5).r + 50);
  CHECK(source->take_notes().empty());
  // Beside the video it counts as well.
  std::filesystem::copy_file(folder / "narrow.yml", folder / "both.yml");
  CHECK(open_video(folder / "both.avi", "").ok());

  const auto message = [](const auto& result) {
    REQUIRE_FALSE(result.ok());
    return result.problem().message;
  };
  // One eye's picture: its calibration says so, also where the aspect is that of two.
  write_video(folder / "street.avi", 120, 3, 10);
  write_rectified_calibration(folder / "street.yml", {{{120, 48, 60, 60, 60, 24}, 0.54, 0}, 30});
  CHECK(contains(message(open_video(folder / "street.avi", "")), "name the other eye's file"));
  CHECK(contains(message(open_video(folder / "street.avi", "")), "for eyes of 120 x 48 px"));
  // Without one the aspect decides, and that is said.
  const auto guessed = value_or_throw(open_video(folder / "street.avi", "", {{}, true}));
  CHECK(guessed->format().width == 60);
  CHECK(contains(guessed->take_notes().at(0), "taken for both eyes side by side"));
  CHECK(contains(message(open_video(folder / "both.avi", "", {{}, true})), "no pair side by side"));
  // Of two files beside a video neither is picked.
  write_video(folder / "other/clip.avi", 80, 3, 10, 40);
  for (const char* name : {"other/calibration.yml", "other/rectified.yml"}) {
    std::filesystem::copy_file(folder / "narrow.yml", folder / name);
  }
  CHECK(contains(message(open_video(folder / "other/clip.avi", "")),
                 "both calibration.yml and rectified.yml beside it"));
}

TEST_CASE("a video that is damaged on its way says so before it ends", "[sources][video]") {
  const ScratchFolder folder("video_damaged");
  write_video(folder / "l.avi", kWidth, 20, 10);
  write_video(folder / "r.avi", kWidth, 20, 10);
  // No frame of the second half is left, but the header and the index are.
  std::string bytes = test::file_bytes(folder / "r.avi");
  const std::size_t index = bytes.rfind("idx1");
  REQUIRE(index != std::string::npos);
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2),
            bytes.begin() + static_cast<std::ptrdiff_t>(index), '\0');
  test::write_bytes(folder / "r.avi", bytes);
  const auto source = value_or_throw(open_video(folder / "l.avi", folder / "r.avi", {{}, true}));
  REQUIRE(source->frame_count() == 20);
  Frame frame;
  int frames = 0;
  FrameStatus status = source->next(frame);
  for (; status == FrameStatus::kFrame; status = source->next(frame)) ++frames;
  CHECK(frames > 0);
  CHECK(frames < 20);
  CHECK(status == FrameStatus::kUnreadable);
  CHECK(contains(source->last_trouble(), "r.avi is damaged: it ends after"));
  CHECK(contains(source->last_trouble(), "of 20 frames"));
  CHECK(source->next(frame) == FrameStatus::kEnd);
}

TEST_CASE("a source is told by its name", "[sources][video][folder]") {
  const ScratchFolder folder("open_source");
  write_video(folder / "both.avi", 2 * kWidth, 2, 10);
  write_rig(folder / "both.yml");
  test::FakeVideo video;
  CameraRequest request;
  request.device = folder / "both.avi";
  CHECK(open_source(request, video).ok());
  const auto refusal = [&] {
    const auto result = open_source(request, video);
    REQUIRE_FALSE(result.ok());
    return result.problem().message;
  };
  request.exposure_ms = 5;
  CHECK(contains(refusal(), "is a recording"));
  request.exposure_ms.reset();
  request.depth = "d.avi";
  CHECK(contains(refusal(), "--depth-source is for cameras"));
  request.right = "r.avi";
  CHECK(contains(refusal(), "exclude each other"));
  request.depth.clear();
  request.device = folder.path();
  CHECK(contains(refusal(), "is a folder"));
  request.right.clear();
  CHECK(contains(refusal(), "no images"));
  request.device = "/dev/video0";
  CHECK(contains(refusal(), "there is no camera"));
  request.device = folder / "a*.png";
  CHECK(contains(refusal(), "no image is called"));
}

}  // namespace
}  // namespace palpable
