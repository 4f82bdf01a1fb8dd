#include "palpable/synth/press_clip.h"

#include "palpable/base/contract.h"
#include "palpable/synth/contact_truth.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

using namespace palpable;
using palpable::test::tolerance;

namespace {

/// An egg on the desk, 0.13 m high, with sites all over it that are pressed towards its middle.
DeskBody egg() {
  DeskBody body;
  body.surface = sphere_surface({0, 0, 0}, 1.0, 4);
  const Eigen::Vector3d middle(0.0, 0.0, 0.065);
  body.surface.vertices =
      (Eigen::Vector3d(0.045, 0.055, 0.065).asDiagonal() * body.surface.vertices).colwise() +
      middle;
  for (int v = 0; v < body.surface.vertex_count(); v += 41) body.site_vertices.push_back(v);
  body.directions.resize(3, static_cast<Eigen::Index>(body.site_vertices.size()));
  for (std::size_t s = 0; s < body.site_vertices.size(); ++s)
    body.directions.col(static_cast<Eigen::Index>(s)) =
        (middle - body.surface.vertices.col(body.site_vertices[s])).normalized();
  return body;
}

Eigen::Matrix3Xd in_desk(const PressClip& clip, const DeskBody& body) {
  return clip.desk_from_body().linear() * body.surface.vertices;
}

std::vector<Capsule> hand_at(const PressClip& clip, int frame) {
  const std::optional<HandPose> pose = clip.hand(frame);
  return pose ? shapes_of(hand_capsules(*pose)) : std::vector<Capsule>{};
}

}  // namespace

TEST_CASE("the first sixty frames hold no hand and no touch", "[synth]") {
  const DeskBody body = egg();
  const PressClip clip = PressClip::plan(body, 300, 1);
  for (int frame = 0; frame < kFramesWithoutHand; ++frame) {
    CHECK_FALSE(clip.hand(frame));
    CHECK(clip.advance(frame) == 0.0);
  }
  CHECK(clip.hand(kFramesWithoutHand));
}

TEST_CASE("the hand meets the body in its three presses, at their sites, and nowhere else",
          "[synth]") {
  const DeskBody body = egg();
  for (const std::uint64_t seed : {1U, 2U}) {
    INFO("seed " << seed);
    const PressClip clip = PressClip::plan(body, 300, seed);
    const Eigen::Matrix3Xd vertices = in_desk(clip, body);
    REQUIRE(clip.presses().size() == 3);
    std::vector<double> deepest(3, 0.0);
    std::vector<double> farthest(3, 0.0);
    for (int frame = 0; frame < 300; ++frame) {
      INFO("frame " << frame);
      const std::vector<Capsule> hand = hand_at(clip, frame);
      const std::vector<int> inside = vertices_inside(hand, vertices);
      const ContactTruth truth = contact_truth(hand, vertices);
      CHECK(truth.touching == !inside.empty());
      const PlannedPress* press = clip.press_at(frame);
      if (!inside.empty()) REQUIRE(press != nullptr);
      if (press == nullptr) continue;
      const auto which = static_cast<std::size_t>(press - clip.presses().data());
      deepest[which] = std::max(deepest[which], truth.depth);
      farthest[which] = std::max(farthest[which], clip.advance(frame));
      const Eigen::Vector3d site =
          vertices.col(body.site_vertices[static_cast<std::size_t>(press->site)]);
      for (const int v : inside) CHECK((vertices.col(v) - site).norm() < 0.03);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const double planned = clip.presses()[i].depth;
      CHECK(planned >= 0.005);
      CHECK(planned <= 0.0121);
      CHECK(std::abs(farthest[i] - planned) <= tolerance(0.001, "the depth is as planned to 1 mm"));
      CHECK(deepest[i] > 0.003);
      CHECK(deepest[i] <= planned + tolerance(0.0003, "tremor and the vertices' spacing"));
    }
  }
}

