/// @file
/// Simulated cameras behind the interface of real ones (V4L2), with a clock that only advances when
/// the program waits. They stall, vanish, come back, and drop or tear pictures as programmed.
#pragma once

#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/video_system.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <linux/videodev2.h>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpable::test {

struct FakeMode {
  std::uint32_t format;
  int width;
  int height;
  std::vector<int> rates;
  /// All even sizes from 32 x 2 px to this one, and all rates between the first and the last.
  bool has_steps = false;
};

/// A picture that the camera takes at `time`.
struct Shot {
  double time;  ///< s, of the fake clock
  std::vector<std::uint8_t> bytes;
  std::uint32_t flags = 0;
  std::optional<double> stamp = {};  ///< s, the driver's; empty: `time`
};

struct FakeDevice {
  std::string path;
  std::string card = "Fake Camera";
  std::string product = {};  ///< VideoSystem::product()
  std::string bus = {};      ///< the same for all devices of a camera
  UsbLink usb = {};          ///< VideoSystem::usb_link()
  std::string users = {};    ///< VideoSystem::users()
  std::vector<FakeMode> modes;
  std::map<std::uint32_t, int> controls;  ///< available controls and their values
  std::set<std::uint32_t> read_only;      ///< of these controls
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  int open_error = 0;        ///< of open(), e.g. EACCES
  int format_error = 0;      ///< of VIDIOC_S_FMT, e.g. EBUSY
  int start_error = 0;       ///< of VIDIOC_STREAMON, e.g. ENOSPC
  std::deque<Shot> shots;    ///< in order of time
  double gone_from = 1e300;  ///< s; disconnected in [gone_from, gone_until)
  double gone_until = 1e300;
  double set_rate = 0;  ///< 1/s, that the program has set
  bool has_stamps = true;
  bool has_system_clock = true;  ///< what the driver says of its stamps

  /// Adds a picture every 1/rate s; all bytes of picture i are `first + i`.
  void film(double begin, int count, double rate, std::size_t bytes, int first = 1) {
    for (int i = 0; i < count; ++i) {
      shots.push_back({begin + i / rate,
                       std::vector<std::uint8_t>(bytes, static_cast<std::uint8_t>(first + i)),
                       0,
                       {}});
    }
  }
};

class FakeVideo final : public VideoSystem {
 public:
  std::vector<FakeDevice> cameras;
  double time = 100;
  int opened = 0;  ///< devices that are open
  int mapped = 0;  ///< buffers that are mapped

  double now() override { return time; }
  void sleep(double seconds) override { time += seconds; }

  std::vector<std::string> devices() override {
    std::vector<std::string> paths;
    for (const FakeDevice& camera : cameras) paths.push_back(camera.path);
    return paths;
  }

  std::string product(const std::string& path) override {
    const FakeDevice* camera = at(path);
    return camera != nullptr ? camera->product : std::string();
  }

  UsbLink usb_link(const std::string& path) override {
    const FakeDevice* camera = at(path);
    return camera != nullptr ? camera->usb : UsbLink{};
  }
  std::string users(const std::string& path) override {
    const FakeDevice* camera = at(path);
    return camera != nullptr ? camera->users : std::string();
  }

