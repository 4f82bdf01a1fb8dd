#include "palpable/live/sources/camera_info.h"

#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/v4l2_calls.h"

#include <fmt/core.h>

#include <algorithm>

namespace palpable {
namespace {

constexpr std::uint32_t kMostEntries = 1000;  // of any list; a device's list may be endless

std::string text_from(const __u8* text, std::size_t size) {
  const auto* begin = reinterpret_cast<const char*>(text);
  return {begin, std::find(begin, begin + size, '\0')};
}

double rate_of(const v4l2_fract& interval) {
  if (interval.numerator == 0) return 0;
  return static_cast<double>(interval.denominator) / interval.numerator;
}

void query_rates(VideoSystem& system, int device, CameraMode& mode) {
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    auto entry = zeroed<v4l2_frmivalenum>();
    entry.index = i;
    entry.pixel_format = mode.format;
    entry.width = static_cast<std::uint32_t>(mode.width);
    entry.height = static_cast<std::uint32_t>(mode.height);
    if (system.control(device, VIDIOC_ENUM_FRAMEINTERVALS, &entry) != 0) break;
    mode.has_rates_between = entry.type != V4L2_FRMIVAL_TYPE_DISCRETE;
    if (mode.has_rates_between) {
      mode.rates = {rate_of(entry.stepwise.min), rate_of(entry.stepwise.max)};
      break;
    }
    mode.rates.push_back(rate_of(entry.discrete));
  }
  std::erase(mode.rates, 0);
  std::sort(mode.rates.rbegin(), mode.rates.rend());
}

SizeSteps steps_of(const v4l2_frmsize_stepwise& size) {
  return {static_cast<int>(size.min_width), static_cast<int>(size.min_height),
          std::max(1, static_cast<int>(size.step_width)),
          std::max(1, static_cast<int>(size.step_height))};
}

std::vector<CameraMode> modes_of(VideoSystem& system, int device) {
  std::vector<CameraMode> modes;
  for (std::uint32_t f = 0; f < kMostEntries; ++f) {
    auto format = zeroed<v4l2_fmtdesc>();
    format.index = f;
    format.type = kCapture;
    if (system.control(device, VIDIOC_ENUM_FMT, &format) != 0) break;
    if (!is_color_format(format.pixelformat) && !is_depth_format(format.pixelformat) &&
        !is_interleaved_format(format.pixelformat) && !is_gray16_format(format.pixelformat)) {
      continue;
    }
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
      if (steps) mode.steps = steps_of(size.stepwise);
      query_rates(system, device, mode);
      if (steps) break;
    }
  }
  return modes;
}

bool gives_pictures(const v4l2_capability& capability) {
  const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                ? capability.device_caps
                                : capability.capabilities;
  return (can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0;
}

}  // namespace

bool has_size(const CameraMode& mode, int width, int height) {
  if (!mode.steps) return width == mode.width && height == mode.height;
  const SizeSteps& s = *mode.steps;
  return width >= s.least_width && width <= mode.width && height >= s.least_height &&
         height <= mode.height && (width - s.least_width) % s.width_step == 0 &&
         (height - s.least_height) % s.height_step == 0;
}

Result<CameraInfo> query_open_device(VideoSystem& system, int device, const std::string& path) {
  auto capability = zeroed<v4l2_capability>();
  if (system.control(device, VIDIOC_QUERYCAP, &capability) != 0) {
    return Problem{fmt::format("{} is no video device", path)};
  }
  if (!gives_pictures(capability)) {
    return Problem{fmt::format("{} gives no pictures (it is there for data about them)", path)};
  }
  CameraInfo info;
  info.path = path;
  info.name = text_from(capability.card, sizeof capability.card);
  info.bus = text_from(capability.bus_info, sizeof capability.bus_info);
  info.product = system.product(path);
  info.usb = system.usb_link(path);
  info.modes = modes_of(system, device);
  info.has_exposure = has_control(system, device, V4L2_CID_EXPOSURE_ABSOLUTE);
  info.has_gain = has_control(system, device, V4L2_CID_GAIN);
  info.may_slow_down = value_of_control(system, device, kDynamicRate).value_or(0) != 0;
  return info;
}

Result<CameraInfo> query_camera(VideoSystem& system, const std::string& path) {
  const int device = system.open(path);
  if (device < 0) return cannot_open(system, path, -device);
  Result<CameraInfo> info = query_open_device(system, device, path);
  system.close(device);
  return info;
}

bool is_data_device(VideoSystem& system, const std::string& path) {
  const int device = system.open(path);
  if (device < 0) return false;
  auto capability = zeroed<v4l2_capability>();
  const bool answers = system.control(device, VIDIOC_QUERYCAP, &capability) == 0;
  system.close(device);
  return answers && !gives_pictures(capability);
}

std::string usb_hint(const UsbLink& usb) {
  constexpr double kUsb2 = 480;    // Mbit/s
  constexpr double kUsb2Only = 2;  // USB 3 devices on a USB 2 port must state 2.1 (USB 3.2, 9.6.1)
  const bool is_slow = usb.megabits > 0 && usb.megabits <= kUsb2;
  if (!is_slow || (usb.version > 0 && usb.version <= kUsb2Only)) return {};
  return fmt::format(
      "; it is plugged into a USB 2 port, or has a USB 2 cable ({:g} Mbit/s), with which a USB 3 "
      "camera has small sizes only: plug it into a USB 3 port",
      usb.megabits);
}

}  // namespace palpable
