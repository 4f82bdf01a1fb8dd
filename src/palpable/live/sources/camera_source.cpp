#include "palpable/live/sources/camera_source.h"

#include "palpable/common/base/this_machine.h"
#include "palpable/live/sources/side_by_side.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kStall = 0.5;         // s without a picture until the state is kStalled
constexpr double kReopen = 1.0;        // s between attempts to open a lost device
constexpr double kTogether = 0.6;      // periods; unsynchronized cameras differ by up to 0.5
constexpr double kLockAfter = 1.0;     // s, time in which an automatic exposure settles
constexpr int kPreferredWidth = 2560;  // px, both eyes
constexpr int kPreferredHeight = 720;  // px

struct EyeSize {
  int width = 0;
  int height = 0;
};

class CameraSource final : public FrameSource {
 public:
  // @param keeps_yuyv  pass YUYV pictures of both eyes on unconverted
  CameraSource(VideoSystem& system, FrameFormat format, double depth_unit, bool lock,
               bool keeps_yuyv, V4l2Camera first, std::optional<V4l2Camera> second)
      : system_(system),
        format_(std::move(format)),
        depth_unit_(depth_unit),
        keeps_yuyv_(keeps_yuyv && format_.width % 2 == 0),
        is_locked_(!lock),
        wants_lock_(lock),
        first_(std::move(first)),
        second_(std::move(second)),
        last_picture_(system.now()) {}

  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return -1; }
  std::string last_trouble() const override { return trouble_; }
  std::vector<std::string> take_notes() override { return std::exchange(notes_, {}); }
  bool is_live() const override { return true; }
  std::optional<double> taken() const override { return taken_; }
  SourceState state() const override { return state_; }

  FrameStatus next(Frame& frame) override {
    if (state_ == SourceState::kGone && !reopen()) return FrameStatus::kWaiting;
    const double until = system_.now() + kLongestWait;
    while (!has_first_ || (second_ && !has_second_)) {
      const double left = std::max(0.0, until - system_.now());
      // The order of the two cameras does not matter: both drivers keep their newest picture.
      const bool is_first = !has_first_;
      V4l2Camera& camera = is_first ? first_ : *second_;
      const V4l2Camera::Grab grab = camera.grab(left);
      if (grab == V4l2Camera::Grab::kGone) return lose(camera);
      if (grab == V4l2Camera::Grab::kNothing) return wait();
      frame.number = first_.sequence();
      std::string trouble =
          grab == V4l2Camera::Grab::kBroken ? camera.trouble() : convert(camera, is_first);
      if (!trouble.empty()) return leave_out(std::move(trouble));
      (is_first ? has_first_ : has_second_) = true;
      if (second_ && has_first_ && has_second_) forget_the_older();
    }
    has_first_ = has_second_ = false;
    state_ = SourceState::kRunning;
    frame.number = first_.sequence();
    if (!begin_) begin_ = first_.time();
    frame.time = first_.time() - *begin_;
    taken_ = first_.time();
    std::swap(frame.left, left_);
    std::swap(frame.right, right_);
    std::swap(frame.both, yuyv_);
    std::swap(frame.depth, depth_);
    last_picture_ = system_.now();
    never_pair_ = false;
    if (!running_from_) running_from_ = frame.time;
    if (!is_locked_ && frame.time - *running_from_ > kLockAfter) lock();
    return FrameStatus::kFrame;
  }

 private:
  std::string convert(const V4l2Camera& camera, bool is_first) {
    const RawPicture& raw = camera.picture();
    if (!is_first) {
      return format_.kind == FrameFormat::Kind::kColorDepth ? to_depth(raw, depth_unit_, depth_)
                                                            : to_color(raw, right_);
    }
    if (second_) return to_color(raw, left_);
    const bool as_it_is = keeps_yuyv_ && raw.format == four_letters("YUYV");
    std::string trouble = as_it_is ? to_yuyv(raw, yuyv_) : to_color(raw, both_);
    if (!trouble.empty()) return trouble;
    const int width = as_it_is ? 2 * yuyv_.width() : both_.width();
    const int height = as_it_is ? yuyv_.height() : both_.height();
    if (width != 2 * format_.width || height != format_.height) {
      return fmt::format("the picture is {} x {} px, not {} x {}", width, height, 2 * format_.width,
                         format_.height);
    }
    // A camera that was plugged in again may send another format, so that the images of the other
    // format are cleared.
    if (as_it_is) {
      left_.resize(0, 0);
      right_.resize(0, 0);
    } else {
      split_side_by_side(both_, left_, right_);
      yuyv_.resize(0, 0);
    }
    return {};
  }

  // If two pictures are too far apart in time for one frame, the older one is dropped.
  void forget_the_older() {
    const double apart = first_.time() - second_->time();
    if (std::abs(apart) * first_.frames_per_second() <= kTogether) return;
    (apart < 0 ? has_first_ : has_second_) = false;
    never_pair_ = true;
  }

  FrameStatus leave_out(std::string trouble) {
    last_picture_ = system_.now();
    trouble_ = std::move(trouble);
    return FrameStatus::kUnreadable;
  }

  FrameStatus wait() {
    if (system_.now() - last_picture_ > kStall) {
      if (state_ == SourceState::kRunning) {
        trouble_ = never_pair_ ? "both cameras give pictures, but none of the same moment" : "";
      }
      state_ = SourceState::kStalled;
    }
    return FrameStatus::kWaiting;
  }

  FrameStatus lose(const V4l2Camera& camera) {
    trouble_ = camera.trouble();
    state_ = SourceState::kGone;
    has_first_ = has_second_ = false;
    last_try_ = system_.now();
    return FrameStatus::kWaiting;
  }

  void lock(V4l2Camera& camera, const char* which) {
    const std::string cannot = camera.lock();
    if (!cannot.empty()) notes_.push_back(fmt::format("{} does not lock: {}", which, cannot));
  }

  // Returns whether all devices are available again.
  bool reopen() {
    if (system_.now() - last_try_ < kReopen) {
      system_.sleep(kLongestWait);
      return false;
    }
    last_try_ = system_.now();
    if (!first_.reopen() || (second_ && !second_->reopen())) return false;
    last_picture_ = system_.now();
    is_locked_ = !wants_lock_;  // a device that was plugged in again has automatic settings
    running_from_.reset();
    state_ = SourceState::kStalled;  // until a picture comes
    return true;
  }

  void lock() {
    is_locked_ = true;
    lock(first_, second_ ? "the first camera" : "the camera");
    if (second_ && format_.kind == FrameFormat::Kind::kStereo) lock(*second_, "the second camera");
  }

  VideoSystem& system_;
  FrameFormat format_;
  double depth_unit_;
  bool keeps_yuyv_;
  bool is_locked_;  // or need not be
  bool wants_lock_;
  V4l2Camera first_;
  std::optional<V4l2Camera> second_;
  SourceState state_ = SourceState::kRunning;
  std::vector<std::string> notes_;
  std::string trouble_;
  std::optional<double> taken_;         // the driver's time of the last frame that was returned
  std::optional<double> begin_;         // the driver's time of the first frame
  std::optional<double> running_from_;  // Frame::time of the first frame since opening
  double last_picture_;                 // last frame or unreadable picture, system's clock
  bool never_pair_ = false;             // the pictures since then did not match in time
  double last_try_ = 0;
  bool has_first_ = false;  // left_ (or both eyes) is filled and not yet returned
  bool has_second_ = false;
  ColorImage both_;
  ColorImage left_;
  ColorImage right_;
  YuyvImage yuyv_;
  DepthImage depth_;
};

