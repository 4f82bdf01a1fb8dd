/// @file
/// One video device: what it can do, and its pictures (Linux, V4L2; UVC cameras among them).
#pragma once

#include "palpable/base/error.h"
#include "palpable/sources/raw_picture.h"
#include "palpable/sources/video_system.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct CameraMode {
  std::uint32_t format = 0;   ///< four letters
  int width = 0;              ///< px, of the whole picture
  int height = 0;             ///< px
  std::vector<double> rates;  ///< frames per second, the fastest first; empty: it does not say
};

struct CameraInfo {
  std::string path;               ///< /dev/video0
  std::string name;               ///< the maker's
  std::string bus;                ///< where it is plugged in
  std::vector<CameraMode> modes;  ///< those whose format can be converted
  bool has_exposure = false;
  bool has_gain = false;
};

/// Asks a device. A problem names it: it is not there, it is no camera (a network of metadata, an
/// encoder), it may not be opened (then: the group `video`).
[[nodiscard]] Result<CameraInfo> ask_camera(VideoSystem& system, const std::string& path);

/// What is wanted of one device.
struct CameraSettings {
  int width = 0;   ///< px of the whole picture; both eyes' when they come side by side
  int height = 0;  ///< px
  double frames_per_second = 0;       ///< 0: as fast as it can
  std::optional<double> exposure_ms;  ///< fixed; nothing: left to the camera
  std::optional<double> gain;         ///< in the camera's own unit
  bool depth = false;                 ///< a depth format, not a colour one
};

/// A device that streams into memory shared with it. After a loss, reopen() until it is back.
class V4l2Camera {
 public:
  enum class Grab {
    kPicture,  ///< picture() is new
    kNothing,  ///< none came in time
    kBroken,   ///< one came, and the device says it is damaged
    kGone      ///< the device is not there any more, and closed
  };

  /// Opens, sets size, rate, exposure and gain, and starts the stream. A problem names the device
  /// and what it has instead, or what holds it (another program).
  [[nodiscard]] static Result<V4l2Camera> open(VideoSystem& system, const std::string& path,
                                               const CameraSettings& settings);
  V4l2Camera(V4l2Camera&&) noexcept;
  V4l2Camera& operator=(V4l2Camera&&) noexcept;
  ~V4l2Camera();

  /// Waits up to `seconds`; of several pictures takes the newest.
  [[nodiscard]] Grab grab(double seconds);
  /// Valid until the next call of grab().
  [[nodiscard]] const RawPicture& picture() const;
  /// When it was taken: s, by the driver's clock or, where that has none, the system's.
  [[nodiscard]] double time() const;
  /// Counts on by one for each picture that the device took, seen here or not.
  [[nodiscard]] int sequence() const;

  /// Opens the device again after kGone, as it was opened first; false while it is not there.
  [[nodiscard]] bool reopen();
  /// What the device's last failure was.
  [[nodiscard]] const std::string& trouble() const;

  /// Leaves exposure, gain and white balance as the camera has found them by now. What it cannot
  /// hold is named; empty when it holds all.
  [[nodiscard]] std::string lock();

  [[nodiscard]] double frames_per_second()
      const;  ///< as the device promised; 30 if it does not say

 private:
  struct Parts;
  explicit V4l2Camera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
