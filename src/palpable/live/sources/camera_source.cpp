#include "palpable/live/sources/camera_source.h"

#include "palpable/common/base/this_machine.h"
#include "palpable/live/sources/camera_choice.h"
#include "palpable/live/sources/depth_unit.h"
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

constexpr double kStall = 0.5;      // s without a picture until the state is kStalled
constexpr double kReopen = 1.0;     // s between attempts to open a lost device
constexpr double kTogether = 0.6;   // periods; unsynchronized cameras differ by up to 0.5
constexpr int kManyBad = 30;        // pictures
constexpr double kLockAfter = 1.0;  // s, time in which an automatic exposure settles

class CameraSource final : public FrameSource {
 public:
  // @param keeps_yuyv  pass YUYV pictures of both eyes on unconverted
  CameraSource(VideoSystem& system, FrameFormat format, std::vector<std::string> notes, bool lock,
               bool keeps_yuyv, V4l2Camera first, std::optional<V4l2Camera> second)
      : system_(system),
        format_(std::move(format)),
        keeps_yuyv_(keeps_yuyv && format_.width % 2 == 0),
        is_locked_(!lock),
        wants_lock_(lock),
        first_(std::move(first)),
        second_(std::move(second)),
        notes_(std::move(notes)),
        last_picture_(system.now()) {}

  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return -1; }
  std::string last_trouble() const override { return trouble_; }
  std::vector<std::string> take_notes() override {
    append_notes(first_);
    if (second_) append_notes(*second_);
    return std::exchange(notes_, {});
  }
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
    bad_row_ = 0;
    if (!running_from_) running_from_ = frame.time;
    if (!is_locked_ && frame.time - *running_from_ > kLockAfter && is_exposure_settled()) lock();
    return FrameStatus::kFrame;
  }

 private:
  void append_notes(V4l2Camera& camera) {
    for (std::string& note : camera.take_notes()) notes_.push_back(std::move(note));
  }

  // Whether exposures will no longer be shortened because they lower the rate. A lock before would
  // keep the long ones.
  bool is_exposure_settled() const {
    return first_.is_rate_known() && (!second_ || second_->is_rate_known());
  }

  std::string convert(const V4l2Camera& camera, bool is_first) {
    const RawPicture& raw = camera.picture();
    if (!is_first) {
      return format_.kind == FrameFormat::Kind::kColorDepth
                 ? to_depth(raw, format_.depth_unit, depth_)
                 : to_color(raw, right_);
    }
    if (second_) return to_color(raw, left_);
    if (is_interleaved_format(raw.format)) return to_eyes(raw, left_, right_);
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
    if (++bad_row_ == kManyBad) {
      notes_.push_back(
          fmt::format("{} pictures in a row cannot be used, the last because {}: another cable or "
                      "USB port, without a hub, or a lower --size or --fps",
                      kManyBad, trouble_));
    }
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
  int bad_row_ = 0;                     // unusable pictures since the last frame
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
  Result<SourceCalibration> read = read_source_calibration(
      path, eye.width, eye.height,
      has_depth ? FrameFormat::Kind::kColorDepth : FrameFormat::Kind::kStereo);
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
  if (auto problem = problem_with(read.value(), request.baselines)) return *problem;
  return read;
}

// Returns what the user should know of the unit.
std::vector<std::string> decide_unit(const CameraRequest& request, const CameraInfo& depth,
                                     SourceCalibration& calibration) {
  const std::string& name = depth.product.empty() ? depth.name : depth.product;
  std::vector<std::string> notes = decide_depth_unit({.asked = request.depth_unit,
                                                      .calibration = calibration.depth_unit,
                                                      .known = known_depth_unit(name),
                                                      .known_of = name},
                                                     depth.path, calibration.format);
  if (calibration.format.depth_unit_assumed && name.find("RealSense") != std::string::npos) {
    notes.back() += "; a RealSense D405 has 0.1mm, an L515 0.25mm";
  }
  return notes;
}

}  // namespace

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
  Result<CameraChoice> choice = choose_camera(request, system);
  if (!choice.ok()) return choice.problem();
  const CameraInfo& info = choice.value().first;
  if (request.lock && !info.has_exposure && !info.has_gain) {
    return Problem{
        fmt::format("{} has neither exposure nor gain that can be locked", request.device)};
  }
  Result<SourceCalibration> calibration =
      calibration_of_camera(request, info.name, choice.value().eye);
  if (!calibration.ok()) {
    // The camera's own size was taken: a calibration may be known for a larger one.
    const bool own_size = request.width == 0 && request.calibration.empty();
    return Problem{calibration.problem().message + (own_size ? usb_hint(info.usb) : "")};
  }
  std::vector<std::string> notes = std::move(choice.value().notes);
  if (!request.depth.empty()) {
    for (std::string& note : decide_unit(request, *choice.value().second, calibration.value())) {
      notes.push_back(std::move(note));
    }
  }

  Result<V4l2Camera> first = V4l2Camera::open(system, info.path, choice.value().first_settings);
  if (!first.ok()) return first.problem();
  std::optional<V4l2Camera> second;
  if (const auto& other = choice.value().second) {
    Result<V4l2Camera> opened =
        V4l2Camera::open(system, other->path, choice.value().second_settings);
    if (!opened.ok()) return opened.problem();
    second = std::move(opened).value();
  }
  return std::unique_ptr<FrameSource>(std::make_unique<CameraSource>(
      system, calibration.value().format, std::move(notes), request.lock,
      !request.without_calibration, std::move(first).value(), std::move(second)));
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