// The largest size of these modes with a height up to 720 px; if there is none, the smallest.
EyeSize comfortable_size(const CameraInfo& info, bool depth, const CameraInfo* also) {
  const auto has = [](const CameraInfo& other, const CameraMode& mode) {
    return std::any_of(other.modes.begin(), other.modes.end(), [&](const CameraMode& m) {
      return m.width == mode.width && m.height == mode.height;
    });
  };
  EyeSize best;
  for (const CameraMode& mode : info.modes) {
    if (is_depth_format(mode.format) != depth || (also != nullptr && !has(*also, mode))) continue;
    const bool fits = mode.height <= kPreferredHeight;
    const bool best_fits = best.height <= kPreferredHeight;
    const bool larger = mode.width * mode.height > best.width * best.height;
    if (best.width == 0 || (fits && !best_fits) || (fits == best_fits && fits == larger)) {
      best = {mode.width, mode.height};
    }
  }
  return best;
}

// The second device: depth or right eye; empty if there is only one.
const std::string& other_device(const CameraRequest& request) {
  return request.depth.empty() ? request.right : request.depth;
}

// A size that both devices have.
Result<EyeSize> common_size(const CameraRequest& request, const CameraInfo& first,
                            VideoSystem& system) {
  const bool has_depth = !request.depth.empty();
  const Result<CameraInfo> second = query_camera(system, other_device(request));
  if (!second.ok()) return second.problem();
  const EyeSize size = comfortable_size(second.value(), has_depth, &first);
  if (size.width > 0) return size;
  return Problem{fmt::format("{} and {} have no {}picture size in common", request.device,
                             other_device(request), has_depth ? "depth and " : "")};
}

