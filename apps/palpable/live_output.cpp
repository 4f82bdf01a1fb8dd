#include "apps/palpable/live_output.h"

#include "palpable/base/error.h"
#include "palpable/render/picture_file.h"

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kInFlight = 4;
constexpr float kDepthUnit = 1e-4f;  // m per count
constexpr double kDefaultRate = 30;  // of a clip of one frame
constexpr std::array kStages{"read",    "rectify",  "disparity", "depth", "background",
                             "contact", "evaluate", "draw",      "write"};
constexpr std::array kFigureNames{"hand_nearer.png", "body_nearer.png", "touch.png"};

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

std::ofstream open_file(const fs::path& path) {
  std::ofstream file(path);
  if (!file) throw Error(fmt::format("{}: cannot be written", path.string()));
  return file;
}

void close_file(std::ofstream& file, const fs::path& path) {
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written (disk full?)", path.string()));
}

void write_image(const fs::path& path, const cv::Mat& image) {
  if (!cv::imwrite(path.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
    throw Error(fmt::format("{}: cannot be written (disk full?)", path.string()));
  }
}

// Half size, 0.1 mm: the mean of the two to four known depths of a block, 0 for fewer.
cv::Mat halved(const DepthImage& depth) {
  cv::Mat half(depth.height() / 2, depth.width() / 2, CV_16UC1);
  for (int y = 0; y < half.rows; ++y) {
    const float* upper = depth.row(2 * y);
    const float* lower = depth.row(2 * y + 1);
    auto* out = half.ptr<std::uint16_t>(y);
    for (int x = 0; x < half.cols; ++x) {
      float sum = 0;
      int count = 0;
      for (const float z : {upper[2 * x], upper[2 * x + 1], lower[2 * x], lower[2 * x + 1]}) {
        if (std::isnan(z)) continue;
        sum += z;
        ++count;
      }
      const float counts =
          count >= 2 ? std::round(sum / (static_cast<float>(count) * kDepthUnit)) : 0.0f;
      out[x] = counts < 65535.0f ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
    }
  }
  return half;
}

}  // namespace

LiveOutput::LiveOutput(const LiveOutputSettings& settings)
    : settings_(settings),
      ready_(kInFlight),
      free_(kInFlight),
      timing_(open_file(settings.folder / "timing.csv")),
      touches_(open_file(settings.folder / "touches.jsonl")) {
  for (const char* folder : {"visible", "body_depth"}) {
    std::error_code ignored;
    fs::remove_all(settings_.folder / folder, ignored);  // of an earlier run: not to be mixed
    if (settings_.masks) make_folder(settings_.folder / folder);
  }
  timing_ << "frame";
  for (const char* stage : kStages) {
    timing_ << "," << stage << "_ms";
    times_.emplace_back(stage, std::vector<double>());
  }
  timing_ << ",total_ms\n";
  times_.emplace_back("total", std::vector<double>());
  for (std::size_t i = 0; i < kInFlight; ++i) free_.push(std::make_unique<DrawnFrame>());
  thread_ = std::thread([this] { run(); });
}

LiveOutput::~LiveOutput() {
  ready_.close();
  free_.close();
  if (thread_.joinable()) thread_.join();
}

std::unique_ptr<DrawnFrame> LiveOutput::blank() {
  std::optional<std::unique_ptr<DrawnFrame>> frame = free_.pop();
  if (!frame) {  // the thread has given up
    finish();
    throw Error("the output was ended");
  }
  return std::move(*frame);
}

void LiveOutput::write(std::unique_ptr<DrawnFrame> frame) {
  if (!ready_.push(std::move(frame))) finish();
}

void LiveOutput::finish() {
  ready_.close();
  if (thread_.joinable()) thread_.join();
  rethrow();
}

void LiveOutput::rethrow() {
  if (trouble_) std::rethrow_exception(std::exchange(trouble_, nullptr));
}

void LiveOutput::run() {
  try {
    while (std::optional<std::unique_ptr<DrawnFrame>> frame = ready_.pop()) {
      write_frame(**frame);
      free_.push(std::move(*frame));
    }
    end_files();
  } catch (...) {
    trouble_ = std::current_exception();
    ready_.close();
    free_.close();
  }
}

