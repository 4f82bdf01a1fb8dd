/// @file
/// The pictures of one video device (Linux V4L2, which includes UVC cameras).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/sources/camera_info.h"
#include "palpable/live/sources/raw_picture.h"
#include "palpable/live/sources/video_system.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Settings of one device.
struct CameraSettings {
  int width = 0;                 ///< px, of the whole picture, i.e. of both eyes if side by side
  int height = 0;                ///< px
  double frames_per_second = 0;  ///< 0: the fastest
  std::optional<double> exposure_ms;  ///< fixed; empty: automatic
  std::optional<double> gain;         ///< in the camera's own unit
  bool depth = false;                 ///< a depth format instead of a colour one
  bool interleaved = false;   ///< a format with both eyes' pixels in turn (is_interleaved_format())
  bool y16_is_depth = false;  ///< with `depth`: Y16 is one, too (is_gray16_format())
};

/// Whether pictures in the format are colours, or, with settings.depth, depths, or, with
/// settings.interleaved, both eyes interleaved.
[[nodiscard]] bool serves(std::uint32_t format, const CameraSettings& settings);

/// A device that streams into shared memory. After a loss, reopen() must be called
/// until it succeeds.
class V4l2Camera {
 public:
  enum class Grab {
    kPicture,  ///< picture() is new
    kNothing,  ///< no picture came in time
    kBroken,   ///< a picture came that the device marked as damaged, or with an impossible time
    kGone      ///< the device was disconnected and is closed
  };

  /// Opens the device, sets size, rate, exposure and gain, and starts the stream. A problem names
  /// the device and its available sizes, or says which other program uses it, or that USB has too
  /// little bandwidth left.
  [[nodiscard]] static Result<V4l2Camera> open(VideoSystem& system, const std::string& path,
                                               const CameraSettings& settings);
  V4l2Camera(V4l2Camera&&) noexcept;
  V4l2Camera& operator=(V4l2Camera&&) noexcept;
  ~V4l2Camera();

  /// Waits up to `seconds` for a picture; returns the newest if several have come.
  [[nodiscard]] Grab grab(double seconds);
  /// Valid until the next call of grab().
  [[nodiscard]] const RawPicture& picture() const;
  /// Time of the picture, s, by the system's clock (picture_clock.h).
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

  /// Notes since the last call: that the camera takes far fewer pictures a second than were set,
  /// and what was done. Automatic exposures lower the rate in dim light if the control
  /// exposure_dynamic_framerate is on; when that has happened it is switched off until the device
  /// is closed.
  [[nodiscard]] std::vector<std::string> take_notes();
  /// Whether enough pictures were seen to know their rate, and nothing will be changed because of
  /// it.
  [[nodiscard]] bool is_rate_known() const;
  /// 1/s, measured; empty until it is known.
  [[nodiscard]] std::optional<double> measured_rate() const;

  /// 1/s, as stated by the device; 30 if it states none.
  [[nodiscard]] double frames_per_second() const;

 private:
  struct Parts;
  explicit V4l2Camera(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable
