#include "palpable/live/sources/v4l2_camera.h"

#include "palpable/live/sources/picture_clock.h"
#include "palpable/live/sources/picture_rate.h"
#include "palpable/live/sources/v4l2_calls.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <linux/videodev2.h>
#include <utility>

namespace palpable {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr double kShareOfPeriod = 0.6;  // of an exposure that leaves time to read the picture out

// Order of preference of formats with equal size and rate: the cheapest conversion first.
int rank(std::uint32_t format) {
  constexpr std::array kOrder{four_letters("YUYV"), four_letters("UYVY"), four_letters("RGB3"),
                              four_letters("BGR3"), four_letters("NV12"), four_letters("GREY"),
                              four_letters("Z16 "), four_letters("Y16 "), four_letters("Y8I "),
                              four_letters("Y12I")};
  return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), format) - kOrder.begin());
}

// Whether a format is only taken where no other serves. Where a device has both, Z16 is its depth
// and Y16 is not; a RealSense's Y8I is rectified and its Y12I is not.
bool is_second_choice(std::uint32_t format) {
  return is_gray16_format(format) || format == four_letters("Y12I");
}

// The mode for these settings, with their size; empty if the camera does not have the size.
std::optional<CameraMode> choose(const CameraInfo& info, const CameraSettings& settings) {
  const double wanted = settings.frames_per_second;
  const auto rate = [&](const CameraMode& mode) {
    const double fastest = mode.rates.empty() ? 30 : mode.rates.front();
    return wanted > 0 ? std::min(fastest, wanted) : fastest;
  };
  const CameraMode* best = nullptr;
  for (const CameraMode& mode : info.modes) {
    if (!serves(mode.format, settings)) continue;
    if (!has_size(mode, settings.width, settings.height)) continue;
    const bool is_second = is_second_choice(mode.format);
    const bool best_is_second = best != nullptr && is_second_choice(best->format);
    const bool better =
        best == nullptr || (best_is_second && !is_second) ||
        (best_is_second == is_second &&
         (rate(mode) > rate(*best) + 0.1 ||
          (rate(mode) > rate(*best) - 0.1 && rank(mode.format) < rank(best->format))));
    if (better) best = &mode;
  }
  if (best == nullptr) return std::nullopt;
  CameraMode chosen = *best;
  chosen.width = settings.width;
  chosen.height = settings.height;
  return chosen;
}

std::string sizes_of(const CameraInfo& info, const CameraSettings& settings) {
  std::string text;
  for (const CameraMode& mode : info.modes) {
    std::string size = fmt::format("{}x{}", mode.width, mode.height);
    if (mode.steps) {
      size = fmt::format("{}x{} to {}", mode.steps->least_width, mode.steps->least_height, size);
    }
    if (!serves(mode.format, settings) || text.find(size) != std::string::npos) continue;
    text += (text.empty() ? "" : ", ") + size;
  }
  return text.empty() ? "none" : text;
}

}  // namespace

bool serves(std::uint32_t format, const CameraSettings& settings) {
  if (settings.interleaved) return is_interleaved_format(format);
  if (!settings.depth) return is_color_format(format);
  return is_depth_format(format) || (settings.y16_is_depth && is_gray16_format(format));
}

struct V4l2Camera::Parts {
  struct Buffer {
    void* memory = nullptr;
    std::size_t length = 0;
  };

  VideoSystem& system;
  std::string path;
  CameraSettings settings;
  int device = -1;
  std::vector<Buffer> buffers;
  std::optional<std::uint32_t> held;  // index of the buffer that holds `picture`
  RawPicture picture;
  UsbLink usb;
  double rate = 30;
  PictureClock clock;
  PictureRate measured;
  bool is_rate_judged = false;
  bool dynamic_rate_is_off = false;  // since it was switched off here
  std::vector<std::string> notes;
  std::string last_note;
  int sequence = -1;
  int before_loss = 0;                      // value of `sequence` when the device was last opened
  std::optional<std::uint32_t> first_seen;  // the device's number of its first picture
  std::string trouble;

  Parts(VideoSystem& system_of, std::string path_of, const CameraSettings& settings_of)
      : system(system_of), path(std::move(path_of)), settings(settings_of) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() { close(); }

  void close() {
    if (device < 0) return;
    // Other programs find the camera as it was.
    if (dynamic_rate_is_off) static_cast<void>(set_control(system, device, kDynamicRate, 1));
    dynamic_rate_is_off = false;
    int type = kCapture;
    static_cast<void>(system.control(device, VIDIOC_STREAMOFF, &type));
    for (const Buffer& buffer : buffers) system.unmap(buffer.memory, buffer.length);
    buffers.clear();
    held.reset();
    picture = {};
    system.close(device);
    device = -1;
  }