void LiveOutput::write_frame(DrawnFrame& frame) {
  {
    const StageTimer timer(frame.times, "write");
    if (settings_.masks) write_masks(frame);
    write_video(frame);
    consider(frame);
    for (const Touch& touch : frame.touches) {
      touches_ << fmt::format(
          "{{\"frame\":{},\"time\":{:.6f},\"site\":{},\"level\":{:.6f},\"force\":{:.6f},"
          "\"press_depth\":{:.7f},\"point\":[{:.6f},{:.6f},{:.6f}]}}\n",
          frame.number, frame.time, touch.site, touch.level, touch.force, touch.press_depth,
          touch.point_in_body.x(), touch.point_in_body.y(), touch.point_in_body.z());
    }
  }
  timing_ << frame.number;
  double total = 0;
  for (auto& [stage, values] : times_) {
    const double ms = stage == "total" ? total : frame.times.ms(stage);
    total += ms;
    values.push_back(ms);
    timing_ << fmt::format(",{:.3f}", ms);
  }
  timing_ << "\n";
}

void LiveOutput::write_masks(const DrawnFrame& frame) {
  const std::string name = fmt::format("{:06d}.png", frame.number);
  const MaskImage& mask = frame.visible;
  write_image(settings_.folder / "visible" / name, cv::Mat(mask.height(), mask.width(), CV_8UC1,
                                                           const_cast<std::uint8_t*>(mask.data())));
  write_image(settings_.folder / "body_depth" / name, halved(frame.body_depth));
}

void LiveOutput::open_video(const ColorImage& picture, double frames_per_second) {
  const std::string path = (settings_.folder / "touch.mp4").string();
  // Chroma is halved in every direction: an odd last column or row is left out.
  const cv::Size size(picture.width() / 2 * 2, picture.height() / 2 * 2);
  for (const char* codec : {"avc1", "mp4v"}) {
    video_ = std::make_unique<cv::VideoWriter>(
        path, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), frames_per_second,
        size);
    if (video_->isOpened()) {
      codec_ = codec;
      return;
    }
  }
  throw Error(fmt::format("{}: no video can be written here (neither H.264 nor MPEG-4)", path));
}

void LiveOutput::append(const ColorImage& picture) {
  const cv::Mat rgb(picture.height(), picture.width(), CV_8UC3, const_cast<Rgb*>(picture.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb(cv::Rect(0, 0, rgb.cols / 2 * 2, rgb.rows / 2 * 2)), bgr, cv::COLOR_RGB2BGR);
  video_->write(bgr);
}

void LiveOutput::write_video(const DrawnFrame& frame) {
  ++written_;
  if (written_ == 1) {
    first_picture_ = frame.picture;
    first_time_ = frame.time;
    return;
  }
  if (written_ == 2) {
    const double step = frame.time - first_time_;
    open_video(frame.picture, step > 1e-3 ? std::clamp(1 / step, 1.0, 240.0) : kDefaultRate);
    append(first_picture_);
  }
  append(frame.picture);
}

void LiveOutput::consider(const DrawnFrame& frame) {
  if (!settings_.figures) return;
  const std::array scores{frame.scores.hand_nearer, frame.scores.body_nearer, frame.scores.touch};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] > best_score_[i]) {
      best_score_[i] = scores[i];
      best_[i] = frame.picture;
    }
  }
}

void LiveOutput::end_files() {
  if (written_ == 1) {
    open_video(first_picture_, kDefaultRate);
    append(first_picture_);
  }
  video_.reset();
  close_file(timing_, settings_.folder / "timing.csv");
  close_file(touches_, settings_.folder / "touches.jsonl");
  for (std::size_t i = 0; i < best_.size(); ++i) {
    const fs::path path = settings_.folder / kFigureNames[i];
    if (settings_.figures) {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
    if (best_score_[i] <= 0) continue;
    write_png(path, best_[i]);
    figures_.emplace_back(kFigureNames[i]);
  }
}

}  // namespace palpable::app
