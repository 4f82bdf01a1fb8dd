#include "palpable/vision/folder_source.h"

#include "palpable/vision/calibration_file.h"
#include "palpable/vision/image_file.h"
#include "palpable/vision/natural_order.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <limits>
#include <locale>
#include <mutex>
#include <optional>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

enum class Layout { kTwoFolders, kSideBySide, kColorDepth };

// Everything that is needed to read frame i.
struct Recording {
  Layout layout = Layout::kTwoFolders;
  FrameFormat format;
  double frames_per_second = 30;
  double depth_unit = 0.001;     // m per step of the depth image
  std::vector<fs::path> first;   // left, side by side, or colour
  std::vector<fs::path> second;  // right or depth; empty for side by side
};

bool is_image(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 8> kKnown = {".png", ".jpg", ".jpeg", ".bmp",
                                                      ".ppm", ".pgm", ".tif",  ".tiff"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

// The images directly in `folder` whose names start with `prefix`, in natural order.
std::vector<fs::path> images_in(const fs::path& folder, std::string_view prefix = "") {
  std::vector<fs::path> images;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (name.starts_with(prefix) && name.front() != '.' && is_image(it->path()) &&
        it->is_regular_file(ignored)) {
      images.push_back(it->path());
    }
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return images;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// Reads the calibration of a stereo folder into `recording`.
std::optional<Problem> read_stereo_format(const fs::path& folder, Recording& recording) {
  FrameFormat& format = recording.format;
  format.kind = FrameFormat::Kind::kStereo;
  const fs::path raw = folder / "calibration.yml";
  const fs::path aligned = folder / "rectified.yml";
  if (is_there(raw) && is_there(aligned)) {
    return Problem{
        fmt::format("{} has both calibration.yml and rectified.yml: keep the first for "
                    "raw images, the second for rectified ones",
                    folder.string())};
  }
  if (is_there(raw)) {
    const Result<StereoCalibration> calibration = read_stereo_calibration(raw);
    if (!calibration.ok()) return calibration.problem();
    format.rig = calibration.value().rig;
    format.width = format.rig.left.pinhole.width;
    format.height = format.rig.left.pinhole.height;
    recording.frames_per_second = calibration.value().frames_per_second;
    return std::nullopt;
  }
  if (is_there(aligned)) {
    const Result<RectifiedCalibration> calibration = read_rectified_calibration(aligned);
    if (!calibration.ok()) return calibration.problem();
    format.already_rectified = true;
    format.rectified = calibration.value().stereo;
    format.width = format.rectified.camera.width;
    format.height = format.rectified.camera.height;
    recording.frames_per_second = calibration.value().frames_per_second;
    return std::nullopt;
  }
  return Problem{
      fmt::format("{} has no calibration: put calibration.yml (raw images) or "
                  "rectified.yml (rectified ones) into it",
                  folder.string())};
}

// Reads intrinsics.txt of a colour + depth folder; the images' size comes later if it is not there.
std::optional<Problem> read_depth_format(const fs::path& folder, Recording& recording) {
  const fs::path path = folder / "intrinsics.txt";
  if (!is_there(path)) {
    return Problem{fmt::format("{} has no intrinsics.txt: write one line `fx fy cx cy` in pixels",
                               folder.string())};
  }
  constexpr std::size_t kFewest = 4;  // fx fy cx cy
  constexpr std::size_t kMost = 7;    // and width height unit_m
  std::vector<double> numbers;
  bool is_text = true;
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line) && numbers.size() <= kMost) {
    std::istringstream words(line.substr(0, line.find('#')));
    words.imbue(std::locale::classic());
    std::string word;
    while (words >> word && numbers.size() <= kMost) {
      std::istringstream one(word);
      one.imbue(std::locale::classic());
      double value = 0;
      is_text = is_text && one >> value && one.eof() && std::isfinite(value);
      numbers.push_back(value);
    }
  }
  if (!is_text || (numbers.size() != kFewest && numbers.size() != 6 && numbers.size() != kMost)) {
    return Problem{
        fmt::format("{} should have the numbers `fx fy cx cy`, `... width height` or "
                    "`... width height unit_m`",
                    path.string())};
  }
  FrameFormat& format = recording.format;
  format.kind = FrameFormat::Kind::kColorDepth;
  PinholeCamera& camera = format.depth_camera;
  camera.fx_px = numbers[0];
  camera.fy_px = numbers[1];
  camera.cx_px = numbers[2];
  camera.cy_px = numbers[3];
  if (!(camera.fx_px > 0 && camera.fy_px > 0)) {
    return Problem{fmt::format("{} has focal lengths {} and {} px; they should be positive",
                               path.string(), camera.fx_px, camera.fy_px)};
  }
  if (numbers.size() > kFewest) {
    const auto is_side = [](double v) { return v >= 1 && v <= 16384 && v == std::floor(v); };
    if (!is_side(numbers[4]) || !is_side(numbers[5])) {
      return Problem{
          fmt::format("{} has an image of {} x {} px", path.string(), numbers[4], numbers[5])};
    }
    format.width = static_cast<int>(numbers[4]);
    format.height = static_cast<int>(numbers[5]);
  }
  if (numbers.size() == kMost) {
    recording.depth_unit = numbers[6];
    // From a micrometre to a metre a step; outside of it, the number is in another unit.
    if (!(recording.depth_unit >= 1e-6 && recording.depth_unit <= 1)) {
      return Problem{fmt::format("{} has depth steps of {} m; a sensor in millimetres has 0.001",
                                 path.string(), recording.depth_unit)};
    }
  }
  return std::nullopt;
}

std::optional<Problem> unequal(const fs::path& folder, const Recording& recording,
                               std::string_view first, std::string_view second) {
  if (recording.first.size() == recording.second.size()) return std::nullopt;
  return Problem{
      fmt::format("{} has {} {} and {} {} images; each needs its partner, so add or "
                  "remove what is left over",
                  folder.string(), recording.first.size(), first, recording.second.size(), second)};
}

// Which images there are and what is known about them; sizes are not compared yet.
Result<Recording> recognise(const fs::path& folder) {
  if (!is_there(folder)) { return Problem{fmt::format("there is no folder {}", folder.string())}; }
  if (!is_folder(folder)) return Problem{fmt::format("{} is not a folder", folder.string())};

  Recording recording;
  if (is_folder(folder / "left") || is_folder(folder / "right")) {
    recording.layout = Layout::kTwoFolders;
    recording.first = images_in(folder / "left");
    recording.second = images_in(folder / "right");
    if (recording.first.empty() && recording.second.empty()) {
      return Problem{fmt::format("{} has no images in left/ and right/", folder.string())};
    }
    if (auto problem = unequal(folder, recording, "left", "right")) return *problem;
    if (auto problem = read_stereo_format(folder, recording)) return *problem;
    return recording;
  }
  recording.second = images_in(folder, "depth_");
  if (!recording.second.empty()) {
    recording.layout = Layout::kColorDepth;
    recording.first = images_in(folder, "color_");
    if (recording.first.empty()) recording.first = images_in(folder, "rgb_");
    if (auto problem = unequal(folder, recording, "colour", "depth")) return *problem;
    if (auto problem = read_depth_format(folder, recording)) return *problem;
    return recording;
  }
  recording.layout = Layout::kSideBySide;
  recording.first = images_in(folder);
  if (recording.first.empty()) {
    return Problem{
        fmt::format("{} has no images: it should have left/ and right/, pairs side by "
                    "side, or color_* and depth_*",
                    folder.string())};
  }
  if (auto problem = read_stereo_format(folder, recording)) return *problem;
  return recording;
}

// Reads single frames of a recording.
class FrameReader {
 public:
  explicit FrameReader(Recording recording) : recording_(std::move(recording)) {}

  [[nodiscard]] const Recording& recording() const { return recording_; }
  [[nodiscard]] int count() const { return static_cast<int>(recording_.first.size()); }

  // Of the images of the first frame that can be read, whole files; nullopt if none can.
  struct ImageSize {
    int width;
    int height;
    fs::path path;
  };
  std::optional<ImageSize> first_readable_size() {
    for (const fs::path& path : recording_.first) {
      if (reader_.read_color(path, image_).ok()) {
        return ImageSize{image_.width(), image_.height(), path};
      }
    }
    return std::nullopt;
  }

  void set_size(int width, int height) {
    FrameFormat& format = recording_.format;
    format.width = width;
    format.height = height;
    format.depth_camera.width = width;
    format.depth_camera.height = height;
  }

  // Fills the frame; empty, or why it could not.
  std::string read(int number, Frame& frame) {
    frame.number = number;
    frame.time = number / recording_.frames_per_second;
    const auto i = static_cast<std::size_t>(number);
    if (recording_.layout == Layout::kSideBySide) return read_side_by_side(i, frame);
    std::string trouble = read_color(recording_.first[i], frame.left);
    if (!trouble.empty()) return trouble;
    if (recording_.layout == Layout::kTwoFolders) {
      return read_color(recording_.second[i], frame.right);
    }
    return read_depth(recording_.second[i], frame.depth);
  }

 private:
  std::string of_another_size(const fs::path& path, int width, int height) const {
    return fmt::format("image {} is {} x {} px; the others are {} x {}", path.string(), width,
                       height, recording_.format.width, recording_.format.height);
  }

  std::string read_color(const fs::path& path, ColorImage& image) {
    const Result<bool> read = reader_.read_color(path, image);
    if (!read.ok()) return read.problem().message;
    const FrameFormat& format = recording_.format;
    if (image.width() == format.width && image.height() == format.height) return {};
    return of_another_size(path, image.width(), image.height());
  }

  std::string read_side_by_side(std::size_t i, Frame& frame) {
    const fs::path& path = recording_.first[i];
    const Result<bool> read = reader_.read_color(path, image_);
    if (!read.ok()) return read.problem().message;
    const int width = recording_.format.width;
    const int height = recording_.format.height;
    if (image_.width() != 2 * width || image_.height() != height) {
      return of_another_size(path, image_.width(), image_.height());
    }
    frame.left.resize(width, height);
    frame.right.resize(width, height);
    for (int y = 0; y < height; ++y) {
      const Rgb* row = image_.row(y);
      std::copy(row, row + width, frame.left.row(y));
      std::copy(row + width, row + 2 * width, frame.right.row(y));
    }
    return {};
  }

  std::string read_depth(const fs::path& path, DepthImage& depth) {
    const Result<bool> read = reader_.read_16bit(path, steps_);
    if (!read.ok()) return read.problem().message;
    const FrameFormat& format = recording_.format;
    if (steps_.width() != format.width || steps_.height() != format.height) {
      return of_another_size(path, steps_.width(), steps_.height());
    }
    depth.resize(format.width, format.height);
    const auto unit = static_cast<float>(recording_.depth_unit);
    std::transform(steps_.begin(), steps_.end(), depth.begin(), [unit](std::uint16_t step) {
      return step == 0 || step == 65535 ? kUnknown : static_cast<float>(step) * unit;
    });
    return {};
  }

  Recording recording_;
  ImageFileReader reader_;
  ColorImage image_;
  Image<std::uint16_t> steps_;
};

// Compares the images with the calibration; sets the format's size where only images know it.
std::optional<Problem> check_size(const fs::path& folder, FrameReader& reader) {
  const auto found = reader.first_readable_size();
  if (!found) {
    return Problem{
        fmt::format("none of the {} images of {} can be read", reader.count(), folder.string())};
  }
  const Recording& recording = reader.recording();
  int width = recording.format.width;
  const int height = recording.format.height;
  if (recording.layout == Layout::kColorDepth) {
    if (width == 0) width = found->width;
    const bool fits = width == found->width && (height == 0 || height == found->height);
    if (!fits) {
      return Problem{
          fmt::format("{}: intrinsics.txt is for images of {} x {} px but {} is {} x {}; "
                      "give the intrinsics of this size",
                      folder.string(), width, height, found->path.filename().string(), found->width,
                      found->height)};
    }
    reader.set_size(found->width, found->height);
    return std::nullopt;
  }
  const bool side_by_side = recording.layout == Layout::kSideBySide;
  if (found->width == (side_by_side ? 2 * width : width) && found->height == height) {
    return std::nullopt;
  }
  return Problem{fmt::format(
      "{}: the calibration is for images of {} x {} px{} but {} is {} x {}; calibrate at this size "
      "or bring the images to the calibration's",
      folder.string(), width, height,
      side_by_side ? fmt::format(", side by side {} x {},", 2 * width, height) : std::string(),
      found->path.filename().string(), found->width, found->height)};
}

// Reads one frame ahead on its own thread: decoding a 720p pair takes about 10 ms, which the loop
// would otherwise wait for.
class FolderSource final : public FrameSource {
 public:
  explicit FolderSource(std::unique_ptr<FrameReader> reader)
      : reader_(std::move(reader)),
        format_(reader_->recording().format),
        count_(reader_->count()),
        thread_([this] { read_ahead(); }) {}

  FolderSource(const FolderSource&) = delete;
  FolderSource& operator=(const FolderSource&) = delete;

  ~FolderSource() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return count_; }
  int unreadable_count() const override { return unreadable_; }
  std::string last_trouble() const override { return last_trouble_; }

  FrameStatus next(Frame& frame) override {
    if (given_ == count_) return FrameStatus::kEnd;
    ++given_;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_full_; });
    std::swap(frame, ahead_);  // the loop's old images are the next ones' memory
    std::string trouble = std::exchange(trouble_, {});
    is_full_ = false;
    lock.unlock();
    changed_.notify_all();
    if (trouble.empty()) return FrameStatus::kFrame;
    ++unreadable_;
    last_trouble_ = std::move(trouble);
    return FrameStatus::kUnreadable;
  }

 private:
  void read_ahead() {
    for (int number = 0; number < count_; ++number) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || !is_full_; });
      if (stop_) return;
      // While it is not full, `ahead_` and `trouble_` are this thread's.
      lock.unlock();
      std::string trouble;
      try {
        trouble = reader_->read(number, ahead_);
      } catch (const std::exception& e) {  // no memory, say
        ahead_.number = number;
        trouble = fmt::format("frame {} cannot be read: {}", number, e.what());
      }
      lock.lock();
      trouble_ = std::move(trouble);
      is_full_ = true;
      lock.unlock();
      changed_.notify_all();
    }
  }

  std::unique_ptr<FrameReader> reader_;  // the thread's alone
  FrameFormat format_;
  int count_ = 0;
  int given_ = 0;
  int unreadable_ = 0;
  std::string last_trouble_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  bool is_full_ = false;
  Frame ahead_;
  std::string trouble_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace

Result<std::unique_ptr<FrameSource>> open_folder(const std::filesystem::path& folder) {
  Result<Recording> recording = recognise(folder);
  if (!recording.ok()) return recording.problem();
  auto reader = std::make_unique<FrameReader>(std::move(recording).value());
  if (auto problem = check_size(folder, *reader)) return *problem;
  return std::unique_ptr<FrameSource>(std::make_unique<FolderSource>(std::move(reader)));
}

}  // namespace palpable
