/// @file
/// Draws a scene: the camera's image with the body in it, hidden where something real is nearer
/// (paper Sec. 3.5, Fig. 9), its stress as colours (Fig. 16).
///
///   V  vertices     T  triangles
///
/// Camera frame: X right, Y down, Z forward, m. Depths are compared as Z in that frame.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/render/color_map.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The colour of natural rubber, sRGB.
inline constexpr Rgb kRubber{218, 205, 182};

/// A small ball on a body that marks the middle of a contact site or a touched point.
struct Dot {
  Eigen::Vector3f at_in_body = Eigen::Vector3f::Zero();  ///< m
  float radius = 0.002f;                                 ///< m
  Rgb color{240, 120, 20};
};

/// Where a lamp usually is: above, a little to the left and behind the camera, so that visible
/// sides are lit. Camera frame, unit. @param up  of the scene, likewise
[[nodiscard]] inline Eigen::Vector3d usual_lamp(const Eigen::Vector3d& up) {
  return (0.85 * up + Eigen::Vector3d(-0.55, 0.0, -0.45)).normalized();
}

/// The light that bodies are drawn in, and that they keep from what is real.
struct SceneLight {
  /// Towards the lamp: camera frame, unit. Nothing: usual_lamp() above each body.
  std::optional<Eigen::Vector3f> to_lamp = {};
  float lamp = 1;                                   ///< its strength; 1: a window beside the desk
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  ///< linear R, G, B of all; 1: a well lit room
};

/// An arrow over everything that is drawn, and a text at its tail.
struct Arrow {
  Eigen::Vector3d tail = Eigen::Vector3d::Zero();  ///< m, camera frame
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();   ///< likewise
  Rgb color{240, 120, 20};
  std::string label;  ///< UTF-8 (Latin)
};

/// One body as plain arrays. Pointers and spans are read during draw() only; none of the pointers
/// may be null.
struct BodyLook {
  const Eigen::Matrix3Xf* vertices = nullptr;   ///< (3 x V) body frame, m, as it is now
  const Eigen::Matrix3Xf* normals = nullptr;    ///< (3 x V) body frame, unit, outwards
  const Eigen::Matrix3Xi* triangles = nullptr;  ///< (3 x T) counter-clockwise from outside
  Rgb material = kRubber;                       ///< its own colour
  std::span<const float> scalar;                ///< (V) what is painted on it; empty: nothing is
  float scalar_max = 1;                         ///< > 0: upper end of the colour scale, as `scalar`
  bool two_sided = false;  ///< its lower end is -scalar_max, else 0 (color_map.h)
  /// Low values let the material's own colour through (color_map.h); false: the scale alone.
  bool blended = true;
  /// The share of the scale from which paint covers the material wholly.
  [[nodiscard]] float opaque_share() const {
    if (scalar.empty()) return kNothingPainted;
    return blended ? kOpaqueShare : 0.0f;
  }
  std::span<const float> marks;  ///< (V) painted in mark_color where > 0.5; or empty
  Rgb mark_color{250, 208, 60};
  std::span<const Dot> dots;
  Rigid3 camera_from_body = Rigid3::Identity();
  /// Darkness of the shadow on the body's plane Z = 0 and on what real stands on it, from 0 (none)
  /// to 1. Pixels whose real depth is unknown are taken to show the plane.
  float shadow = 0.5f;
};

/// Content of one picture.
struct SceneView {
  const ColorImage* background = nullptr;  ///< camera size; null: a plain grey
  /// Z of the real scene in m, NaN where unknown. It may have another size than the picture, with
  /// the same field of view (camera.scaled_down(2), say). Null: nothing real hides the body.
  const DepthImage* real_depth = nullptr;
  /// Of the size of `real_depth`, or null: 255 where something moves, and where something is nearer
  /// than the depth's range. Both help where the depth is in doubt (outlines.h).
  const MaskImage* moving = nullptr;
  const MaskImage* too_close = nullptr;
  /// Of the size of `real_depth`, or null: 255 where its depth is none of the pixel's own, and
  /// counts as unknown.
  const MaskImage* borrowed = nullptr;
  /// Each pixel decides alone: hidden where `real_depth` at its place is known and nearer (paper
  /// Sec. 3.5). No hole is closed, no outline found, nothing is softened.
  bool hard_occlusion = false;
  PinholeCamera camera = {};  ///< of the picture; width and height are the picture's
  std::vector<BodyLook> bodies = {};
  std::vector<Arrow> arrows = {};  ///< those with an end behind the camera are left out
  SceneLight light = {};
  std::string legend_title = {};          ///< above the colour bar, e.g. "von Mises"; empty: no bar
  std::string legend_unit = "kPa";        ///< unit of the numbers at the colour bar
  double legend_scale = 1e-3;             ///< number shown = scalar * legend_scale
  double stated_error = 0;                ///< as a share; 0: not known
  std::string stated_error_of = {};       ///< what has it; empty: the largest painted value
  std::vector<std::string> caption = {};  ///< lines in a corner, UTF-8 (Latin)
  std::string warning = {};               ///< a red line at the top; empty: none
};

/// Draws scenes with the OpenGL context that is current now and in every later call.
///
/// Only the rectangle that holds bodies and shadows passes through OpenGL; the rest of the picture
/// is copied. Once it has drawn pictures and bodies of these sizes, draw() allocates nothing
/// itself.
class SceneRenderer {
 public:
  /// Needs a current context (GlContext::offscreen() or Window). The problem names shader and line.
  [[nodiscard]] static Result<SceneRenderer> make();

  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;
  ~SceneRenderer();

  /// Draws `view`.
  ///
  /// @param picture       overwritten, camera size
  /// @param body_visible  may be null. 255 where a body is drawn and not hidden, else 0
  /// @param body_depth    may be null. Z in m of the nearest body, hidden or not; NaN elsewhere
  /// @throws ContractViolation when sizes do not match
  ///
  /// Pixels of unknown depth hide nothing, but fill_unknown.h first closes holes: strips that one
  /// eye alone sees with the background's depth, other holes with the nearest depth within 6
  /// texels. If `real_depth` is half as large as `background`, real things are outlined at the
  /// picture's resolution (outlines.h). Outlines are about 1 pixel soft. Parts of bodies nearer
  /// than 10 mm are cut off.
  void draw(const SceneView& view, ColorImage& picture, MaskImage* body_visible = nullptr,
            DepthImage* body_depth = nullptr);

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
