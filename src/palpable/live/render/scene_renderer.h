/// @file
/// Draws a scene: the camera's image with bodies in it, hidden where something real is nearer
/// (paper Sec. 3.5, Fig. 9), and with their stress as colours (Fig. 16).
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

/// The usual direction to the lamp: above, a little to the left and behind the camera, so that
/// visible sides are lit. Camera frame, unit. @param up  of the scene, likewise
[[nodiscard]] inline Eigen::Vector3d usual_lamp(const Eigen::Vector3d& up) {
  return (0.85 * up + Eigen::Vector3d(-0.55, 0.0, -0.45)).normalized();
}

/// The light in which bodies are drawn, and by which they throw shadows on real things.
struct SceneLight {
  /// Towards the lamp: camera frame, unit. Nothing: usual_lamp() for each body.
  std::optional<Eigen::Vector3f> to_lamp = {};
  float lamp = 1;                                   ///< strength; 1: a window beside the desk
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  ///< linear R, G, B of all light; 1: a lit room
};

/// An arrow in front of everything else, with a text at its tail.
struct Arrow {
  Eigen::Vector3d tail = Eigen::Vector3d::Zero();  ///< m, camera frame
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();   ///< likewise
  Rgb color{240, 120, 20};
  std::string label;  ///< UTF-8 (Latin)
};

/// One body as plain arrays. Pointers and spans are read during draw() only; none of the pointers
/// may be null.
struct BodyLook {
  const Eigen::Matrix3Xf* vertices = nullptr;   ///< (3 x V) body frame, m, deformed
  const Eigen::Matrix3Xf* normals = nullptr;    ///< (3 x V) body frame, unit, outwards
  const Eigen::Matrix3Xi* triangles = nullptr;  ///< (3 x T) counter-clockwise from outside
  Rgb material = kRubber;                       ///< colour of the material
  std::span<const float> scalar;                ///< (V) the field painted on it; empty: none
  float scalar_max = 1;                         ///< > 0: top of the colour scale, unit of `scalar`
  bool two_sided = false;  ///< the scale's lower end is -scalar_max, else 0 (color_map.h)
  ColorScale colors = ColorScale::kBlueYellow;  ///< unless two-sided
  /// Low values show the material's own colour (color_map.h); false: only the scale's colours.
  bool blended = true;
  /// The share of the scale above which the scale's colours cover the material completely.
  [[nodiscard]] float opaque_share() const {
    if (scalar.empty()) return kNothingPainted;
    return blended ? kOpaqueShare : 0.0f;
  }
  std::span<const float> marks;  ///< (V) painted in mark_color where > 0.5; or empty
  Rgb mark_color{250, 208, 60};
  std::span<const Dot> dots;
  Rigid3 camera_from_body = Rigid3::Identity();
  /// 1: nothing is visible through it. Below 1 its nearest surface is mixed with what is behind it,
  /// in this share; bodies behind it are visible, other surfaces of such bodies are not. Not with
  /// SceneView::hard_occlusion.
  float opacity = 1;
  /// Darkness of the shadow on the body's plane Z = 0 and on real things that stand on it, from 0
  /// (none) to 1. Pixels whose real depth is unknown are taken to show the plane.
  float shadow = 0.5f;
};

/// The content of one picture.
struct SceneView {
  const ColorImage* background = nullptr;  ///< camera size; null: a plain grey
  /// Z of the real scene in m, NaN where unknown. Its size may differ from the picture's, with the
  /// same field of view (such as camera.scaled_down(2)). Null: nothing real hides the body.
  const DepthImage* real_depth = nullptr;
  /// Of the size of `real_depth`, or null: 255 where something moves, and where something is nearer
  /// than the depth's range. Both help where the depth is in doubt (outlines.h).
  const MaskImage* moving = nullptr;
  const MaskImage* too_close = nullptr;
  /// Of the size of `real_depth`, or null: 255 where the depth was taken over from another pixel;
  /// such depths count as unknown.
  const MaskImage* borrowed = nullptr;
  /// Hides each pixel of a body exactly where `real_depth` at the pixel is known and nearer (paper
  /// Sec. 3.5). No holes are closed, no outlines found, nothing is softened.
  bool hard_occlusion = false;
  PinholeCamera camera = {};  ///< of the picture; width and height are the picture's
  std::vector<BodyLook> bodies = {};
  std::vector<Arrow> arrows = {};  ///< those with an end behind the camera are left out
  SceneLight light = {};
  std::string legend_title = {};          ///< above the colour bar, e.g. "von Mises"; empty: no bar
  std::string legend_unit = "kPa";        ///< unit of the numbers at the colour bar
  double legend_scale = 1e-3;             ///< number shown = scalar * legend_scale
  double stated_error = 0;                ///< relative, 1 = 100 %; 0: not known
  std::string stated_error_of = {};       ///< its quantity; empty: the largest painted value
  std::vector<std::string> caption = {};  ///< lines in a corner, UTF-8 (Latin)
  std::string warning = {};               ///< a red line at the top; empty: none
};

/// Draws scenes with the OpenGL context that is current now and in every later call.
///
/// Only the rectangle that holds bodies and shadows is drawn by OpenGL; the rest of the picture is
/// copied. After pictures and bodies of the same sizes, draw() itself allocates nothing.
class SceneRenderer {
 public:
  /// Needs a current context (GlContext::offscreen() or Window). A problem names shader and line.
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
  /// Pixels of unknown depth hide nothing, but holes are closed before (fill_unknown.h): strips
  /// that one eye alone sees get the background's depth, other holes the nearest depth within 6
  /// texels. If `real_depth` has half the size of `background`, the outlines of real things are
  /// found at the picture's resolution (outlines.h). Outlines are soft over about 1 pixel. Parts of
  /// bodies nearer than 10 mm are cut off.
  void draw(const SceneView& view, ColorImage& picture, MaskImage* body_visible = nullptr,
            DepthImage* body_depth = nullptr);

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