// The size of one eye: the requested one, or the calibration's, or the camera's default.
Result<EyeSize> eye_size(const CameraRequest& request, const CameraInfo& info,
                         VideoSystem& system) {
  const bool two = !other_device(request).empty();
  const EyeSize asked{two ? request.width : request.width / 2, request.height};
  if (asked.width > 0) return asked;
  if (!request.calibration.empty() && request.calibration.extension() != ".conf") {
    const Result<SourceCalibration> calibration =
        read_source_calibration(request.calibration, 0, 0);
    if (!calibration.ok()) return calibration.problem();
    const FrameFormat& format = calibration.value().format;
    if (format.width > 0) return EyeSize{format.width, format.height};
  }
  if (two) return common_size(request, info, system);
  const CameraMode* mode = side_by_side_mode(info);
  if (mode == nullptr) {
    return Problem{fmt::format(
        "{} ({}) gives one eye's pictures only: name the other eye's camera with --right, or the "
        "depth of the same view with --depth-source",
        request.device, info.name)};
  }
  return EyeSize{mode->width / 2, mode->height};
}

// The calibration file in the request, or the known one for a camera of this name.
Result<SourceCalibration> calibration_of_camera(const CameraRequest& request,
                                                const std::string& camera, const EyeSize& eye) {
  const bool has_depth = !request.depth.empty();
  if (request.without_calibration && !has_depth) {
    SourceCalibration none;
    none.format.width = eye.width;
    none.format.height = eye.height;
    return none;
  }
  fs::path path = request.calibration;
  if (path.empty() && !has_depth) {
    path = known_calibration(camera, eye.width, eye.height, request.folders).value_or(fs::path());
  }
  if (path.empty()) {
    return Problem{fmt::format(
        "no calibration is known of {} ({}) at {}x{} px an eye: name it with --calibration{}",
        request.device, camera, eye.width, eye.height,
        has_depth ? " (intrinsics.txt)" : ", or make it with palpable calibrate")};
  }
  Result<SourceCalibration> read = read_source_calibration(path, eye.width, eye.height);
  if (!read.ok()) return read;
  FrameFormat& format = read.value().format;
  if ((format.kind == FrameFormat::Kind::kColorDepth) != has_depth) {
    return Problem{fmt::format("{} is no calibration of {}", path.string(),
                               has_depth ? "one camera (fx fy cx cy)" : "a stereo rig")};
  }
  if (format.width == 0) set_size(format, eye.width, eye.height);
  if (format.width != eye.width || format.height != eye.height) {
    return Problem{fmt::format("the calibration {} is for eyes of {}x{} px, not {}x{}",
                               path.string(), format.width, format.height, eye.width, eye.height)};
  }
  return read;
}

