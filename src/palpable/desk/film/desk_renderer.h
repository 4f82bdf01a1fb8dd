/// @file
/// Films the synthetic desk with a stereo camera: the raw images of both eyes, and the truth of
/// depth.
///
/// Frames: desk (script/desk_body.h) and camera (the rectified left eye; geometry/camera.h).
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/desk/film/desk_moment.h"
#include "palpable/desk/film/desk_scene.h"
#include "palpable/desk/script/rig.h"

#include <cstdint>
#include <memory>
#include <string>

namespace palpable {

/// The images of both eyes as the sensors give them: distorted, not rectified.
struct RawPair {
  ColorImage left, right;
};

/// The stereo camera that films.
struct DeskCamera {
  StereoRig rig;  ///< as calibrated
  SensorFaults faults;
  /// The rectified left camera from the raw left one: a rotation that depends on how the images
  /// will be rectified.
  Rigid3 camera_from_left = Rigid3::Identity();
};

/// The truth of one frame, in the rectified left camera.
struct DeskTruth {
  DepthImage depth;  ///< Z in m at the pixel centres; NaN where there is nothing
  MaskImage labels;  ///< kMovesLabel and kBothSeeLabel (geometry/image.h), or 0
};

/// Draws with OpenGL, without a screen. The same seed, movers and frame give the same bytes on the
/// same machine. Move-only; to be used on the thread that made it.
class DeskRenderer {
 public:
  /// Makes a context and uploads the scene, which takes a second or two. A problem where there is
  /// no OpenGL 4.5.
  static Result<DeskRenderer> make(const DeskCamera& camera, const DeskScene& scene,
                                   const DeskLook& look);
  DeskRenderer(DeskRenderer&&) noexcept;
  DeskRenderer& operator=(DeskRenderer&&) noexcept;
  ~DeskRenderer();

  /// Draws one pair. While a shutter is open, movers go straight from where they are at first to
  /// where they are at last.
  ///
  /// * Motion blur: the mean of several moments (exposure.h); the movers' shadow is that of the
  /// middle
  ///   one.
  /// * Rolling shutter: six bands of rows. Each shows its own moment and is turned from row to row
  /// as
  ///   the camera turns. Two neighbouring bands have the same shadow of the movers.
  ///
  /// The noise depends on seed, eye and the frame's number.
  void draw(const DeskMoment& moment, RawPair& pictures);

  /// Depth and labels at the frame's own moment.
  /// @param view      the rectified left camera, at any size
  /// @param baseline  m, of the rectified pair
  void draw_truth(const DeskMoment& moment, const PinholeCamera& view, double baseline,
                  DeskTruth& truth);

  /// How many errors the driver has reported so far; each is a bug.
  [[nodiscard]] int gl_error_count() const;
  [[nodiscard]] const std::string& gl_description() const;

 private:
  struct State;
  explicit DeskRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