  std::optional<Problem> start() {
    device = system.open(path);
    if (device < 0) return cannot_open(system, path, -std::exchange(device, -1));
    std::optional<Problem> problem = set_up();
    if (problem) close();
    return problem;
  }

  std::optional<Problem> set_up() {
    const Result<CameraInfo> info = query_open_device(system, device, path);
    if (!info.ok()) return info.problem();
    if (settings.width == 0) { return Problem{fmt::format("{}: no size is asked for", path)}; }
    const std::optional<CameraMode> mode = choose(info.value(), settings);
    if (!mode) {
      return Problem{fmt::format("{} has no {} of {}x{} px; it has {}{}", path,
                                 settings.depth ? "depth" : "pictures", settings.width,
                                 settings.height, sizes_of(info.value(), settings),
                                 usb_hint(info.value().usb))};
    }
    usb = info.value().usb;
    picture.by_realsense = info.value().name.find("RealSense") != std::string::npos;
    for (const auto& set : {&Parts::set_format, &Parts::set_rate}) {
      if (auto problem = (this->*set)(*mode)) return problem;
    }
    if (auto problem = set_light()) return problem;
    return start_stream();
  }

  std::optional<Problem> set_format(const CameraMode& mode) {
    auto format = zeroed<v4l2_format>();
    format.type = kCapture;
    format.fmt.pix.width = static_cast<std::uint32_t>(mode.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(mode.height);
    format.fmt.pix.pixelformat = mode.format;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (const int error = system.control(device, VIDIOC_S_FMT, &format)) {
      return Problem{fmt::format("{} cannot be set to {}x{}: {}", path, mode.width, mode.height,
                                 reason(system, path, error))};
    }
    const v4l2_pix_format& got = format.fmt.pix;
    if (got.width != static_cast<std::uint32_t>(mode.width) ||
        got.height != static_cast<std::uint32_t>(mode.height) || got.pixelformat != mode.format) {
      return Problem{fmt::format("{} gives {}x{} {} when asked for {}x{} {}", path, got.width,
                                 got.height, letters_of(got.pixelformat), mode.width, mode.height,
                                 letters_of(mode.format))};
    }
    picture.format = mode.format;
    picture.width = mode.width;
    picture.height = mode.height;
    picture.row_bytes = got.bytesperline > 0 ? got.bytesperline : got.sizeimage / got.height;
    return std::nullopt;
  }

  std::optional<Problem> set_rate(const CameraMode& mode) {
    // The nearest available rate; a camera that cannot set it keeps its own.
    rate = mode.rates.empty() ? 30 : mode.rates.front();
    if (mode.has_rates_between && settings.frames_per_second > 0 && !mode.rates.empty()) {
      rate = std::clamp(settings.frames_per_second, mode.rates.back(), mode.rates.front());
    }
    for (const double r : mode.rates) {
      if (settings.frames_per_second > 0 &&
          std::abs(r - settings.frames_per_second) < std::abs(rate - settings.frames_per_second)) {
        rate = r;
      }
    }
    auto parameters = zeroed<v4l2_streamparm>();
    parameters.type = kCapture;
    parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(1000 * rate + 0.5)};
    if (system.control(device, VIDIOC_S_PARM, &parameters) == 0) {
      const v4l2_fract& got = parameters.parm.capture.timeperframe;
      if (got.numerator > 0 && got.denominator > 0) {
        rate = static_cast<double>(got.denominator) / got.numerator;
      }
    }
    if (is_far_below(rate, settings.frames_per_second)) {
      note(fmt::format(
          "{} offers {:g} pictures a second of {}x{} px, not {:g}; a smaller --size "
          "may have more{}",
          path, rate, mode.width, mode.height, settings.frames_per_second, usb_hint(usb)));
    }
    return std::nullopt;
  }

  std::optional<Problem> set_light() {
    const auto refuse = [&](const char* what) {
      return Problem{fmt::format("{} has no {} that can be set", path, what)};
    };
    if (settings.exposure_ms) {
      if (has_control(system, device, V4L2_CID_EXPOSURE_AUTO) &&
          set_control(system, device, V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL) != 0) {
        return refuse("exposure");
      }
      // The unit is 0.1 ms.
      const int steps = static_cast<int>(std::lround(10 * *settings.exposure_ms));
      if (set_control(system, device, V4L2_CID_EXPOSURE_ABSOLUTE, steps) != 0) {
        return refuse("exposure");
      }
    }
    if (settings.gain) {
      if (has_control(system, device, V4L2_CID_AUTOGAIN)) {
        static_cast<void>(set_control(system, device, V4L2_CID_AUTOGAIN, 0));
      }
      if (set_control(system, device, V4L2_CID_GAIN, static_cast<int>(*settings.gain)) != 0) {
        return refuse("gain");
      }
    }
    return std::nullopt;
  }

