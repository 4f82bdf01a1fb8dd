#include "palpable/live/sources/v4l2_camera.h"

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

constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::uint32_t kBuffers = 4;
constexpr std::uint32_t kMostEntries = 1000;  // of any list; a device's list may be endless

std::string text_from(const __u8* text, std::size_t size) {
  const auto* begin = reinterpret_cast<const char*>(text);
  return {begin, std::find(begin, begin + size, '\0')};
}

std::string reason(int error) {
  if (error == EBUSY) return "another program is using it";
  return std::strerror(error);
}

Problem cannot_open(const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    return Problem{
        fmt::format("{} may not be opened: cameras belong to the group video; run "
                    "'sudo usermod -aG video $USER' and log in again",
                    path)};
  }
  if (error == ENOENT || error == ENODEV || error == ENXIO) {
    return Problem{
        fmt::format("there is no camera {}: palpable cameras lists those that are there", path)};
  }
  return Problem{fmt::format("{} cannot be opened: {}", path, reason(error))};
}

template <class T>
T zeroed() {
  T value;
  std::memset(&value, 0, sizeof value);
  return value;
}

bool has_control(VideoSystem& system, int device, std::uint32_t id) {
  auto query = zeroed<v4l2_queryctrl>();
  query.id = id;
  return system.control(device, VIDIOC_QUERYCTRL, &query) == 0 &&
         (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
}

int set_control(VideoSystem& system, int device, std::uint32_t id, int value) {
  auto control = zeroed<v4l2_control>();
  control.id = id;
  control.value = value;
  return system.control(device, VIDIOC_S_CTRL, &control);
}

std::vector<double> rates_of(VideoSystem& system, int device, const CameraMode& mode) {
  std::vector<double> rates;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    auto entry = zeroed<v4l2_frmivalenum>();
    entry.index = i;
    entry.pixel_format = mode.format;
    entry.width = static_cast<std::uint32_t>(mode.width);
    entry.height = static_cast<std::uint32_t>(mode.height);
    if (system.control(device, VIDIOC_ENUM_FRAMEINTERVALS, &entry) != 0) break;
    const bool steps = entry.type != V4L2_FRMIVAL_TYPE_DISCRETE;
    const v4l2_fract& interval = steps ? entry.stepwise.min : entry.discrete;
    if (interval.numerator > 0) {
      rates.push_back(static_cast<double>(interval.denominator) / interval.numerator);
    }
    if (steps) break;
  }
  std::sort(rates.rbegin(), rates.rend());
  return rates;
}