CameraSettings first_settings(const CameraRequest& request, const EyeSize& eye) {
  CameraSettings settings;
  settings.width = other_device(request).empty() ? 2 * eye.width : eye.width;
  settings.height = eye.height;
  settings.frames_per_second = request.frames_per_second;
  settings.exposure_ms = request.exposure_ms;
  settings.gain = request.gain;
  return settings;
}

// Exposure and gain apply to the colour camera; a depth device does not share these controls.
CameraSettings second_settings(const CameraRequest& request, const EyeSize& eye) {
  CameraSettings settings = first_settings(request, eye);
  settings.depth = !request.depth.empty();
  if (settings.depth) settings.exposure_ms = settings.gain = std::nullopt;
  return settings;
}

}  // namespace

const CameraMode* side_by_side_mode(const CameraInfo& info) {
  const CameraMode* best = nullptr;
  for (const CameraMode& mode : info.modes) {
    if (is_depth_format(mode.format) || !looks_side_by_side(mode.width, mode.height)) continue;
    if (mode.width == kPreferredWidth && mode.height == kPreferredHeight) return &mode;
    const bool fits = mode.width <= kPreferredWidth;
    const bool best_fits = best != nullptr && best->width <= kPreferredWidth;
    const bool larger = best != nullptr && mode.width > best->width;
    if (best == nullptr || (fits && !best_fits) || (fits == best_fits && fits == larger)) {
      best = &mode;
    }
  }
  return best;
}

std::string calibration_name(const std::string& camera, int width, int height) {
  std::string name;
  for (const char c : camera) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      name += static_cast<char>(std::tolower(byte));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return fmt::format("{}-{}x{}.yml", name.empty() ? "camera" : name, width, height);
}

std::optional<fs::path> known_calibration(const std::string& camera, int width, int height,
                                          const std::vector<fs::path>& folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    const fs::path own = folder / calibration_name(camera, width, height);
    if (fs::exists(own, ignored)) return own;
  }
  if (camera.find("ZED") == std::string::npos) return std::nullopt;
  for (const fs::path& folder : folders) {
    std::vector<fs::path> factory;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      if (it->path().extension() == ".conf" && it->path().filename().string().starts_with("SN")) {
        factory.push_back(it->path());
      }
    }
    if (factory.size() == 1) return factory.front();
  }
  return std::nullopt;
}

Result<std::unique_ptr<FrameSource>> open_camera(const CameraRequest& request,
                                                 VideoSystem& system) {
  const Result<CameraInfo> info = query_camera(system, request.device);
  if (!info.ok()) return info.problem();
  if (request.lock && !info.value().has_exposure && !info.value().has_gain) {
    return Problem{
        fmt::format("{} has neither exposure nor gain that can be locked", request.device)};
  }
  const Result<EyeSize> eye = eye_size(request, info.value(), system);
  if (!eye.ok()) return eye.problem();
  const Result<SourceCalibration> calibration =
      calibration_of_camera(request, info.value().name, eye.value());
  if (!calibration.ok()) return calibration.problem();

  Result<V4l2Camera> first =
      V4l2Camera::open(system, request.device, first_settings(request, eye.value()));
  if (!first.ok()) return first.problem();
  std::optional<V4l2Camera> second;
  if (!other_device(request).empty()) {
    Result<V4l2Camera> opened =
        V4l2Camera::open(system, other_device(request), second_settings(request, eye.value()));
    if (!opened.ok()) return opened.problem();
    second = std::move(opened).value();
  }
  constexpr double kMillimetre = 1e-3;  // usual step of depth devices
  return std::unique_ptr<FrameSource>(std::make_unique<CameraSource>(
      system, calibration.value().format, calibration.value().depth_unit.value_or(kMillimetre),
      request.lock, !request.without_calibration, std::move(first).value(), std::move(second)));
}

std::vector<fs::path> calibration_folders() {
  std::vector<fs::path> folders;
  if (const auto config = user_folder("XDG_CONFIG_HOME", ".config")) {
    folders.push_back(*config / "palpable");
  }
  folders.emplace_back("/usr/local/zed/settings");
  return folders;
}

}  // namespace palpable
