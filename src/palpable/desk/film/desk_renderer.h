/// @file
/// Films the synthetic desk with a stereo camera: the raw images of both eyes, and the true depth.
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

/// The images of both eyes as the sensors deliver them: distorted, not rectified.
struct RawPair {
  ColorImage left, right;
};

/// The stereo camera.
struct DeskCamera {
  StereoRig rig;  ///< as calibrated
  SensorFaults faults;
  /// From the raw left camera to the rectified left one: a rotation that depends on the
  /// rectification.
  Rigid3 camera_from_left = Rigid3::Identity();
};

/// The truth of one frame in the rectified left camera.
struct DeskTruth {
  DepthImage depth;  ///< Z in m at the pixel centres; NaN where there is nothing
  MaskImage labels;  ///< kMovesLabel and kBothSeeLabel (geometry/image.h), or 0
};

/// Draws with OpenGL, without a screen. Equal seeds, movers and frames give equal bytes on the same
/// machine. Move-only; to be used only on the thread that made it.
class DeskRenderer {
 public:
  /// Makes a context and uploads the scene, in 1 to 2 s. Returns a problem when OpenGL 4.5 is not
  /// available.
  static Result<DeskRenderer> make(const DeskCamera& camera, const DeskScene& scene,
                                   const DeskLook& look);
  DeskRenderer(DeskRenderer&&) noexcept;
  DeskRenderer& operator=(DeskRenderer&&) noexcept;
  ~DeskRenderer();

  /// Draws one pair. While the shutter is open, movers move linearly between their first and their
  /// last position.
  ///
  /// * Motion blur: the mean of several instants (exposure.h). The shadow of the movers is that of
  ///   the middle of the exposure.
  /// * Rolling shutter: six bands of rows, each painted for its own instant and rotated from row to
  ///   row with the camera. Two neighbouring bands share one shadow of the movers.
  ///
  /// The noise depends on seed, eye and frame number.
  void draw(const DeskMoment& moment, RawPair& pictures);

  /// Draws depth and labels at the frame's own time, the middle of its exposure.
  /// @param view      the rectified left camera, at any size
  /// @param baseline  m, of the rectified pair
  void draw_truth(const DeskMoment& moment, const PinholeCamera& view, double baseline,
                  DeskTruth& truth);

  /// Number of errors that the driver has reported so far; each is a bug in this project.
  [[nodiscard]] int gl_error_count() const;
  [[nodiscard]] const std::string& gl_description() const;

 private:
  struct State;
  explicit DeskRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
