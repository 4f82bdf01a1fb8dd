/// @file
/// One video device: what it can do, and its pictures (Linux, V4L2; UVC cameras among them).
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

/// Asks a device what it is and can do. A problem names the device and says that it does not exist,
/// is no camera (a node for metadata, an encoder) or may not be opened (and to join the group
/// `video`).
[[nodiscard]] Result<CameraInfo> ask_camera(VideoSystem& system, const std::string& path);

/// How one device is to be set.
struct CameraSettings {
  int width = 0;   ///< px of the whole picture; both eyes' when they come side by side
  int height = 0;  ///< px
  double frames_per_second = 0;       ///< 0: as fast as it can
  std::optional<double> exposure_ms;  ///< fixed; nothing: left to the camera
  std::optional<double> gain;         ///< in the camera's own unit
  bool depth = false;                 ///< a depth format instead of a colour one
};

/// A device that streams into memory shared with it. After a loss call reopen() until it is back.
class V4l2Camera {
 public:
  enum class Grab {
    kPicture,  ///< picture() is new
    kNothing,  ///< none came in time
    kBroken,   ///< one came, and the device says it is damaged
    kGone      ///< the device is not there any more, and closed
  };

  /// Opens, sets size, rate, exposure and gain, and starts the stream. A problem names the device
  /// and the sizes that it has instead, or says that another program uses it.
  [[nodiscard]] static Result<V4l2Camera> open(VideoSystem& system, const std::string& path,
                                               const CameraSettings& settings);
  V4l2Camera(V4l2Camera&&) noexcept;
  V4l2Camera& operator=(V4l2Camera&&) noexcept;
  ~V4l2Camera();

  /// Waits up to `seconds` for a picture; if several have come, gives the newest.
  [[nodiscard]] Grab grab(double seconds);
  /// Valid until the next call of grab().
  [[nodiscard]] const RawPicture& picture() const;
  /// When the picture was taken: s, by the driver's clock or, if it has none, the system's.
  [[nodiscard]] double time() const;
  /// Number of the picture; pictures that the device took but grab() did not give are counted too.
  [[nodiscard]] int sequence() const;

  /// After kGone: opens the device again with the same settings; false while it is not there.
  [[nodiscard]] bool reopen();
  /// Why the device failed last.
  [[nodiscard]] const std::string& trouble() const;

  /// Switches automatic exposure, gain and white balance off and keeps their present values.
  /// @return which of them the camera cannot hold; empty when it holds all
  [[nodiscard]] std::string lock();

  /// As the device says; 30 if it does not.
  [[nodiscard]] double frames_per_second() const;

 private:
  struct Parts;
  explicit V4l2Camera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