  std::optional<Problem> start_stream() {
    const auto refuse = [&](int error) {
      return Problem{fmt::format("{} does not start: {}", path, why_not_started(error))};
    };
    auto request = zeroed<v4l2_requestbuffers>();
    request.count = kBuffers;
    request.type = kCapture;
    request.memory = V4L2_MEMORY_MMAP;
    if (const int error = system.control(device, VIDIOC_REQBUFS, &request)) return refuse(error);
    for (std::uint32_t i = 0; i < request.count; ++i) {
      auto buffer = zeroed<v4l2_buffer>();
      buffer.index = i;
      buffer.type = kCapture;
      buffer.memory = V4L2_MEMORY_MMAP;
      if (const int error = system.control(device, VIDIOC_QUERYBUF, &buffer)) return refuse(error);
      void* memory = system.map(device, buffer.length, buffer.m.offset);
      if (memory == nullptr) return refuse(ENOMEM);
      buffers.push_back({memory, buffer.length});
      if (const int error = give_back(i)) return refuse(error);
    }
    if (buffers.size() < 2) return refuse(ENOMEM);
    clock.start(system.now());  // the first picture may come before the call returns
    int type = kCapture;
    if (const int error = system.control(device, VIDIOC_STREAMON, &type)) return refuse(error);
    before_loss = sequence + 1;
    first_seen.reset();
    measured.restart();
    is_rate_judged = dynamic_rate_is_off = false;
    return std::nullopt;
  }

  std::string why_not_started(int error) {
    if (error != ENOSPC) return reason(system, path, error);
    return fmt::format(
        "USB has no bandwidth left for {}x{} {} at {:g} pictures a second: a lower --size or "
        "--fps, "
        "or another USB port, without a hub; two cameras may need ports of two controllers",
        picture.width, picture.height, letters_of(picture.format), rate);
  }

  int give_back(std::uint32_t index) {
    auto buffer = zeroed<v4l2_buffer>();
    buffer.index = index;
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    return system.control(device, VIDIOC_QBUF, &buffer);
  }

  Grab gone(int error) {
    trouble = fmt::format("{}: {}", path, reason(system, path, error));
    close();
    return Grab::kGone;
  }

  Grab grab(double seconds) {
    if (device < 0) return Grab::kGone;
    if (held) {
      if (const int error = give_back(*std::exchange(held, std::nullopt))) return gone(error);
    }
    const int ready = system.wait(device, seconds);
    if (ready < 0) return gone(ENODEV);
    if (ready == 0) return Grab::kNothing;
    v4l2_buffer newest{};
    for (;;) {
      auto buffer = zeroed<v4l2_buffer>();
      buffer.type = kCapture;
      buffer.memory = V4L2_MEMORY_MMAP;
      const int error = system.control(device, VIDIOC_DQBUF, &buffer);
      if (error == EAGAIN) break;
      if (error != 0) return gone(error);
      if (buffer.index >= buffers.size()) return gone(EIO);
      if (held) {
        if (const int failed = give_back(*held)) return gone(failed);
      }
      held = buffer.index;
      newest = buffer;
    }
    if (!held) return Grab::kNothing;
    show(newest);
    if (!trouble.empty()) return Grab::kBroken;
    measured.add(clock.time(), sequence);
    if (!is_rate_judged && measured.rate()) judge_rate(*measured.rate());
    return Grab::kPicture;
  }

