/// @file
/// A reduced body in the studio: pressed at one site, seen from any side.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/render/studio.h"
#include "palpable/live/view/finger_press.h"
#include "palpable/live/view/pressed_body.h"
#include "palpable/live/view/scene_show.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Of colours that are no pressed body's stress.
struct OtherLegend {
  std::string title = {};  ///< above the colour bar; empty: no bar
  std::string unit = {};   ///< of the numbers beside it
  double scale = 1;        ///< of that unit in one of the scalar's
};

/// The size of a picture, px.
struct PictureSize {
  int width = 0;
  int height = 0;
  [[nodiscard]] double aspect() const { return static_cast<double>(width) / height; }
};

/// Where to stand to see the whole body from its broad side.
/// @param aspect  width by height of the picture
[[nodiscard]] OrbitCamera usual_camera(const ReducedBody& body, double aspect);

/// The same from the side of a site, somewhat beside its load so that the dent has a profile.
[[nodiscard]] OrbitCamera camera_towards(const Site& site, OrbitCamera camera);

/// Draws a body in the studio, with the OpenGL context that is current now and in every later call.
class StudioScene {
 public:
  /// @param body  must outlive this object; at rest to begin with
  /// @throws Error when the shaders do not compile
  StudioScene(const ReducedBody& body, PictureSize size);

  void resize(PictureSize size);

  [[nodiscard]] PressedBody& pressed() { return pressed_; }
  /// From now on draws the same body as a finger presses it. @param finger  null: at its site
  void show_finger(const FingerPress* finger) { finger_ = finger; }
  SceneShow::Field field = SceneShow::Field::kVonMises;
  SceneShow::Component component = SceneShow::Component::kZz;
  bool sites_shown = false;
  bool legend_shown = true;
  std::vector<std::string> caption;

  /// The pressed body. The picture is valid until the next one is drawn.
  const ColorImage& draw(const OrbitCamera& orbit);
  /// Another look than the pressed body's.
  const ColorImage& draw_other(const BodyLook& look, const OtherLegend& legend,
                               const OrbitCamera& orbit);

  /// The point of the body (body frame, m) that the last picture shows at a pixel; nothing where it
  /// shows no body.
  [[nodiscard]] std::optional<Eigen::Vector3d> point_at(double x_px, double y_px) const;

  /// Name and size of the body.
  [[nodiscard]] std::string title() const;
  /// Site and level, or the finger's push; force, depth and stress of the press.
  [[nodiscard]] std::string reading() const;

 private:
  const ColorImage& draw(BodyLook look, const OrbitCamera& orbit);
  [[nodiscard]] bool is_pressed() const;
  void paint(BodyLook& look);

  const ReducedBody& body_;
  PressedBody pressed_;
  const FingerPress* finger_ = nullptr;
  std::vector<float> painted_;  // m or Pa, where it is no von Mises stress
  Studio studio_;
  SceneRenderer renderer_;
  float dot_radius_;  // m
  SceneView view_;
  ColorImage background_, picture_;
  DepthImage depth_;
  Rigid3 camera_from_body_ = Rigid3::Identity();  // of the last picture
  bool studio_is_old_ = true;
  std::vector<Dot> dots_;
};

}  // namespace palpable
