#include "palpable/live/sources/video_file_source.h"

#include "palpable/live/calibrate/opencv_views.h"
#include "palpable/live/sources/read_ahead.h"
#include "palpable/live/sources/side_by_side.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

struct VideoFile {
  fs::path path;
  cv::VideoCapture capture;
  int width = 0;
  int height = 0;
  double rate = 0;  // frames per second; 0: unknown
  int frames = -1;

  // Opens the file. Returns an empty string, or why that failed.
  std::string open() {
    std::error_code error;
    if (!fs::exists(path, error)) return "does not exist";
    try {
      // Only these two: OpenCV's other readers interpret a name as a pattern or a camera.
      for (const int reader : {cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG}) {
        if (capture.open(path.string(), reader)) break;
      }
      if (!capture.isOpened()) return "is no video that can be decoded";
      width = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH));
      height = static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT));
      rate = capture.get(cv::CAP_PROP_FPS);
      const double count = capture.get(cv::CAP_PROP_FRAME_COUNT);
      if (count > 0 && count < 1e8) frames = static_cast<int>(count);
    } catch (const cv::Exception& e) { return "is no video that can be decoded: " + e.err; }
    if (!(rate > 0 && rate < 10000)) rate = 0;
    if (width < 1 || height < 1) return "has no picture size";
    return {};
  }
};

class VideoReader final : public FrameReader {
 public:
  VideoReader(VideoFile left, VideoFile right, FrameFormat format, double frames_per_second)
      : left_(std::move(left)),
        right_(std::move(right)),
        format_(std::move(format)),
        frames_per_second_(frames_per_second) {}

  const FrameFormat& format() const override { return format_; }
  int count() const override {
    return right_.path.empty() ? left_.frames : std::min(left_.frames, right_.frames);
  }

  FrameStatus read(int number, Frame& frame, std::string& trouble) override {
    frame.number = number;
    if (is_damaged_) return FrameStatus::kEnd;
    frame.time = number / frames_per_second_;
    const bool two = !right_.path.empty();
    if (!next(left_, two ? frame.left : both_)) return end(left_, number, trouble);
    // Times are relative to the first frame's.
    const double time = 1e-3 * left_.capture.get(cv::CAP_PROP_POS_MSEC);
    if (number == 0) begin_ = time;
    // Some containers have time 0 for all frames.
    if (std::isfinite(time) && time - begin_ > last_time_) frame.time = time - begin_;
    last_time_ = frame.time;
    if (two) {
      if (!next(right_, frame.right)) return end(right_, number, trouble);
    } else {
      split_side_by_side(both_, frame.left, frame.right);
    }
    for (const ColorImage* image : {&frame.left, &frame.right}) {
      if (image->width() == format_.width && image->height() == format_.height) continue;
      trouble = fmt::format("frame {} of {} is {} x {} px; the others are {} x {}", number,
                            left_.path.string(), image->width(), image->height(), format_.width,
                            format_.height);
      return FrameStatus::kUnreadable;
    }
    return FrameStatus::kFrame;
  }

 private:
  // A video with fewer frames than stated is damaged: one unreadable frame reports that,
  // then the video ends.
  FrameStatus end(const VideoFile& file, int number, std::string& trouble) {
    if (number >= count()) return FrameStatus::kEnd;
    is_damaged_ = true;
    trouble = fmt::format("{} is damaged: it ends after {} of {} frames", file.path.string(),
                          number, file.frames);
    return FrameStatus::kUnreadable;
  }

  bool next(VideoFile& file, ColorImage& image) {
    try {
      if (!file.capture.read(decoded_) || decoded_.type() != CV_8UC3) return false;
      image.resize(decoded_.cols, decoded_.rows);
      cv::Mat target = view(image);
      cv::cvtColor(decoded_, target, cv::COLOR_BGR2RGB);
      return true;
    } catch (const cv::Exception&) { return false; }  // damaged from here on
  }

