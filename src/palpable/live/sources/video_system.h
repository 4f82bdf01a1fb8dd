/// @file
/// The operating system's calls for a camera (Linux: V4L2), as an interface, so that the code above
/// can be tested with a simulated camera.
#pragma once

#include "palpable/live/sources/wall_clock.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

/// How a device is connected.
struct UsbLink {
  double megabits = 0;  ///< Mbit/s: 480 is USB 2, 5000 and more USB 3; 0: unknown, or no USB
  /// The version of USB that the device states: at most 2.0, or, of most USB 3 devices on a USB 2
  /// port and of a few newer USB 2 devices, 2.1; 0: unknown.
  double version = 0;
};

/// Like the system's own calls, but errors are returned instead of set in errno.
class VideoSystem : public WallClock {
 public:
  /// Paths of possible cameras in natural order: /dev/video2 before /dev/video10.
  [[nodiscard]] virtual std::vector<std::string> devices() = 0;
  /// The name of the product that a device belongs to, in full; empty if it is not known.
  [[nodiscard]] virtual std::string product(const std::string& path) = 0;
  [[nodiscard]] virtual UsbLink usb_link(const std::string& path) = 0;
  /// The other programs that have opened a device, as far as this user may see them:
  /// "cheese (process 1234)"; empty if there is none, or none can be seen.
  [[nodiscard]] virtual std::string users(const std::string& path) = 0;
  /// A file descriptor, or the negative error number.
  [[nodiscard]] virtual int open(const std::string& path) = 0;
  virtual void close(int device) = 0;
  /// An ioctl: 0, or the error number. Interrupted calls are repeated.
  [[nodiscard]] virtual int control(int device, unsigned long request, void* argument) = 0;
  /// Memory shared with the device; null when that fails.
  [[nodiscard]] virtual void* map(int device, std::size_t length, std::uint32_t offset) = 0;
  virtual void unmap(void* memory, std::size_t length) = 0;
  /// Waits until the device has a picture.
  /// @return 1; 0 after `seconds` without a picture; -1 when the device has failed
  [[nodiscard]] virtual int wait(int device, double seconds) = 0;
};

/// The implementation for this machine.
[[nodiscard]] VideoSystem& linux_video();

}  // namespace palpable
