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
constexpr float kDepthUnit = 0.25e-3f;     // m per count of depth/ (docs/benchmark.md)
constexpr float kBodyDepthUnit = 1e-4f;    // m per count of body_depth/
constexpr float kLargestDepth = 65534.0f;  // counts
constexpr std::uint16_t kTooCloseCount = 65535;
constexpr double kDefaultRate = 30;  // of a clip of one frame
constexpr std::array kStages{"read",       "rectify", "disparity", "depth", "map",  "track",
                             "background", "contact", "evaluate",  "draw",  "write"};
constexpr std::array kFigureNames{"hand_nearer.png", "body_nearer.png", "touch.png"};
// All that a run may leave in its folder, timing.csv first: every run begins with it.
constexpr std::array kOutputs{
    "timing.csv",          "touches.jsonl", "trajectory.txt", "pose.jsonl",   "live.json",
    "touch.mp4",           "depth",         "visible",        "body_depth",   "moving",
    "rectification.jsonl", kFigureNames[0], kFigureNames[1],  kFigureNames[2]};

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
  // Run lengths suit masks and smooth depth: smaller and a little faster than zlib's own choice.
  const std::vector<int> settings{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                                  cv::IMWRITE_PNG_STRATEGY_RLE};
  if (!cv::imwrite(path.string(), image, settings)) {
    throw Error(fmt::format("{}: cannot be written (disk full?)", path.string()));
  }
}

// 0 where unknown, or farther than the counts reach; kTooCloseCount where nearer than measured.
cv::Mat counts_of(const DepthImage& depth, const MaskImage& too_close) {
  cv::Mat counts(depth.height(), depth.width(), CV_16UC1);
  for (int y = 0; y < counts.rows; ++y) {
    const float* from = depth.row(y);
    auto* to = counts.ptr<std::uint16_t>(y);
    for (int x = 0; x < counts.cols; ++x) {
      const float count = std::round(from[x] / kDepthUnit);
      to[x] = count >= 1.0f && count <= kLargestDepth  // false for NaN
                  ? static_cast<std::uint16_t>(count)
                  : std::uint16_t{0};
    }
    if (too_close.empty()) continue;
    for (int x = 0; x < counts.cols; ++x) {
      if (too_close(x, y) != 0) to[x] = kTooCloseCount;
    }
  }
  return counts;
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
          count >= 2 ? std::round(sum / (static_cast<float>(count) * kBodyDepthUnit)) : 0.0f;
      out[x] = counts < 65535.0f ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
    }
  }
  return half;
}

// Whether `path` is `folder` or something in it, links followed.
bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(fs::absolute(path), error);
  const fs::path outer = fs::weakly_canonical(fs::absolute(folder), error);
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

}  // namespace

std::vector<fs::path> earlier_run(const fs::path& folder, bool overwrite,
                                  const std::vector<fs::path>& needed) {
  std::vector<fs::path> there;
  for (const char* name : kOutputs) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored)) there.push_back(folder / name);
  }
  if (there.empty()) return there;
  // A folder depth/ alone is somebody's data.
  if (there.front() != folder / kOutputs[0]) {
    throw Error(fmt::format("{}: is in the way and not of an earlier run; give another --out",
                            there.front().string()));
  }
  if (!overwrite) {
    throw Error(
        fmt::format("{}: holds an earlier run; give another --out, or --overwrite to replace it",
                    folder.string()));
  }
  for (const fs::path& input : needed) {
    if (input.empty()) continue;
    const bool is_out = lies_in(input, folder) && lies_in(folder, input);
    const auto holds = [&](const fs::path& path) { return lies_in(input, path); };
    if (!is_out && std::none_of(there.begin(), there.end(), holds)) continue;
    throw Error(
        fmt::format("{}: is needed by this run and --overwrite would remove it with {}; "
                    "give another --out",
                    input.string(), folder.string()));
  }
  return there;
}

void remove_earlier_run(const std::vector<fs::path>& there) {
  for (const fs::path& path : there) {
    std::error_code error;
    fs::remove_all(path, error);
    if (error) {
      throw Error(fmt::format("{}: cannot be removed: {}", path.string(), error.message()));
    }
  }
}

