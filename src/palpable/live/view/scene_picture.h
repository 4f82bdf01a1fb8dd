/// @file
/// A scene of a session in the terms of the renderer.
#pragma once

#include "palpable/common/response/stated_error.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"
#include "palpable/live/view/scene_show.h"

#include <span>
#include <string>
#include <vector>

namespace palpable {

/// A body of a scene where the camera sees it; pointers into both arguments. A body that stands
/// elsewhere than on the first one's ground throws no shadow on it.
/// @param session  that made the scene
/// @param number   of the body
/// @param scale    Pa, top of the colours
[[nodiscard]] BodyLook look_of_body(const Scene& scene, const Session& session, int number,
                                    double scale);

/// One line about a scene: its time and its touches.
[[nodiscard]] std::string caption_of(const Scene& scene);
/// Depth of the deepest touch, and the force of all, or the site; "not touched".
[[nodiscard]] std::string caption_of(std::span<const Touch> touches);
/// "off by some 2.1 %, stress 7 %"; what is off by more than all of it says so.
[[nodiscard]] std::string caption_of(const StatedError& error);
/// That the camera is lost, and what to do; or that what presses is not seen. Else empty.
[[nodiscard]] std::string warning_of(const Scene& scene);

/// How far each vertex is from where it was baked. @param now  (3 x V) m. @param moved  (V) m,
/// overwritten; keeps its memory
void displacement_of(const Eigen::Matrix3Xf& now, const SurfaceMesh& baked,
                     std::vector<float>& moved);
/// At the top of displacement's colours: m, a tenth of the body's height.
[[nodiscard]] float displacement_scale(const SurfaceMesh& baked);

/// Scenes in the terms of the renderer, one after the other; their memory is used again.
class SceneViews {
 public:
  /// @param scale  Pa, top of the stress's colours; of what has two signs both ends
  explicit SceneViews(double scale) : scale_(scale) {}

  /// @param session  that made the scene
  /// @param show     what of it is shown; the scene has its extras_for() (painted_stress.h)
  /// @return pointers into both and into this object, valid until the next call; it may be changed
  SceneView& of(const Scene& scene, const Session& session, const SceneShow& show);

 private:
  void show_displacement(const Scene& scene, const Session& session, int number);
  void show_components(const Scene& scene, const Session& session, const SceneShow& show,
                       int number);
  void show_legend(const Scene& scene, const Session& session, const SceneShow& show);
  void show_touches(const Scene& scene, const SceneShow& show);

  double scale_;
  SceneView view_;
  // Of each body.
  std::vector<std::vector<float>> painted_;  // m or Pa, where it is no von Mises stress
  std::vector<std::vector<Dot>> dots_;
};

}  // namespace palpable
