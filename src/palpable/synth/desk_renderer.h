/// @file
/// Draws the synthetic desk as a stereo camera sees it, and the truth of its depth.
///
/// Frames: desk (desk_body.h) and camera (the rectified left eye; geometry/camera.h).
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/synth/desk_scene.h"
#include "palpable/synth/rig.h"
#include "palpable/synth/sequence.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace palpable {

/// Both eyes' pictures as the sensor gives them: distorted, not rectified.
struct RawPair {
  ColorImage left, right;
};

/// What the pictures depend on besides camera and movers.
struct DeskCamera {
  StereoRig rig;  ///< as calibrated
  SensorFaults faults;
  /// The rectified left camera from the raw one, a rotation: whoever rectifies must say.
  Rigid3 camera_from_left = Rigid3::Identity();
};

/// What one frame shows. The shutter is open round the frame's moment, and the middle row is read
/// then, so camera and movers are asked for moments up to half a frame away.
struct DeskMoment {
  int frame = 0;
  std::function<Rigid3(double)> camera_from_desk;
  std::function<Movers(double)> movers;
  RigState rig;
};
[[nodiscard]] DeskMoment moment_of(const Sequence& sequence, int frame);

/// What is true of one frame, in the rectified left camera.
struct DeskTruth {
  DepthImage depth;  ///< Z in m at the pixel centres; NaN where nothing is
  MaskImage labels;  ///< kMovesLabel and kBothSeeLabel, or 0
};
inline constexpr std::uint8_t kMovesLabel = 1;    ///< hand, sleeve, pencil or cup
inline constexpr std::uint8_t kBothSeeLabel = 2;  ///< the right eye sees the same point

/// OpenGL without a screen. Deterministic: the same seed, movers and frame give the same bytes on
/// the same machine. Move-only; use it on the thread that made it.
class DeskRenderer {
 public:
  /// Makes a context and uploads the scene; a second or two. A problem where there is no
  /// OpenGL 4.5.
  static Result<DeskRenderer> make(const DeskCamera& camera, const DeskScene& scene,
                                   const DeskLook& look);
  DeskRenderer(DeskRenderer&&) noexcept;
  DeskRenderer& operator=(DeskRenderer&&) noexcept;
  ~DeskRenderer();

  /// One pair. Motion blur is a mean (exposure.h), with the movers' shadow of its middle; a rolling
  /// shutter is six bands, each with its own moment and turned from row to row within it, each two
  /// with a shadow of the movers. Movers go straight from where they are at first to where they are
  /// at last. The noise depends on the frame's number.
  void draw(const DeskMoment& moment, RawPair& pictures);

  /// Depth and labels at the frame's moment.
  /// @param view      the rectified left camera, at any size
  /// @param baseline  m, of the rectified pair
  void draw_truth(const DeskMoment& moment, const PinholeCamera& view, double baseline,
                  DeskTruth& truth);

  /// Errors that the driver has reported so far: bugs.
  [[nodiscard]] int gl_error_count() const;
  [[nodiscard]] const std::string& gl_description() const;

 private:
  struct State;
  explicit DeskRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