LiveOutput::LiveOutput(const LiveOutputSettings& settings)
    : settings_(settings), ready_(kInFlight), free_(kInFlight) {
  const fs::path& folder = settings_.folder;
  make_folder(folder);
  if (settings_.depth) make_folder(folder / "depth");
  if (settings_.masks) {
    make_folder(folder / "visible");
    make_folder(folder / "body_depth");
    make_folder(folder / "moving");
  }
  timing_ = open_file(folder / "timing.csv");
  touches_ = open_file(folder / "touches.jsonl");
  trajectory_ = open_file(folder / "trajectory.txt");
  poses_ = open_file(folder / "pose.jsonl");
  corrections_ = open_file(folder / "rectification.jsonl");
  trajectory_ << "# time tx ty tz qx qy qz qw: world_from_camera of the rectified left camera\n";
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
    const StageTimer timer(frame.scene.times, "write");
    if (settings_.depth) write_depth(frame);
    if (settings_.masks) write_masks(frame);
    write_video(frame);
    keep_if_best(frame);
    write_lines(frame);
  }
  timing_ << frame.scene.number;
  double total = 0;
  for (auto& [stage, values] : times_) {
    const double ms = stage == "total" ? total : frame.scene.times.ms(stage);
    total += ms;
    values.push_back(ms);
    timing_ << fmt::format(",{:.3f}", ms);
  }
  timing_ << "\n";
}

void LiveOutput::write_lines(const DrawnFrame& frame) {
  const Scene& scene = frame.scene;
  for (const Touch& touch : scene.touches) {
    touches_ << fmt::format(
        "{{\"frame\":{},\"time\":{:.6f},\"site\":{},\"level\":{:.6f},\"force\":{:.6f},"
        "\"press_depth\":{:.7f},\"point\":[{:.6f},{:.6f},{:.6f}]}}\n",
        scene.number, scene.time, touch.site, touch.level, touch.force, touch.press_depth,
        touch.point_in_body.x(), touch.point_in_body.y(), touch.point_in_body.z());
  }
  if (scene.camera.state != TrackState::kLost) {  // a fixed camera's pose stays as it is
    const Rigid3& world_from_camera = scene.camera.world_from_camera;
    const Eigen::Vector3d t = world_from_camera.translation();
    const Eigen::Quaterniond q(world_from_camera.linear());
    trajectory_ << fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                               scene.time, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  poses_ << fmt::format("{{\"frame\":{},\"camera_from_body\":[", scene.number);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      poses_ << fmt::format("{}{:.9g}", row + column > 0 ? "," : "",
                            scene.camera_from_body.matrix()(row, column));
    }
  }
  poses_ << "]}\n";
  const double correction = scene.seen.row_correction_px;
  if (last_correction_ != correction) {
    last_correction_ = correction;
    corrections_ << fmt::format(
        "{{\"frame\":{},\"row_correction_px\":{:.4f},\"row_error_px\":{}}}\n", scene.number,
        correction,
        std::isnan(scene.seen.row_error_px) ? "null"
                                            : fmt::format("{:.4f}", scene.seen.row_error_px));
  }
}

void LiveOutput::write_depth(const DrawnFrame& frame) {
  write_image(settings_.folder / "depth" / fmt::format("{:06d}.png", frame.scene.number),
              counts_of(frame.scene.seen.depth, frame.scene.seen.too_close));
}

void LiveOutput::write_masks(const DrawnFrame& frame) {
  const std::string name = fmt::format("{:06d}.png", frame.scene.number);
  const MaskImage& mask = frame.visible;
  write_image(settings_.folder / "visible" / name, cv::Mat(mask.height(), mask.width(), CV_8UC1,
                                                           const_cast<std::uint8_t*>(mask.data())));
  write_image(settings_.folder / "body_depth" / name, halved(frame.body_depth));
  const MaskImage& moving = frame.scene.moving;
  if (moving.empty()) return;
  write_image(
      settings_.folder / "moving" / name,
      cv::Mat(moving.height(), moving.width(), CV_8UC1, const_cast<std::uint8_t*>(moving.data())));
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
    first_time_ = frame.scene.time;
    return;
  }
  if (written_ == 2) {
    const double step = frame.scene.time - first_time_;
    open_video(frame.picture, step > 1e-3 ? std::clamp(1 / step, 1.0, 240.0) : kDefaultRate);
    append(first_picture_);
  }
  append(frame.picture);
}

void LiveOutput::keep_if_best(const DrawnFrame& frame) {
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
  close_file(trajectory_, settings_.folder / "trajectory.txt");
  close_file(poses_, settings_.folder / "pose.jsonl");
  close_file(corrections_, settings_.folder / "rectification.jsonl");
  for (std::size_t i = 0; i < best_.size(); ++i) {
    if (best_score_[i] <= 0) continue;
    write_png(settings_.folder / kFigureNames[i], best_[i]);
    figures_.emplace_back(kFigureNames[i]);
  }
}

}  // namespace palpable::app
