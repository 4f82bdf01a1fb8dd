#include "palpable/live/view/things_picture.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/capsule_mesh.h"
#include "palpable/live/render/mix_color.h"
#include "palpable/live/view/scene_picture.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

constexpr double kRoomForHands =
    1.35;  // distance of the camera, ratio to that for the bodies alone
constexpr double kChordError = 0.0003;  // m, of the capsules' triangles: below a pixel
constexpr float kThingsShare = 0.45f;   // of the capsules' colour in the picture
constexpr float kThingsShadow = 0.25f;  // BodyLook::shadow
constexpr Rgb kThings{92, 124, 170};

Eigen::Matrix3Xd vertices_of(const std::vector<ThingsPicture::Body>& bodies,
                             const std::vector<Rigid3>& first_from_body) {
  Eigen::Matrix3Xd all(3, 0);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Eigen::Matrix3Xd& x = bodies[k].body->body.surface.vertices;
    const Eigen::Index before = all.cols();
    all.conservativeResize(3, before + x.cols());
    all.rightCols(x.cols()) = first_from_body[k] * x;
  }
  return all;
}

std::vector<Rigid3> first_from_bodies(const std::vector<ThingsPicture::Body>& bodies) {
  PALPABLE_EXPECT(!bodies.empty(), "there is a body");
  std::vector<Rigid3> poses;
  for (const ThingsPicture::Body& body : bodies) {
    poses.push_back(bodies.front().world_from_body.inverse() * body.world_from_body);
  }
  return poses;
}

}  // namespace

ThingsPicture::ThingsPicture(std::vector<Body> bodies, PictureSize size, double scale)
    : bodies_(std::move(bodies)),
      first_from_body_(first_from_bodies(bodies_)),
      scale_(scale),
      studio_(value_or_throw(Studio::make())),
      renderer_(value_or_throw(SceneRenderer::make())) {
  camera = usual_camera(vertices_of(bodies_, first_from_body_), size.aspect());
  camera.distance *= kRoomForHands;
  view_.camera = camera_of_view(size.width, size.height, kStudioView);
  view_.light.color.setConstant(1.12f);  // brighter than a room, as in studio_scene.cpp
  view_.legend_title = "von Mises";
}

// Rebuilds the mesh of all capsules.
void ThingsPicture::mesh(std::span<const Capsule> things) {
  const Rigid3 first_from_world = bodies_.front().world_from_body.inverse();
  std::vector<CapsuleMesh> parts;
  Eigen::Index vertices = 0, triangles = 0;
  for (Capsule capsule : things) {
    capsule.a = first_from_world * capsule.a;
    capsule.b = first_from_world * capsule.b;
    parts.push_back(tessellate(capsule, Eigen::Vector3d::UnitZ(), kChordError));
    vertices += parts.back().vertices.cols();
    triangles += parts.back().triangles.cols();
  }
  vertices_.resize(3, vertices);
  normals_.resize(3, vertices);
  triangles_.resize(3, triangles);
  Eigen::Index v = 0, t = 0;
  for (const CapsuleMesh& part : parts) {
    vertices_.middleCols(v, part.vertices.cols()) = part.vertices.cast<float>();
    normals_.middleCols(v, part.normals.cols()) = part.normals.cast<float>();
    triangles_.middleCols(t, part.triangles.cols()) = part.triangles.array() + static_cast<int>(v);
    v += part.vertices.cols();
    t += part.triangles.cols();
  }
}

BodyLook ThingsPicture::look_of_body(const SceneBody& shown, std::size_t number) const {
  BodyLook look;
  look.vertices = &shown.vertices;
  look.normals = &shown.normals;
  look.triangles = &bodies_[number].body->body.surface.triangles;
  look.scalar = shown.von_mises;
  look.scalar_max = static_cast<float>(scale_);
  look.colors = colors;
  look.blended = blended;
  look.material = bodies_[number].color.value_or(kRubber);
  look.camera_from_body = camera_from_first_ * first_from_body_[number];
  if (!stands_on_first_ground(first_from_body_[number])) look.shadow = 0;
  return look;
}

BodyLook ThingsPicture::look_of_things() const {
  BodyLook look;
  look.vertices = &vertices_;
  look.normals = &normals_;
  look.triangles = &triangles_;
  look.material = kThings;
  look.camera_from_body = camera_from_first_;
  look.shadow = kThingsShadow;
  return look;
}

const ColorImage& ThingsPicture::draw(const Scene& scene, std::span<const Capsule> things) {
  PALPABLE_EXPECT(scene.bodies.size() == bodies_.size(), "the scene is of these bodies");
  const Rigid3 camera_from_first = camera.camera_from_body();
  if (background_.empty() || !camera_from_first.isApprox(camera_from_first_, 0.0)) {
    studio_.draw(view_.camera, camera_from_first, background_);
    camera_from_first_ = camera_from_first;
  }
  view_.background = &background_;
  view_.bodies.clear();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    view_.bodies.push_back(look_of_body(scene.bodies[k], k));
  }
  view_.stated_error = 0;
  for (const SceneBody& body : scene.bodies) {
    if (!body.stated_error) continue;
    view_.stated_error = std::max(view_.stated_error, body.stated_error->von_mises);
  }
  view_.caption = {caption_of(scene)};
  renderer_.draw(view_, picture_);
  if (things.empty()) return picture_;
  mesh(things);
  view_.bodies.push_back(look_of_things());
  renderer_.draw(view_, with_things_);
  for (std::size_t i = 0; i < picture_.size(); ++i) {
    mix_color(picture_.data()[i], with_things_.data()[i], kThingsShare);
  }
  return picture_;
}

}  // namespace palpable
