#include "palpable/live/view/finger_press.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/view/stress_scale.h"

#include <algorithm>
#include <utility>

namespace palpable {
namespace {

constexpr double kLength = 0.06;   // m, of the capsule: longer than the largest push
constexpr double kOfHeight = 0.1;  // largest push, as a ratio to the body's height
constexpr double kSettled = 2e-5;  // m: smaller motion is not visible and counts as none

const std::shared_ptr<const TouchableBody>& with_tables(
    const std::shared_ptr<const TouchableBody>& body) {
  PALPABLE_EXPECT(body != nullptr && body->touch.has_value(), "the body has tables of touch");
  return body;
}

}  // namespace

FingerPress::FingerPress(const std::shared_ptr<const TouchableBody>& body)
    : body_(with_tables(body)),
      solver_({{body}}),
      deepest_(std::min(kDeepest, kOfHeight * box_of(body->body.surface).sizes().z())),
      scale_(stress_scale(body->body)),
      normals_at_rest_(3, body->body.surface.vertex_count()) {
  const SurfaceMesh& skin = body_->body.surface;
  vertex_normals(skin.vertices.cast<float>().eval(), skin.triangles, normals_at_rest_);
  solver_.keep({.components = true, .contact_pressure = true});
  rest();
}

FingerPress::Place FingerPress::place_at(const Eigen::Vector3d& at) const {
  Eigen::Index nearest = 0;
  (shown_.vertices.colwise() - at.cast<float>()).colwise().squaredNorm().minCoeff(&nearest);
  const Eigen::Vector3d u =
      shown_.vertices.col(nearest).cast<double>() - body_->body.surface.vertices.col(nearest);
  return {at - u, -normals_at_rest_.col(nearest).cast<double>()};
}

void FingerPress::press(const Place& place, double level) {
  place_ = place;
  level_ = std::clamp(level, 0.0, 1.0);
  const Eigen::Vector3d tip = place.point + (push() - kRadius) * place.inwards;
  const Capsule finger{tip, tip - kLength * place.inwards, kRadius, kRadius};
  advance({&finger, 1});
}

void FingerPress::rest() {
  level_ = 0;
  solver_.forget();  // else its history would change the last bits of the result
  advance({});
}

void FingerPress::advance(std::span<const Capsule> capsules) {
  // The shape belongs to place and level, not to the way there.
  const CapsuleThing finger{.capsules = capsules, .friction = 0};
  const ContactReport report = solver_.advance({&finger, 1}, {&shown_, 1}, touches_);
  left_to_move_ = report.left_to_move > kSettled ? report.left_to_move : 0;
}

double FingerPress::push() const { return level_ * deepest_; }

double FingerPress::force() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Touch& touch : touches_) sum += touch.force * touch.direction;
  return sum.norm();
}

double FingerPress::largest_von_mises() const {
  return *std::max_element(shown_.von_mises.begin(), shown_.von_mises.end());
}

BodyLook FingerPress::look() const {
  BodyLook look;
  look.vertices = &shown_.vertices;
  look.normals = &shown_.normals;
  look.triangles = &body_->body.surface.triangles;
  look.scalar = shown_.von_mises;
  look.scalar_max = static_cast<float>(scale_);
  return look;
}

void FingerPress::finger_dots(float radius, std::vector<Dot>& dots) const {
  const Eigen::Vector3f tip = (place_.point + push() * place_.inwards).cast<float>();
  constexpr int kBalls = 6;
  for (int i = 0; i < kBalls; ++i) {
    // Smaller towards the body, like the head of an arrow.
    const float outwards = (1.2f + 2.3f * static_cast<float>(i)) * radius;
    Dot dot;
    dot.at_in_body = tip - outwards * place_.inwards.cast<float>();
    dot.radius = radius * (0.55f + 0.09f * static_cast<float>(i));
    dots.push_back(dot);
  }
}

}  // namespace palpable