std::vector<CameraMode> modes_of(VideoSystem& system, int device) {
  std::vector<CameraMode> modes;
  for (std::uint32_t f = 0; f < kMostEntries; ++f) {
    auto format = zeroed<v4l2_fmtdesc>();
    format.index = f;
    format.type = kCapture;
    if (system.control(device, VIDIOC_ENUM_FMT, &format) != 0) break;
    if (!is_color_format(format.pixelformat) && !is_depth_format(format.pixelformat)) continue;
    for (std::uint32_t s = 0; s < kMostEntries; ++s) {
      auto size = zeroed<v4l2_frmsizeenum>();
      size.index = s;
      size.pixel_format = format.pixelformat;
      if (system.control(device, VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
      const bool steps = size.type != V4L2_FRMSIZE_TYPE_DISCRETE;
      CameraMode& mode = modes.emplace_back();
      mode.format = format.pixelformat;
      mode.width = static_cast<int>(steps ? size.stepwise.max_width : size.discrete.width);
      mode.height = static_cast<int>(steps ? size.stepwise.max_height : size.discrete.height);
      mode.rates = rates_of(system, device, mode);
      if (steps) break;
    }
  }
  return modes;
}

// Queries an open device.
Result<CameraInfo> query(VideoSystem& system, int device, const std::string& path) {
  auto capability = zeroed<v4l2_capability>();
  if (system.control(device, VIDIOC_QUERYCAP, &capability) != 0) {
    return Problem{fmt::format("{} is no video device", path)};
  }
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                ? capability.device_caps
                                : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    return Problem{fmt::format("{} gives no pictures (it is there for data about them)", path)};
  }
  CameraInfo info;
  info.path = path;
  info.name = text_from(capability.card, sizeof capability.card);
  info.bus = text_from(capability.bus_info, sizeof capability.bus_info);
  info.modes = modes_of(system, device);
  info.has_exposure = has_control(system, device, V4L2_CID_EXPOSURE_ABSOLUTE);
  info.has_gain = has_control(system, device, V4L2_CID_GAIN);
  return info;
}

// Order of preference of formats with equal size and rate: the cheapest conversion first.
int rank(std::uint32_t format) {
  constexpr std::array kOrder{four_letters("YUYV"), four_letters("UYVY"), four_letters("RGB3"),
                              four_letters("BGR3"), four_letters("NV12"), four_letters("GREY"),
                              four_letters("Z16 "), four_letters("Y16 ")};
  return static_cast<int>(std::find(kOrder.begin(), kOrder.end(), format) - kOrder.begin());
}

// The mode for these settings; null if the camera does not have the size.
const CameraMode* choose(const CameraInfo& info, const CameraSettings& settings) {
  const double wanted = settings.frames_per_second;
  const auto rate = [&](const CameraMode& mode) {
    const double fastest = mode.rates.empty() ? 30 : mode.rates.front();
    return wanted > 0 ? std::min(fastest, wanted) : fastest;
  };
  const CameraMode* best = nullptr;
  for (const CameraMode& mode : info.modes) {
    if (is_depth_format(mode.format) != settings.depth) continue;
    if (mode.width != settings.width || mode.height != settings.height) continue;
    const bool better = best == nullptr || rate(mode) > rate(*best) + 0.1 ||
                        (rate(mode) > rate(*best) - 0.1 && rank(mode.format) < rank(best->format));
    if (better) best = &mode;
  }
  return best;
}

std::string sizes_of(const CameraInfo& info, bool depth) {
  std::string text;
  for (const CameraMode& mode : info.modes) {
    const std::string size = fmt::format("{}x{}", mode.width, mode.height);
    if (is_depth_format(mode.format) != depth || text.find(size) != std::string::npos) continue;
    text += (text.empty() ? "" : ", ") + size;
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Result<CameraInfo> query_camera(VideoSystem& system, const std::string& path) {
  const int device = system.open(path);
  if (device < 0) return cannot_open(path, -device);
  Result<CameraInfo> info = query(system, device, path);
  system.close(device);
  return info;
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
  double rate = 30;
  double time = 0;
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
    if (device < 0) return cannot_open(path, -std::exchange(device, -1));
    std::optional<Problem> problem = set_up();
    if (problem) close();
    return problem;
  }

  std::optional<Problem> set_up() {
    const Result<CameraInfo> info = query(system, device, path);
    if (!info.ok()) return info.problem();
    if (settings.width == 0) { return Problem{fmt::format("{}: no size is asked for", path)}; }
    const CameraMode* mode = choose(info.value(), settings);
    if (mode == nullptr) {
      return Problem{fmt::format("{} has no {} of {}x{} px; it has {}", path,
                                 settings.depth ? "depth" : "pictures", settings.width,
                                 settings.height, sizes_of(info.value(), settings.depth))};
    }
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
                                 reason(error))};
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
    for (const double r : mode.rates) {
      if (settings.frames_per_second > 0 &&
          std::abs(r - settings.frames_per_second) < std::abs(rate - settings.frames_per_second)) {
        rate = r;
      }
    }
    auto parameters = zeroed<v4l2_streamparm>();
    parameters.type = kCapture;
    parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(1000 * rate + 0.5)};
    if (system.control(device, VIDIOC_S_PARM, &parameters) != 0) return std::nullopt;
    const v4l2_fract& got = parameters.parm.capture.timeperframe;
    if (got.numerator > 0 && got.denominator > 0) {
      rate = static_cast<double>(got.denominator) / got.numerator;
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
      return Problem{fmt::format("{} does not start: {}", path, reason(error))};
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
    int type = kCapture;
    if (const int error = system.control(device, VIDIOC_STREAMON, &type)) return refuse(error);
    before_loss = sequence + 1;
    first_seen.reset();
    return std::nullopt;
  }

  int give_back(std::uint32_t index) {
    auto buffer = zeroed<v4l2_buffer>();
    buffer.index = index;
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    return system.control(device, VIDIOC_QBUF, &buffer);
  }

  Grab gone(int error) {
    trouble = fmt::format("{}: {}", path, reason(error));
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
    return (newest.flags & V4L2_BUF_FLAG_ERROR) != 0 ? Grab::kBroken : Grab::kPicture;
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
    time = stamp > 0 ? stamp : system.now();
    trouble = "the device says that the picture is damaged";
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
double V4l2Camera::time() const { return parts_->time; }
int V4l2Camera::sequence() const { return parts_->sequence; }
const std::string& V4l2Camera::trouble() const { return parts_->trouble; }
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