  // Points `picture` to the buffer's memory and sets its time and number.
  void show(const v4l2_buffer& buffer) {
    const Buffer& memory = buffers[buffer.index];
    picture.data = static_cast<const std::uint8_t*>(memory.memory);
    picture.size = std::min<std::size_t>(buffer.bytesused, memory.length);
    if (!first_seen) first_seen = buffer.sequence;
    // Some drivers do not number their pictures; then they are counted here.
    sequence =
        std::max(before_loss + static_cast<int>(buffer.sequence - *first_seen), sequence + 1);
    const double stamp = static_cast<double>(buffer.timestamp.tv_sec) +
                         1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
    clock.add({.stamp = stamp,
               .arrival = system.now(),
               .is_system_clock = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) ==
                                  V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC});
    trouble = clock.trouble();
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) {
      trouble = "the device says that the picture is damaged";
    }
  }

  void judge_rate(double found) {
    is_rate_judged = true;
    if (!is_far_below(found, rate)) return;
    const std::string few =
        fmt::format("{} takes {:.0f} pictures a second, not {:g}", path, found, rate);
    const bool is_dynamic = value_of_control(system, device, kDynamicRate).value_or(0) != 0;
    if (is_dynamic && !dynamic_rate_is_off && set_control(system, device, kDynamicRate, 0) == 0) {
      dynamic_rate_is_off = true;
      is_rate_judged = false;
      measured.restart();
      note(few +
           ": in dim light its exposure is longer. exposure_dynamic_framerate was switched off; "
           "if the picture is dark now, it needs more light");
      return;
    }
    const double period_ms = 1e3 / rate;
    if (settings.exposure_ms && *settings.exposure_ms > period_ms) {
      note(fmt::format("{}: --exposure {:g} is longer than the {:.3g} ms between pictures", few,
                       *settings.exposure_ms, period_ms));
      return;
    }
    note(
        fmt::format("{}: {}more light, or --exposure {:.2g}; if that does not help, another USB "
                    "port, without a hub, or a lower --size; --fps {:.0f} asks for no more",
                    few, dynamic_rate_is_off ? "" : "it may expose longer in dim light: ",
                    kShareOfPeriod * period_ms, found));
  }

  // A camera that is lost and found again and again does not repeat what it said last.
  void note(std::string text) {
    if (text == last_note) return;
    last_note = text;
    notes.push_back(std::move(text));
  }
};

V4l2Camera::V4l2Camera(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
V4l2Camera::V4l2Camera(V4l2Camera&&) noexcept = default;
V4l2Camera& V4l2Camera::operator=(V4l2Camera&&) noexcept = default;
V4l2Camera::~V4l2Camera() = default;

Result<V4l2Camera> V4l2Camera::open(VideoSystem& system, const std::string& path,
                                    const CameraSettings& settings) {
  auto parts = std::make_unique<Parts>(system, path, settings);
  if (auto problem = parts->start()) return *problem;
  return V4l2Camera(std::move(parts));
}

V4l2Camera::Grab V4l2Camera::grab(double seconds) { return parts_->grab(seconds); }
const RawPicture& V4l2Camera::picture() const { return parts_->picture; }
double V4l2Camera::time() const { return parts_->clock.time(); }
int V4l2Camera::sequence() const { return parts_->sequence; }
const std::string& V4l2Camera::trouble() const { return parts_->trouble; }
std::vector<std::string> V4l2Camera::take_notes() { return std::exchange(parts_->notes, {}); }
bool V4l2Camera::is_rate_known() const { return parts_->is_rate_judged; }
std::optional<double> V4l2Camera::measured_rate() const { return parts_->measured.rate(); }
double V4l2Camera::frames_per_second() const { return parts_->rate; }

bool V4l2Camera::reopen() {
  if (parts_->device >= 0) return true;
  const auto problem = parts_->start();
  if (problem) parts_->trouble = problem->message;
  return !problem;
}

std::string V4l2Camera::lock() {
  Parts& p = *parts_;
  if (p.device < 0) return "the camera";
  std::string cannot;
  const auto fail = [&](const char* what) {
    cannot += (cannot.empty() ? "" : ", ") + std::string(what);
  };
  // The present automatic value is read first and written back once the automatic is off.
  const auto hold = [&](std::uint32_t automatic, int off, std::uint32_t value, const char* what) {
    auto now = zeroed<v4l2_control>();
    now.id = value;
    const bool known = p.system.control(p.device, VIDIOC_G_CTRL, &now) == 0;
    const bool is_automatic = has_control(p.system, p.device, automatic);
    if (!known && !is_automatic) return fail(what);
    if (is_automatic && set_control(p.system, p.device, automatic, off) != 0) return fail(what);
    if (known) static_cast<void>(set_control(p.system, p.device, value, now.value));
  };
  hold(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, V4L2_CID_EXPOSURE_ABSOLUTE, "exposure");
  hold(V4L2_CID_AUTOGAIN, 0, V4L2_CID_GAIN, "gain");
  hold(V4L2_CID_AUTO_WHITE_BALANCE, 0, V4L2_CID_WHITE_BALANCE_TEMPERATURE, "white balance");
  return cannot;
}

}  // namespace palpable
