/// @file
/// Draws a reduced body in the studio: pressed at one site or by a finger, from any viewpoint.
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

/// The legend of a field other than a pressed body's stress.
struct OtherLegend {
  std::string title = {};  ///< above the colour bar; empty: no bar
  std::string unit = {};   ///< of the numbers beside it
  double scale = 1;        ///< number shown = scalar * scale
};

/// The size of a picture, px.
struct PictureSize {
  int width = 0;
  int height = 0;
  [[nodiscard]] double aspect() const { return static_cast<double>(width) / height; }
};

/// The vertical field of view of pictures in the studio, rad.
inline constexpr double kStudioView = 0.55;

/// A viewpoint that shows the whole body from its broad side.
/// @param aspect  width of the picture / height
[[nodiscard]] OrbitCamera usual_camera(const ReducedBody& body, double aspect);
/// The same for points, such as those of several bodies. @param x  (3 x N) m, N > 0, Z up
[[nodiscard]] OrbitCamera usual_camera(const Eigen::Matrix3Xd& x, double aspect);

/// Turns a viewpoint to the side of a site, 0.75 rad beside its load so that the dent is seen in
/// profile.
[[nodiscard]] OrbitCamera camera_towards(const Site& site, OrbitCamera camera);

/// Draws a body in the studio, with the OpenGL context that is current now and in every later call.
class StudioScene {
 public:
  /// Begins with the body at rest. @param body  must outlive this object
  /// @throws Error when the shaders do not compile
  StudioScene(const ReducedBody& body, PictureSize size);

  void resize(PictureSize size);

  [[nodiscard]] PressedBody& pressed() { return pressed_; }
  /// Makes draw() show the body pressed by `finger`; null: pressed at its site.
  void show_finger(const FingerPress* finger) { finger_ = finger; }
  SceneShow::Field field = SceneShow::Field::kVonMises;
  SceneShow::Component component = SceneShow::Component::kZz;
  ColorScale colors = ColorScale::kBlueYellow;  ///< of fields with one sign
  bool sites_shown = false;
  bool legend_shown = true;
  std::vector<std::string> caption;

  /// Draws the pressed body. The picture is valid until the next one is drawn.
  const ColorImage& draw(const OrbitCamera& orbit);
  /// Draws a look that the caller has made.
  const ColorImage& draw_other(const BodyLook& look, const OtherLegend& legend,
                               const OrbitCamera& orbit);

  /// The point of the body (body frame, m) that the last picture shows at a pixel; nothing beside
  /// the body.
  [[nodiscard]] std::optional<Eigen::Vector3d> point_at(double x_px, double y_px) const;

  /// Name of the body, and its numbers of vertices and sites.
  [[nodiscard]] std::string title() const;
  /// A line about the press: site, level and depth, or the finger's push; force, and stress if it
  /// is known.
  [[nodiscard]] std::string reading() const;

 private:
  const ColorImage& draw(BodyLook look, const OrbitCamera& orbit);
  [[nodiscard]] bool is_pressed() const;
  void paint(BodyLook& look);

  const ReducedBody& body_;
  PressedBody pressed_;
  const FingerPress* finger_ = nullptr;
  std::vector<float> painted_;  // m or Pa, for fields other than von Mises stress
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
