/// @file
/// The calls of the operating system that a camera needs (Linux: V4L2), so that everything above
/// them can be tested against a camera made of code.
#pragma once

#include "palpable/live/sources/wall_clock.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

/// Like the system's own calls, but errors are returned: callers do not read errno.
class VideoSystem : public WallClock {
 public:
  /// Paths of devices that may be cameras, /dev/video2 before /dev/video10.
  [[nodiscard]] virtual std::vector<std::string> devices() = 0;
  /// A file descriptor, or the error's number with a minus.
  [[nodiscard]] virtual int open(const std::string& path) = 0;
  virtual void close(int device) = 0;
  /// An ioctl: 0, or the error's number. Interrupted ones are made again.
  [[nodiscard]] virtual int control(int device, unsigned long request, void* argument) = 0;
  /// Memory shared with the device; null when that fails.
  [[nodiscard]] virtual void* map(int device, std::size_t length, std::uint32_t offset) = 0;
  virtual void unmap(void* memory, std::size_t length) = 0;
  /// Waits until the device has a picture.
  /// @return 1; 0 after `seconds` without a picture; -1 when the device has failed
  [[nodiscard]] virtual int wait(int device, double seconds) = 0;
};

/// The machine's.
[[nodiscard]] VideoSystem& linux_video();

}  // namespace palpable
