/// @file
/// Converts a session's scene to the renderer's input.
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

/// Whether a body's floor, its plane Z = 0, is that of the first body, on which shadows fall.
[[nodiscard]] bool stands_on_first_ground(const Rigid3& first_from_body);

/// A body of a scene at its pose in the camera's picture, with pointers into both arguments. A body
/// that does not stand on the first body's ground throws no shadow.
/// @param session  the one that made the scene
/// @param number   of the body
/// @param scale    Pa, top of the colours
[[nodiscard]] BodyLook look_of_body(const Scene& scene, const Session& session, int number,
                                    double scale, ColorScale colors);

/// One line about a scene: its time, touches and model error.
[[nodiscard]] std::string caption_of(const Scene& scene);
/// "4.0 mm   1.50 N", with its site if it has one; of several touches the depth of the deepest and
/// the sum of the forces' magnitudes, which say so; "not touched" without any.
[[nodiscard]] std::string caption_of(std::span<const Touch> touches);
/// "model error ±2.1 %, stress ±7 %"; "> 100 %" for errors above 1. The error is that of the
/// reduced model against full finite elements; the camera's is not in it.
[[nodiscard]] std::string caption_of(const StatedError& error);
/// The most urgent warning, with what the user can do: a lost camera, new surroundings, an obstacle
/// that is not seen, or a trouble of the depth. Empty without any.
[[nodiscard]] std::string warning_of(const Scene& scene);

/// The length of each vertex's displacement from its baked position. @param now  (3 x V) m
/// @param moved  (V) m, overwritten; keeps its memory
void displacement_of(const Eigen::Matrix3Xf& now, const SurfaceMesh& baked,
                     std::vector<float>& moved);
/// The top of displacement's colours, m: a tenth of the body's height.
[[nodiscard]] float displacement_scale(const SurfaceMesh& baked);

/// Converts scenes to the renderer's input, one after the other, and reuses its memory.
class SceneViews {
 public:
  /// @param scale  Pa, top of the stress's colours; for fields of two signs the lower end is -scale
  explicit SceneViews(double scale) : scale_(scale) {}

  /// @param session  the one that made the scene
  /// @param show     what is shown; the scene must have its extras_for() (painted_stress.h)
  /// @return points into both and into this object; valid until the next call, and may be changed
  SceneView& of(const Scene& scene, const Session& session, const SceneShow& show);

 private:
  void show_displacement(const Scene& scene, const Session& session, int number);
  void show_components(const Scene& scene, const Session& session, const SceneShow& show,
                       int number);
  void show_legend(const Scene& scene, const Session& session, const SceneShow& show);
  void show_touches(const Scene& scene, const SceneShow& show);

  double scale_;
  SceneView view_;
  // Per body.
  std::vector<std::vector<float>> painted_;  // m or Pa, for fields other than von Mises stress
  std::vector<std::vector<Dot>> dots_;
};

}  // namespace palpable