  VideoFile left_;
  VideoFile right_;
  FrameFormat format_;
  double frames_per_second_;
  double begin_ = 0;
  double last_time_ = -1;
  bool is_damaged_ = false;
  cv::Mat decoded_;
  ColorImage both_;
};

// The calibration file of the settings, or one beside the video.
Result<SourceCalibration> calibration_of_video(const fs::path& video, const VideoSettings& settings,
                                               int width, int height) {
  if (!settings.calibration.empty()) {
    return read_source_calibration(settings.calibration, width, height);
  }
  const fs::path folder = video.parent_path().empty() ? fs::path(".") : video.parent_path();
  std::vector<fs::path> candidates{fs::path(video).replace_extension(".yml"),
                                   folder / "calibration.yml", folder / "rectified.yml"};
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".conf" && it->path().filename().string().starts_with("SN")) {
      candidates.push_back(it->path());
    }
  }
  for (const fs::path& path : candidates) {
    std::error_code ignored;
    if (fs::exists(path, ignored)) return read_source_calibration(path, width, height);
  }
  return Problem{
      fmt::format("{} has no calibration: name it with --calibration, or put {} beside it",
                  video.string(), candidates.front().filename().string())};
}

std::optional<Problem> unequal_sizes(const VideoFile& left, const VideoFile& right) {
  if (left.width == right.width && left.height == right.height) return std::nullopt;
  return Problem{fmt::format("{} is {} x {} px and {} is {} x {}; they should be equal",
                             left.path.string(), left.width, left.height, right.path.string(),
                             right.width, right.height)};
}

std::optional<Problem> not_side_by_side(const VideoFile& both) {
  if (looks_side_by_side(both.width, both.height)) return std::nullopt;
  return Problem{
      fmt::format("{} is {} x {} px, which is no pair side by side; name the other eye's file "
                  "with --right",
                  both.path.string(), both.width, both.height)};
}

// The calibration of a stereo rig for eyes of this size; only the size with
// settings.without_calibration.
Result<SourceCalibration> fitting_calibration(const fs::path& video, const VideoSettings& settings,
                                              int eye_width, int height) {
  if (settings.without_calibration) {
    SourceCalibration none;
    none.format.width = eye_width;
    none.format.height = height;
    return none;
  }
  Result<SourceCalibration> read = calibration_of_video(video, settings, eye_width, height);
  if (!read.ok()) return read;
  const FrameFormat& format = read.value().format;
  if (format.kind != FrameFormat::Kind::kStereo) {
    return Problem{fmt::format("{} needs a stereo rig's calibration, not one camera's intrinsics",
                               video.string())};
  }
  if (format.width != eye_width || format.height != height) {
    return Problem{
        fmt::format("{}: the calibration is for eyes of {} x {} px but these are {} x "
                    "{}; calibrate at this size",
                    video.string(), format.width, format.height, eye_width, height)};
  }
  return read;
}

}  // namespace

bool is_video_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kVideoEndings.begin(), kVideoEndings.end(), extension) != kVideoEndings.end();
}

Result<std::unique_ptr<FrameSource>> open_video(const fs::path& left, const fs::path& right,
                                                const VideoSettings& settings) {
  VideoFile first;
  VideoFile second;
  first.path = left;
  second.path = right;
  for (VideoFile* file : {&first, &second}) {
    if (file->path.empty()) continue;
    const std::string wrong = file->open();
    if (!wrong.empty()) return Problem{fmt::format("{} {}", file->path.string(), wrong)};
  }
  const bool two = !right.empty();
  if (auto problem = two ? unequal_sizes(first, second) : not_side_by_side(first)) return *problem;
  const int eye_width = two ? first.width : first.width / 2;
  Result<SourceCalibration> calibration =
      fitting_calibration(left, settings, eye_width, first.height);
  if (!calibration.ok()) return calibration.problem();
  const double rate = first.rate > 0 ? first.rate : calibration.value().frames_per_second;
  return read_ahead(std::make_unique<VideoReader>(std::move(first), std::move(second),
                                                  calibration.value().format, rate));
}

}  // namespace palpable
