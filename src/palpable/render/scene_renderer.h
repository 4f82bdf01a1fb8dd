/// @file
/// Draws a scene: the camera's image with the body in it, hidden where something real is nearer
/// (paper Sec. 3.5, Fig. 9), its stress as colours (Fig. 16).
///
///   V  vertices     T  triangles
///
/// Camera frame: X right, Y down, Z forward, m. Depths are compared as Z in that frame.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// A small ball on a body that marks the middle of a contact site or a touched point.
struct Dot {
  Eigen::Vector3f at_in_body = Eigen::Vector3f::Zero();  ///< m
  float radius = 0.002f;                                 ///< m
  Rgb color{240, 120, 20};
};

/// One body as plain arrays. Pointers and spans are read during draw() only; none of the pointers
/// may be null.
struct BodyLook {
  const Eigen::Matrix3Xf* vertices = nullptr;   ///< (3 x V) body frame, m, as it is now
  const Eigen::Matrix3Xf* normals = nullptr;    ///< (3 x V) body frame, unit, outwards
  const Eigen::Matrix3Xi* triangles = nullptr;  ///< (3 x T) counter-clockwise from outside
  std::span<const float> scalar;                ///< (V) Pa, shown as colour; empty: all 0
  float scalar_max = 1;                         ///< Pa, > 0: upper end of the colour scale
  std::span<const float> marks;                 ///< (V) painted in mark_color where > 0.5; or empty
  Rgb mark_color{250, 208, 60};
  std::optional<Rgb> color = {};  ///< all of it, instead of scalar and marks
  std::span<const Dot> dots;
  Rigid3 camera_from_body = Rigid3::Identity();
  /// Darkness of the shadow on the body's plane Z = 0, from 0 (none) to 1. It falls on pixels whose
  /// real depth lies on that plane or is unknown.
  float shadow = 0.5f;
};

/// Content of one picture.
struct SceneView {
  const ColorImage* background = nullptr;  ///< camera size; null: a plain grey
  /// Z of the real scene in m, NaN where unknown. It may have another size than the picture, with
  /// the same field of view (camera.scaled_down(2), say). Null: nothing real hides the body.
  const DepthImage* real_depth = nullptr;
  PinholeCamera camera = {};  ///< of the picture; width and height are the picture's
  std::vector<BodyLook> bodies = {};
  /// Brightness of the scene's light; 1 is a well lit room.
  float brightness = 1;
  std::string legend_title = {};          ///< above the colour bar, e.g. "von Mises"; empty: no bar
  std::string legend_unit = "kPa";        ///< unit of the numbers at the colour bar
  double legend_scale = 1e-3;             ///< number shown = Pa * legend_scale
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
