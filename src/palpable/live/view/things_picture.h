/// @file
/// Pictures of bodies and of the capsules that press them, for runs without a camera: in the
/// studio, from any viewpoint. The capsules are drawn translucent, so that the dents below them are
/// visible.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/render/studio.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/view/studio_scene.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Draws with the OpenGL context that is current now and in every later call. The floor is the
/// plane on which the first body stands.
class ThingsPicture {
 public:
  struct Body {
    std::shared_ptr<const TouchableBody> body;
    Rigid3 world_from_body = Rigid3::Identity();
    std::optional<Rgb> color = {};  ///< of its material; nothing: rubber
  };

  /// @param bodies  at least one, in the order of the scenes'
  /// @param scale   Pa, top of the colours
  /// @throws Error when the shaders do not compile
  ThingsPicture(std::vector<Body> bodies, PictureSize size, double scale);

  /// In the frame of the first body. At first it shows all bodies, with room for a hand above them.
  OrbitCamera camera;
  ColorScale colors = ColorScale::kBlueYellow;
  bool blended = true;  ///< as BodyLook::blended
  bool legend = true;

  /// @param scene   whose bodies are drawn, with its caption and legend
  /// @param things  m, world frame
  /// @return valid until the next call
  const ColorImage& draw(const Scene& scene, std::span<const Capsule> things);

 private:
  // A capsule from the origin along +Z. Hands keep the sizes of their capsules from frame to frame:
  // they are meshed once.
  struct Part {
    double length = -1, ra = 0, rb = 0;  // m
    Eigen::Matrix3Xf vertices, normals;
    Eigen::Matrix3Xi triangles;
  };

  void mesh(std::span<const Capsule> things);
  static bool fit(Part& part, const Capsule& capsule);
  [[nodiscard]] BodyLook look_of_body(const SceneBody& shown, std::size_t number) const;
  [[nodiscard]] BodyLook look_of_things() const;

  std::vector<Body> bodies_;
  std::vector<Rigid3> first_from_body_;
  double scale_;
  Studio studio_;
  SceneRenderer renderer_;
  SceneView view_;
  ColorImage background_, picture_;
  Rigid3 camera_from_first_ = Rigid3::Identity();  // of background_
  std::vector<Part> parts_;
  // All capsules as one mesh, frame of the first body.
  Eigen::Matrix3Xf vertices_, normals_;
  Eigen::Matrix3Xi triangles_;
};

}  // namespace palpable