  int open(const std::string& path) override {
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      if (cameras[i].path != path) continue;
      if (cameras[i].open_error != 0) return -cameras[i].open_error;
      if (away(cameras[i])) return -ENOENT;
      ++opened;
      open_.emplace_back(std::make_unique<Open>());
      open_.back()->camera = i;
      return static_cast<int>(open_.size()) - 1 + kFirst;
    }
    return -ENOENT;
  }
  void close(int device) override {
    --opened;
    open_[index(device)]->is_open = false;
  }

  int control(int device, unsigned long request, void* argument) override {
    Open& open = *open_[index(device)];
    FakeDevice& camera = cameras[open.camera];
    if (!open.is_open) return EBADF;
    if (away(camera) || open.lost) {
      open.lost = true;  // after it has come back it is a new device
      return ENODEV;
    }
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& c = *static_cast<v4l2_capability*>(argument);
        std::memcpy(c.card, camera.card.c_str(), std::min<std::size_t>(camera.card.size(), 31));
        std::memcpy(c.bus_info, camera.bus.c_str(), std::min<std::size_t>(camera.bus.size(), 31));
        c.capabilities = camera.capabilities | V4L2_CAP_DEVICE_CAPS;
        c.device_caps = camera.capabilities;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto& f = *static_cast<v4l2_fmtdesc*>(argument);
        const std::vector<std::uint32_t> formats = formats_of(camera);
        if (f.index >= formats.size()) return EINVAL;
        f.pixelformat = formats[f.index];
        return 0;
      }
      case VIDIOC_ENUM_FRAMESIZES: {
        auto& s = *static_cast<v4l2_frmsizeenum*>(argument);
        std::uint32_t n = 0;
        for (const FakeMode& mode : camera.modes) {
          if (mode.format != s.pixel_format || n++ != s.index) continue;
          if (mode.has_steps) {
            s.type = V4L2_FRMSIZE_TYPE_STEPWISE;
            s.stepwise = {kLeastWidth,  static_cast<std::uint32_t>(mode.width),  kStep,
                          kLeastHeight, static_cast<std::uint32_t>(mode.height), kStep};
            return 0;
          }
          s.type = V4L2_FRMSIZE_TYPE_DISCRETE;
          s.discrete.width = static_cast<std::uint32_t>(mode.width);
          s.discrete.height = static_cast<std::uint32_t>(mode.height);
          return 0;
        }
        return EINVAL;
      }
      case VIDIOC_ENUM_FRAMEINTERVALS: {
        auto& r = *static_cast<v4l2_frmivalenum*>(argument);
        const FakeMode* mode = mode_of(camera, r.pixel_format, r.width, r.height);
        if (mode == nullptr || r.index >= mode->rates.size()) return EINVAL;
        if (mode->has_steps) {
          r.type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
          r.stepwise.min = {1, static_cast<std::uint32_t>(mode->rates.front())};
          r.stepwise.max = {1, static_cast<std::uint32_t>(mode->rates.back())};
          return 0;
        }
        r.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        r.discrete = {1, static_cast<std::uint32_t>(mode->rates[r.index])};
        return 0;
      }
      case VIDIOC_QUERYCTRL: {
        const auto& q = *static_cast<v4l2_queryctrl*>(argument);
        return camera.controls.contains(q.id) ? 0 : EINVAL;
      }
      case VIDIOC_S_CTRL:
      case VIDIOC_G_CTRL: {
        auto& c = *static_cast<v4l2_control*>(argument);
        const auto found = camera.controls.find(c.id);
        if (found == camera.controls.end()) return EINVAL;
        if (request == VIDIOC_S_CTRL && camera.read_only.contains(c.id)) return EACCES;
        (request == VIDIOC_S_CTRL ? found->second : c.value) =
            request == VIDIOC_S_CTRL ? c.value : found->second;
        return 0;
      }
      case VIDIOC_S_FMT: {
        auto& f = static_cast<v4l2_format*>(argument)->fmt.pix;
        const FakeMode* mode = mode_of(camera, f.pixelformat, f.width, f.height);
        if (mode == nullptr) return EINVAL;
        if (camera.format_error != 0) return camera.format_error;
        const std::uint32_t bytes = mode->format == four_letters("GREY")   ? 1
                                    : mode->format == four_letters("Y12I") ? 3
                                                                           : 2;
        f.bytesperline = mode->format == four_letters("MJPG") ? 0 : bytes * f.width;
        f.sizeimage = bytes * f.width * f.height;
        open.size = f.sizeimage;
        return 0;
      }
      case VIDIOC_S_PARM: {
        const v4l2_fract& t = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
        camera.set_rate = static_cast<double>(t.denominator) / t.numerator;
        return 0;
      }
      case VIDIOC_REQBUFS: {
        auto& r = *static_cast<v4l2_requestbuffers*>(argument);
        open.memory.assign(r.count, std::vector<std::uint8_t>(open.size));
        open.filled.assign(r.count, {});
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& b = *static_cast<v4l2_buffer*>(argument);
        b.length = open.size;
        b.m.offset = b.index;
        return 0;
      }
      case VIDIOC_QBUF:
        open.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_STREAMON:
        if (camera.start_error != 0) return camera.start_error;
        open.streams = true;
        // Pictures from before the start of the stream are lost.
        while (!camera.shots.empty() && camera.shots.front().time < time) camera.shots.pop_front();
        return 0;
      case VIDIOC_STREAMOFF:
        open.streams = false;
        return 0;
      case VIDIOC_DQBUF: {
        deliver(open, camera);
        if (open.done.empty()) return EAGAIN;
        auto& b = *static_cast<v4l2_buffer*>(argument);
        const std::uint32_t i = open.done.front();
        open.done.pop_front();
        b = open.filled[i];
        return 0;
      }
      default:
        return ENOTTY;
    }
  }

  void* map(int device, std::size_t, std::uint32_t offset) override {
    ++mapped;
    return open_[index(device)]->memory[offset].data();
  }
  void unmap(void*, std::size_t) override { --mapped; }

  int wait(int device, double seconds) override {
    Open& open = *open_[index(device)];
    FakeDevice& camera = cameras[open.camera];
    const double until = time + seconds;
    if (!away(camera)) {
      deliver(open, camera);
      if (!open.done.empty()) return 1;
      const double next = camera.shots.empty() ? 1e300 : camera.shots.front().time;
      if (next <= until && (next < camera.gone_from || time >= camera.gone_until)) {
        time = std::max(time, next);
        deliver(open, camera);
        return 1;
      }
    }
    if (away(camera) || open.lost) return -1;
    time = until;
    return away(camera) ? -1 : 0;
  }

 private:
  struct Open {
    std::size_t camera = 0;
    bool is_open = true;
    bool lost = false;
    bool streams = false;
    std::uint32_t size = 0;
    std::uint32_t taken = 7;  // a driver's numbering need not begin at 0
    std::vector<std::vector<std::uint8_t>> memory;
    std::vector<v4l2_buffer> filled;
    std::deque<std::uint32_t> queued;
    std::deque<std::uint32_t> done;
  };

  const FakeDevice* at(const std::string& path) const {
    const auto found = std::find_if(cameras.begin(), cameras.end(),
                                    [&](const FakeDevice& camera) { return camera.path == path; });
    return found != cameras.end() ? &*found : nullptr;
  }

  static constexpr int kFirst = 3;
  static constexpr std::uint32_t kLeastWidth = 32;
  static constexpr std::uint32_t kLeastHeight = 2;
  static constexpr std::uint32_t kStep = 2;
  static std::size_t index(int device) { return static_cast<std::size_t>(device - kFirst); }
  bool away(const FakeDevice& camera) const {
    return time >= camera.gone_from && time < camera.gone_until;
  }
  static std::vector<std::uint32_t> formats_of(const FakeDevice& camera) {
    std::vector<std::uint32_t> formats;
    for (const FakeMode& mode : camera.modes) {
      if (std::find(formats.begin(), formats.end(), mode.format) == formats.end()) {
        formats.push_back(mode.format);
      }
    }
    return formats;
  }
  static const FakeMode* mode_of(const FakeDevice& camera, std::uint32_t format,
                                 std::uint32_t width, std::uint32_t height) {
    for (const FakeMode& mode : camera.modes) {
      const int w = static_cast<int>(width);
      const int h = static_cast<int>(height);
      const bool between = mode.has_steps && w >= static_cast<int>(kLeastWidth) &&
                           w <= mode.width && h >= static_cast<int>(kLeastHeight) &&
                           h <= mode.height;
      const bool same = mode.width == w && mode.height == h;
      if (mode.format == format && (same || between)) return &mode;
    }
    return nullptr;
  }

  // As a kernel does: a picture fills the next queued buffer, and is lost if there is none.
  void deliver(Open& open, FakeDevice& camera) const {
    while (open.streams && !camera.shots.empty() && camera.shots.front().time <= time) {
      const Shot shot = std::move(camera.shots.front());
      camera.shots.pop_front();
      const std::uint32_t number = open.taken++;
      if (open.queued.empty()) continue;
      const std::uint32_t i = open.queued.front();
      open.queued.pop_front();
      std::copy_n(shot.bytes.begin(), std::min(shot.bytes.size(), open.memory[i].size()),
                  open.memory[i].begin());
      v4l2_buffer& b = open.filled[i];
      b = {};
      b.index = i;
      b.bytesused = static_cast<std::uint32_t>(shot.bytes.size());
      b.sequence = number;
      b.flags = shot.flags;
      if (camera.has_system_clock) b.flags |= V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
      if (camera.has_stamps) {
        const double stamp = shot.stamp.value_or(shot.time);
        b.timestamp.tv_sec = static_cast<long>(stamp);
        b.timestamp.tv_usec =
            static_cast<long>(1e6 * (stamp - static_cast<double>(b.timestamp.tv_sec)));
      }
      open.done.push_back(i);
    }
  }

  std::vector<std::unique_ptr<Open>> open_;
};

}  // namespace palpable::test
