/// @file
/// One video device: its capabilities and its pictures (Linux V4L2, which includes UVC cameras).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/video_system.h"

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
  std::vector<double> rates;  ///< 1/s, the fastest first; empty: unknown
};

struct CameraInfo {
  std::string path;               ///< /dev/video0
  std::string name;               ///< the maker's name for it
  std::string bus;                ///< the connector that it is plugged into
  std::vector<CameraMode> modes;  ///< those with a convertible format
  bool has_exposure = false;
  bool has_gain = false;
};

/// Queries the capabilities of a device. A problem names the device and says that it does
/// not exist, is not a camera (but a metadata node or an encoder), or needs a permission
/// (the group `video`).
[[nodiscard]] Result<CameraInfo> query_camera(VideoSystem& system, const std::string& path);

/// Settings of one device.
struct CameraSettings {
  int width = 0;                 ///< px, of the whole picture, i.e. of both eyes if side by side
  int height = 0;                ///< px
  double frames_per_second = 0;  ///< 0: the fastest
  std::optional<double> exposure_ms;  ///< fixed; empty: automatic
  std::optional<double> gain;         ///< in the camera's own unit
  bool depth = false;                 ///< a depth format instead of a colour one
};

/// A device that streams into shared memory. After a loss, reopen() must be called
/// until it succeeds.
class V4l2Camera {
 public:
  enum class Grab {
    kPicture,  ///< picture() is new
    kNothing,  ///< no picture came in time
    kBroken,   ///< a picture came that the device marked as damaged
    kGone      ///< the device was disconnected and is closed
  };

  /// Opens the device, sets size, rate, exposure and gain, and starts the stream. A problem names
  /// the device and its available sizes, or says that another program uses it.
  [[nodiscard]] static Result<V4l2Camera> open(VideoSystem& system, const std::string& path,
                                               const CameraSettings& settings);
  V4l2Camera(V4l2Camera&&) noexcept;
  V4l2Camera& operator=(V4l2Camera&&) noexcept;
  ~V4l2Camera();

  /// Waits up to `seconds` for a picture; returns the newest if several have come.
  [[nodiscard]] Grab grab(double seconds);
  /// Valid until the next call of grab().
  [[nodiscard]] const RawPicture& picture() const;
  /// Time of the picture, s, by the driver's clock or, without one, the system's.
  [[nodiscard]] double time() const;
  /// Number of the picture, counting pictures that the device took but grab() skipped.
  [[nodiscard]] int sequence() const;

  /// After kGone: opens the device again with the same settings; false while it is not there.
  [[nodiscard]] bool reopen();
  /// The reason of the last failure.
  [[nodiscard]] const std::string& trouble() const;

  /// Switches automatic exposure, gain and white balance off and keeps their present values.
  /// @return the names of those that the camera cannot hold; empty if it holds all
  [[nodiscard]] std::string lock();

  /// 1/s, as stated by the device; 30 if it states none.
  [[nodiscard]] double frames_per_second() const;

 private:
  struct Parts;
  explicit V4l2Camera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