TEST_CASE("the finger's touching surface faces the left eye within 70 degrees and is not hidden",
          "[synth]") {
  const DeskBody body = egg();
  const PressClip clip = PressClip::plan(body, 300, 3);
  const Eigen::Vector3d eye = clip.camera_from_desk().inverse().translation();
  for (const PlannedPress& press : clip.presses()) {
    const int frame = (press.first_frame + press.last_frame) / 2;
    const std::vector<Capsule> hand = hand_at(clip, frame);
    const Capsule& tip = hand[kIndexTip];
    const Eigen::Vector3d touching = tip.b + tip.rb * press.direction;
    const Eigen::Vector3d to_eye = eye - touching;
    CHECK(press.direction.dot(to_eye.normalized()) > std::cos(70.0 * std::numbers::pi / 180.0));
    const double seen = ray_distance(hand, eye, -to_eye.normalized(), to_eye.norm() + 0.1);
    CHECK(std::abs(seen - to_eye.norm()) < 0.004);
  }
}

TEST_CASE("the body stands upright on the desk, 0.35 to 0.5 m before the left camera", "[synth]") {
  const PressClip clip = PressClip::plan(egg(), 300, 1);
  const Rigid3 camera_from_body = clip.camera_from_body();
  CHECK(camera_from_body.translation().norm() > 0.35);
  CHECK(camera_from_body.translation().norm() < 0.50);
  CHECK(
      (clip.desk_from_body() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ(), 1e-14));
  CHECK(std::abs(camera_from_body.linear().determinant() - 1.0) < 1e-12);
  // Up on the desk is up in the picture.
  CHECK((camera_from_body.linear() * Eigen::Vector3d::UnitZ()).y() < -0.5);
}

TEST_CASE("the hand passes before the body and behind it without touching", "[synth]") {
  const DeskBody body = egg();
  const PressClip clip = PressClip::plan(body, 300, 1);
  const double middle = (clip.camera_from_body() * Eigen::Vector3d(0, 0, 0.065)).z();
  const auto nearest_z = [&](int frame, bool largest) {
    double z = largest ? 0.0 : 10.0;
    const std::vector<Capsule> hand = hand_at(clip, frame);
    for (std::size_t i = 0; i < 15; ++i) {  // the fingers
      const double at = (clip.camera_from_desk() * hand[i].b).z();
      z = largest ? std::max(z, at) : std::min(z, at);
    }
    return z;
  };
  for (int frame = clip.passes_in_front().first; frame <= clip.passes_in_front().last; ++frame)
    CHECK(nearest_z(frame, true) < middle - 0.05);
  for (int frame = clip.passes_behind().first; frame <= clip.passes_behind().last; ++frame)
    CHECK(nearest_z(frame, false) > middle + 0.02);
}

TEST_CASE("the hand stays above the desk and moves without jumps", "[synth]") {
  const PressClip clip = PressClip::plan(egg(), 300, 2);
  std::vector<Capsule> before;
  for (int frame = kFramesWithoutHand; frame < 300; ++frame) {
    INFO("frame " << frame);
    const std::vector<Capsule> hand = hand_at(clip, frame);
    for (std::size_t i = 0; i < hand.size(); ++i) {
      CHECK(hand[i].a.z() - hand[i].ra > 0.0);
      CHECK(hand[i].b.z() - hand[i].rb > 0.0);
      // 3 m/s is a quick hand.
      if (!before.empty()) CHECK((hand[i].b - before[i].b).norm() < 3.0 / 30.0);
    }
    before = hand;
  }
}

TEST_CASE("a clip depends on its seed and on nothing else", "[synth]") {
  const DeskBody body = egg();
  const PressClip a = PressClip::plan(body, 300, 5);
  const PressClip b = PressClip::plan(body, 300, 5);
  const PressClip c = PressClip::plan(body, 300, 6);
  CHECK(hand_at(a, 200)[kIndexTip].b == hand_at(b, 200)[kIndexTip].b);
  CHECK(hand_at(a, 200)[kIndexTip].b != hand_at(c, 200)[kIndexTip].b);
}

TEST_CASE("a short clip may hold no hand at all", "[synth]") {
  const PressClip clip = PressClip::plan(egg(), 1, 1);
  CHECK(clip.frame_count() == 1);
  CHECK_FALSE(clip.hand(0));
  CHECK_THROWS_AS(clip.hand(1), ContractViolation);
}

TEST_CASE("a body that cannot be pressed in view of the camera is refused with the reason",
          "[synth]") {
  DeskBody body = egg();
  body.directions.colwise() = Eigen::Vector3d(0, 0, 1);  // only from below
  CHECK_THROWS_WITH(PressClip::plan(body, 300, 1), Catch::Contains("no site can be pressed"));
  body.site_vertices.clear();
  CHECK_THROWS_AS(PressClip::plan(body, 300, 1), ContractViolation);
}
