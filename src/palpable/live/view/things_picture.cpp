#include "palpable/live/view/things_picture.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/capsule_mesh.h"
#include "palpable/live/view/scene_picture.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

constexpr double kRoomForHands =
    1.35;  // distance of the camera, ratio to that for the bodies alone
constexpr double kChordError = 0.0003;  // m, of the capsules' triangles: below a pixel
constexpr double kSameSize = 1e-4;  // m, by which a capsule may differ from its mesh: below a pixel
constexpr float kThingsOpacity = 0.45f;  // BodyLook::opacity
constexpr float kThingsShadow = 0.11f;   // BodyLook::shadow
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
}

// Meshes a capsule anew if its sizes are others than those of its part. @return whether it did
bool ThingsPicture::fit(Part& part, const Capsule& capsule) {
  const double length = (capsule.b - capsule.a).norm();
  const auto is_same = [](double a, double b) { return std::abs(a - b) <= kSameSize; };
  if (is_same(part.length, length) && is_same(part.ra, capsule.ra) && is_same(part.rb, capsule.rb))
    return false;
  const Capsule upright{Eigen::Vector3d::Zero(), {0, 0, length}, capsule.ra, capsule.rb};
  CapsuleMesh made = tessellate(upright, Eigen::Vector3d::UnitX(), kChordError);
  part = {length,
          capsule.ra,
          capsule.rb,
          made.vertices.cast<float>(),
          made.normals.cast<float>(),
          std::move(made.triangles)};
  return true;
}

// Moves the meshes of all capsules to their places, in one mesh.
void ThingsPicture::mesh(std::span<const Capsule> things) {
  bool others = parts_.size() != things.size();
  parts_.resize(things.size());
  Eigen::Index vertices = 0, triangles = 0;
  for (std::size_t k = 0; k < things.size(); ++k) {
    others |= fit(parts_[k], things[k]);
    vertices += parts_[k].vertices.cols();
    triangles += parts_[k].triangles.cols();
  }
  if (others) {
    vertices_.resize(3, vertices);
    normals_.resize(3, vertices);
    triangles_.resize(3, triangles);
  }
  const Rigid3 first_from_world = bodies_.front().world_from_body.inverse();
  Eigen::Index v = 0, t = 0;
  for (std::size_t k = 0; k < things.size(); ++k) {
    const Part& part = parts_[k];
    const Eigen::Vector3d a = first_from_world * things[k].a, b = first_from_world * things[k].b;
    const Eigen::Matrix3f turn = part.length > kSameSize ? Eigen::Quaterniond::FromTwoVectors(
                                                               Eigen::Vector3d::UnitZ(), b - a)
                                                               .toRotationMatrix()
                                                               .cast<float>()
                                                               .eval()
                                                         : Eigen::Matrix3f::Identity();
    vertices_.middleCols(v, part.vertices.cols()) =
        (turn * part.vertices).colwise() + a.cast<float>().eval();
    normals_.middleCols(v, part.normals.cols()) = turn * part.normals;
    if (others) {
      triangles_.middleCols(t, part.triangles.cols()) =
          part.triangles.array() + static_cast<int>(v);
    }
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
  look.opacity = kThingsOpacity;
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
  view_.legend_title = legend ? "von Mises" : "";
  view_.caption = {caption_of(scene)};
  if (!things.empty()) {
    mesh(things);
    view_.bodies.push_back(look_of_things());
  }
  renderer_.draw(view_, picture_);
  return picture_;
}

}  // namespace palpable
