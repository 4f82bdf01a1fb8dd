/// @file
/// Draws the synthetic desk as a stereo camera sees it, and the truth of its depth.
///
/// Frames: desk (press_clip.h) and camera (the rectified left eye; geometry/camera.h).
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/synth/desk_scene.h"
#include "palpable/synth/rig.h"

#include <cstdint>
#include <memory>
#include <span>

namespace palpable {

/// Both eyes' pictures as the sensor gives them: distorted, not rectified.
struct RawPair {
  ColorImage left, right;
};

/// What the pictures depend on besides the hand.
struct DeskCamera {
  StereoRig rig;  ///< as calibrated
  SensorFaults faults;
  /// The rectified left camera from the raw one, a rotation: whoever rectifies must say.
  Rigid3 camera_from_left = Rigid3::Identity();
};

/// OpenGL without a screen. Deterministic: the same seed, hand and frame give the same bytes on the
/// same machine. Move-only; use it on the thread that made it.
class DeskRenderer {
 public:
  /// Makes a context and uploads the scene; a second or two. A problem where there is no
  /// OpenGL 4.5.
  static Result<DeskRenderer> make(const DeskCamera& camera, const DeskScene& scene,
                                   std::uint64_t seed);
  DeskRenderer(DeskRenderer&&) noexcept;
  DeskRenderer& operator=(DeskRenderer&&) noexcept;
  ~DeskRenderer();

  /// One exposure.
  /// @param hand   its capsules in the desk frame; empty for no hand
  /// @param frame  number of the exposure: the noise depends on it
  void draw(const Rigid3& camera_from_desk, std::span<const HandCapsule> hand, int frame,
            RawPair& pictures);

  /// Z in the rectified left camera at the pixel centres of `view`, of the desk's surfaces and the
  /// hand; NaN where nothing is.
  void draw_depth(const Rigid3& camera_from_desk, std::span<const HandCapsule> hand,
                  const PinholeCamera& view, DepthImage& depth);

  /// Errors that the driver has reported so far: bugs.
  [[nodiscard]] int gl_error_count() const;
  [[nodiscard]] const std::string& gl_description() const;

 private:
  struct State;
  explicit DeskRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
