#include "palpable/live/session/session.h"

#include "palpable/live/session/frame_loop.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/noise_room.h"
#include "tests/support/pressed_sphere.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/seen_wall.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::Capsule;
using test::frame_with_finger;
using test::kEverythingPresses;
using test::sphere_pose;
using test::tolerance;
using test::touchable_sphere_loop;

// Colour + depth needs no matcher: this module begins after the depth.
FrameFormat depth_format() { return test::wall_format(); }

FrameLoop make_loop(const SessionSettings& settings = kEverythingPresses) {
  return std::move(
      FrameLoop::make(test::DentedSphere{}.body(), sphere_pose(), depth_format(), settings)
          .value());
}

TEST_CASE("a body with tables is touched where the finger is, not at a site", "[session]") {
  FrameLoop loop = touchable_sphere_loop();
  CHECK(loop.session.body().response.contact() == ContactKind::kAnywhere);
  const Eigen::Matrix3Xf rest = loop.session.body().model().surface.vertices.cast<float>();
  for (int n = 0; n < 3; ++n) CHECK(loop.process(frame_with_finger(n, -0.03)).touches.empty());
  CHECK(loop.scene.bodies[0].vertices == rest);
  for (int n = 3; n < 7; ++n) loop.process(frame_with_finger(n, 0.002 * (n - 2)));
  const Scene& pressed = loop.process(frame_with_finger(7, 0.008));
  REQUIRE_FALSE(pressed.touches.empty());
  const Touch& touch = pressed.touches.front();
  CHECK(touch.site == -1);
  CHECK(touch.force > 0);
  Vector3d force = Vector3d::Zero();
  for (const Touch& one : pressed.touches) force += one.force * one.direction;
  CHECK(force.normalized().z() < -0.7);
  CHECK(touch.press_depth == Approx(0.008).margin(tolerance(2.5e-3, "m: vertices 6 mm apart")));
  CHECK((touch.point_in_body - Vector3d(0, 0, 0.092)).norm() < tolerance(0.006, "m, likewise"));
  // No part of the skin is inside the seen obstacle.
  float deepest = 0;
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    const auto found =
        loop.session.body().response.surface().nearest(pressed.bodies[0].vertices.col(v));
    if (found) deepest = std::max(deepest, -found->distance);
  }
  CHECK(deepest < 1e-3f);
  CHECK(*std::max_element(pressed.bodies[0].von_mises.begin(), pressed.bodies[0].von_mises.end()) >
        100.0f);
  CHECK(pressed.bodies[0].normals.colwise().norm().minCoeff() > 0.99f);
  const Scene& after = loop.process(frame_with_finger(8, -0.03));
  CHECK(after.touches.empty());
  CHECK(after.bodies[0].vertices == rest);
}

TEST_CASE("with the setting kSite the tables are not used", "[session]") {
  SessionSettings settings = kEverythingPresses;
  settings.contact = ContactKind::kSite;
  FrameLoop loop = touchable_sphere_loop(settings);
  CHECK(loop.session.body().response.contact() == ContactKind::kSite);
  for (int n = 0; n < 4; ++n) loop.process(frame_with_finger(n, 0.008));
  REQUIRE(loop.scene.touches.size() == 1);
  CHECK(loop.scene.touches[0].site == 0);
  // A body without tables always has this law.
  CHECK(make_loop().session.body().response.contact() == ContactKind::kSite);
}

TEST_CASE("a body with inertia rings when it is let go, without it is at rest at once",
          "[session]") {
  SessionSettings inert = kEverythingPresses;
  inert.dynamics = true;
  FrameLoop moving = touchable_sphere_loop(inert, true),
            resting = touchable_sphere_loop(kEverythingPresses, true);
  const Eigen::Matrix3Xf rest = moving.session.body().model().surface.vertices.cast<float>();
  for (int n = 0; n < 8; ++n) {
    const Frame frame = frame_with_finger(n, 0.001 * n);
    moving.process(frame);
    resting.process(frame);
  }
  REQUIRE_FALSE(moving.scene.touches.empty());
  REQUIRE_FALSE(resting.scene.touches.empty());
  CHECK(resting.scene.ringing == 0);
  double before = 1e9;
  for (int n = 8; n < 12; ++n) {
    const Frame frame = frame_with_finger(n, -0.03);
    const Scene& scene = moving.process(frame);
    CHECK(scene.touches.empty());
    CHECK(scene.bodies[0].vertices != rest);
    CHECK(scene.ringing > 0);
    CHECK(scene.ringing < before);
    before = scene.ringing;
    CHECK(resting.process(frame).bodies[0].vertices == rest);
  }
  for (int n = 12; n < 80; ++n) moving.process(frame_with_finger(n, -0.03));
  CHECK(moving.scene.ringing == 0);
  CHECK(moving.scene.bodies[0].vertices == rest);
}

TEST_CASE("a touched body with tables gives the same bytes again", "[session]") {
  FrameLoop one = touchable_sphere_loop(), other = touchable_sphere_loop();
  for (int n = 0; n < 6; ++n) {
    const Frame frame = frame_with_finger(n, n < 2 ? -0.03 : 0.002 * n);
    CHECK(one.process(frame).bodies[0].vertices == other.process(frame).bodies[0].vertices);
    CHECK(one.scene.bodies[0].von_mises == other.scene.bodies[0].von_mises);
  }
}

TEST_CASE("of several bodies the pressed one is reported, and the others stay at rest",
          "[session][scene]") {
  std::vector<PlacedBody> bodies;
  Rigid3 aside = sphere_pose();
  aside.translation().x() += 0.14;
  bodies.push_back({TouchableBody(test::DentedSphere{}.body()), aside, "aside", Rgb{1, 2, 3}});
  bodies.push_back({TouchableBody(test::DentedSphere{}.body()), sphere_pose(), "pressed"});
  FrameLoop loop =
      value_or_throw(FrameLoop::make(std::move(bodies), depth_format(), kEverythingPresses));
  REQUIRE(loop.session.body_count() == 2);
  CHECK(loop.session.body(1).name == "pressed");
  CHECK(loop.session.body(0).color == Rgb{1, 2, 3});
  CHECK_FALSE(loop.session.body(1).color);
  FrameLoop alone = make_loop();
  CHECK(alone.session.body().name == test::DentedSphere{}.body().name);
  for (int n = 0; n < 6; ++n) {
    const Frame frame = frame_with_finger(n, n < 3 ? -0.03 : 0.008);
    loop.process(frame);
    alone.process(frame);
  }
  const Scene& scene = loop.scene;
  REQUIRE(scene.bodies.size() == 2);
  REQUIRE(scene.touches.size() == 1);
  CHECK(scene.touches[0].body == 1);
  CHECK(scene.touches[0].by == -1);
  CHECK(scene.touches[0].press_depth ==
        Approx(alone.scene.touches.at(0).press_depth)
            .margin(tolerance(5e-4, "m: the part of the image that is searched is larger")));
  CHECK(scene.bodies[0].vertices == loop.session.body(0).model().surface.vertices.cast<float>());
  CHECK_FALSE(scene.bodies[1].vertices == scene.bodies[0].vertices);
  CHECK((scene.bodies[0].camera_from_body.translation() - aside.translation()).norm() == 0);
}

TEST_CASE("the bodies of a session that ends respond in the next one as in the first",
          "[session]") {
  FrameLoop loop = touchable_sphere_loop(), fresh = touchable_sphere_loop();
  for (int n = 0; n < 6; ++n) loop.process(frame_with_finger(n, 0.002 * n));
  std::vector<PlacedBody> bodies = loop.session.take_bodies();
  REQUIRE(bodies.size() == 1);
  CHECK(bodies[0].world_from_body.matrix() == sphere_pose().matrix());
  loop.session = value_or_throw(
      Session::make(std::move(bodies), loop.camera, depth_format(), loop.session.settings()));
  for (int n = 0; n < 6; ++n) {
    const Frame frame = frame_with_finger(n, n < 3 ? -0.03 : 0.002 * n);
    CHECK(loop.process(frame).bodies[0].vertices == fresh.process(frame).bodies[0].vertices);
    CHECK(loop.scene.touches.size() == fresh.scene.touches.size());
  }
  CHECK_FALSE(loop.scene.touches.empty());
}

TEST_CASE("with Algorithm 1 as printed a body presses the one that nothing real is near, one way",
          "[session][scene]") {
  SessionSettings settings = kEverythingPresses;
  settings.contact = ContactKind::kPaper;
  const double diameter = 2 * test::DentedSphere{}.radius;
  Rigid3 below = sphere_pose();
  below.translation() -= sphere_pose().linear() * Vector3d(0, 0, diameter + 0.004);
  std::vector<PlacedBody> bodies;
  bodies.push_back({TouchableBody(test::DentedSphere{}.body()), below, "lower"});
  bodies.push_back({TouchableBody(test::DentedSphere{}.body()), sphere_pose(), "upper"});
  FrameLoop loop = value_or_throw(FrameLoop::make(std::move(bodies), depth_format(), settings));
  for (int n = 0; n < 3; ++n) CHECK(loop.process(frame_with_finger(n, -0.2)).touches.empty());
  for (int n = 3; n < 8; ++n) loop.process(frame_with_finger(n, 0.008));
  int upper = 0, lower = 0;
  for (const Touch& touch : loop.scene.touches) {
    upper += touch.body == 1 && touch.by == -1;
    lower += touch.body == 0 && touch.by == 1;
  }
  CHECK(upper == 1);
  CHECK(lower == 1);
}

TEST_CASE("a body with an energy in modes deforms under a finger", "[session][scene]") {
  const ReducedBody ball = test::with_several(test::pressed_ball());
  ModalTables tables;
  const int V = ball.surface.vertex_count();
  tables.shell.stress_free = ball.surface.vertices;
  tables.shell.preload = Eigen::Matrix3Xd::Zero(3, V);
  tables.shell.first.assign(static_cast<std::size_t>(V) + 1, 0);
  tables.inner_modes.resize(0, ball.several->mode_count());
  tables.half_space = 1e-5;
  tables.point_spacing = 0.004;
  REQUIRE(trouble_of(tables, ball).empty());
  std::vector<PlacedBody> bodies;
  bodies.push_back({TouchableBody(ball, {}, tables), sphere_pose(), "ball"});
  FrameLoop loop =
      value_or_throw(FrameLoop::make(std::move(bodies), depth_format(), kEverythingPresses));
  CHECK(loop.session.body().response.contact() == ContactKind::kAnywhere);
  for (int n = 0; n < 3; ++n) loop.process(frame_with_finger(n, -0.03));
  for (int n = 3; n < 7; ++n) loop.process(frame_with_finger(n, 0.002 * (n - 2)));
  REQUIRE_FALSE(loop.scene.touches.empty());
  Vector3d force = Vector3d::Zero();
  for (const Touch& touch : loop.scene.touches) force += touch.force * touch.direction;
  CHECK(force.z() < 0);
  const Eigen::Matrix3Xf moved =
      loop.scene.bodies[0].vertices - ball.surface.vertices.cast<float>();
  CHECK(moved.row(2).minCoeff() < -0.003f);
  CHECK(loop.process(frame_with_finger(7, -0.03)).touches.empty());
}

TEST_CASE("a finger that presses the top dents the top, and leaves it at rest afterwards",
          "[session]") {
  FrameLoop loop = make_loop();
  const test::DentedSphere sphere;
  for (int n = 0; n < 3; ++n) CHECK(loop.process(frame_with_finger(n, -0.03)).touches.empty());
  for (int n = 3; n < 8; ++n) loop.process(frame_with_finger(n, 0.010));
  const Scene& pressed = loop.process(frame_with_finger(8, 0.010));
  REQUIRE(pressed.touches.size() == 1);
  const Touch touch = pressed.touches.front();
  CHECK(touch.site == 0);
  CHECK(pressed.number == 8);
  CHECK(pressed.time == Approx(8 / 30.0));
  const double dent = sphere.depth(touch.level);
  CHECK(dent > 0.010 - tolerance(0.0015, "sigma of the surface, as much hysteresis"));
  CHECK(dent < 0.010 + tolerance(0.004, "neighbours 6 mm aside move less than the middle"));
  const int top = loop.session.body().model().sites[0].vertex;
  CHECK(pressed.bodies[0].vertices(2, top) == Approx(2 * sphere.radius - dent).margin(1e-5));
  CHECK(pressed.bodies[0].von_mises[top] > 0);
  CHECK((touch.point_in_body - Vector3d(0, 0, 0.1)).norm() < 0.02);

  const Scene& after = loop.process(frame_with_finger(9, -0.2));
  CHECK(after.touches.empty());
  CHECK(after.bodies[0].vertices == loop.session.body().model().surface.vertices.cast<float>());
  for (const float value : after.bodies[0].von_mises) CHECK(value == 0);
}

TEST_CASE("the stress of a scene is that of its touch", "[session]") {
  FrameLoop loop = make_loop();
  for (int n = 0; n < 4; ++n) loop.process(frame_with_finger(n, 0.008));
  const Scene& scene = loop.process(frame_with_finger(4, 0.008));
  REQUIRE(scene.touches.size() == 1);
  // The dented sphere's stress at the middle is diag(-p, -p, -2p) with p = 1e4 depth / deepest.
  const test::DentedSphere sphere;
  const double p = 1e4 * sphere.depth(scene.touches[0].level) / sphere.deepest;
  CHECK(scene.bodies[0].von_mises[loop.session.body().model().sites[0].vertex] ==
        Approx(p).epsilon(tolerance(1e-3, "cubic between samples of a parabola, floats")));
}

// Von Mises stress of a vertex from its six components, Pa.
double mises_of(const SceneBody& body, std::size_t v) {
  std::array<double, 6> s{};
  for (std::size_t c = 0; c < 6; ++c) s[c] = static_cast<double>(body.cauchy[6 * v + c]);
  const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) +
                   3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

// Checks that the components give the von Mises stress. @return the largest von Mises stress, Pa
double check_components(const SceneBody& body) {
  REQUIRE(body.cauchy.size() == 6 * body.von_mises.size());
  const double largest =
      static_cast<double>(*std::max_element(body.von_mises.begin(), body.von_mises.end()));
  double apart = 0;
  for (std::size_t v = 0; v < body.von_mises.size(); ++v) {
    apart = std::max(apart, std::abs(mises_of(body, v) - static_cast<double>(body.von_mises[v])));
  }
  CHECK(apart <= tolerance(1e-3 * largest + 1e-3, "Pa: floats, whose differences are small"));
  return largest;
}

constexpr SceneExtras kAllExtras{.components = true, .contact_pressure = true};

// Checks that the pressure adds up to the forces of the scene's touches. A body with sites alone
// has none.
void check_contact_pressure(const FrameLoop& loop) {
  const SceneBody& body = loop.scene.bodies[0];
  if (loop.session.body(0).response.contact() != ContactKind::kAnywhere) {
    CHECK(body.contact_pressure.empty());
    return;
  }
  REQUIRE(body.contact_pressure.size() == body.von_mises.size());
  SurfaceMesh now = loop.session.body(0).model().surface;
  now.vertices = body.vertices.cast<double>();
  const Eigen::VectorXd areas = vertex_areas(now);
  double sum = 0, force = 0;
  for (std::size_t v = 0; v < body.contact_pressure.size(); ++v) {
    sum += static_cast<double>(body.contact_pressure[v]) * areas[static_cast<Eigen::Index>(v)];
  }
  for (const Touch& touch : loop.scene.touches) force += touch.force;
  // A touch has the sum of its forces as vectors. The forces around a fingertip diverge, by up to
  // 45 degrees where it has sunk into the ball in modes, so the sum of their norms is larger.
  CHECK(sum >= force * (1 - 1e-3));
  CHECK(sum <= force * 1.42);
}

TEST_CASE("scenes have the extras that are kept, and nothing else differs", "[session]") {
  ModalTables modal;
  const ReducedBody ball = test::with_several(test::pressed_ball());
  const int V = ball.surface.vertex_count();
  modal.shell.stress_free = ball.surface.vertices;
  modal.shell.preload = Eigen::Matrix3Xd::Zero(3, V);
  modal.shell.first.assign(static_cast<std::size_t>(V) + 1, 0);
  modal.inner_modes.resize(0, ball.several->mode_count());
  modal.half_space = 1e-5;
  modal.point_spacing = 0.004;
  SessionSettings as_printed = kEverythingPresses;
  as_printed.contact = ContactKind::kPaper;
  const auto loops = [&]() {
    std::vector<FrameLoop> made;
    made.push_back(touchable_sphere_loop());
    made.push_back(make_loop());
    made.push_back(make_loop(as_printed));
    std::vector<PlacedBody> bodies;
    bodies.push_back({TouchableBody(ball, {}, modal), sphere_pose(), "ball"});
    made.push_back(
        value_or_throw(FrameLoop::make(std::move(bodies), depth_format(), kEverythingPresses)));
    return made;
  };
  std::vector<FrameLoop> without = loops(), with = loops();
  for (std::size_t k = 0; k < with.size(); ++k) {
    INFO("kind " << k);
    CHECK(with[k].session.kept() == SceneExtras{});
    with[k].session.keep(kAllExtras);
    for (int n = 0; n < 6; ++n) {
      const Frame frame = frame_with_finger(n, n < 3 ? -0.03 : 0.008);
      const SceneBody& one = with[k].process(frame).bodies[0];
      const SceneBody& other = without[k].process(frame).bodies[0];
      CHECK(one.vertices == other.vertices);
      CHECK(one.normals == other.normals);
      CHECK(one.von_mises == other.von_mises);
      CHECK(other.cauchy.empty());
      CHECK(other.contact_pressure.empty());
      (void)check_components(one);
      check_contact_pressure(with[k]);
    }
    REQUIRE_FALSE(with[k].scene.touches.empty());
    if (k < 3) CHECK(check_components(with[k].scene.bodies[0]) > 100);  // the ball's shell is empty
    with[k].session.keep({});
    CHECK(with[k].process(frame_with_finger(6, 0.008)).bodies[0].cauchy.empty());
    CHECK(with[k].scene.bodies[0].contact_pressure.empty());
  }
}

TEST_CASE("at rest the components are those of the preload", "[session]") {
  const ReducedBody body = test::DentedSphere{}.body();
  TouchTables tables = test::yielding_tables(body.surface);
  tables.shell.preload.setZero();
  tables.shell.preload.row(2) = 0.01 * tables.shell.stress_free.row(2);  // stretched along z
  FrameLoop loop = value_or_throw(FrameLoop::make(TouchableBody(body, tables), sphere_pose(),
                                                  depth_format(), kEverythingPresses));
  loop.session.keep(kAllExtras);
  const SceneBody& shown = loop.process(frame_with_finger(0, -0.03)).bodies[0];
  CHECK(loop.scene.touches.empty());
  CHECK(check_components(shown) > 100);
  for (std::size_t v = 0; v < shown.von_mises.size(); ++v) {
    const float* s = shown.cauchy.data() + 6 * v;
    CHECK(s[2] > 300);  // Pa: E = 40 or 60 kPa, strained by a hundredth
    CHECK(s[2] > s[0]);
    CHECK(s[2] > s[1]);
    for (int shear = 3; shear < 6; ++shear) {
      CHECK(std::abs(s[shear]) < tolerance(1.0f, "Pa, single precision"));
    }
  }
}

TEST_CASE("replaying the same frames gives the same bytes", "[session]") {
  std::vector<Frame> frames;
  for (int n = 0; n < 12; ++n) frames.push_back(frame_with_finger(n, -0.01 + 0.002 * n));
  std::vector<Eigen::Matrix3Xf> first;
  std::vector<double> levels;
  for (int run = 0; run < 2; ++run) {
    FrameLoop loop = make_loop();
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const Scene& scene = loop.process(frames[n]);
      const double level = scene.touches.empty() ? 0 : scene.touches[0].level;
      if (run == 0) {
        first.push_back(scene.bodies[0].vertices);
        levels.push_back(level);
      } else {
        CHECK(scene.bodies[0].vertices == first[n]);
        CHECK(level == levels[n]);
      }
    }
  }
  CHECK(levels.front() == 0);
  CHECK(levels.back() > 0.3);
}

TEST_CASE("the two halves of a loop do what process does, in whichever scenes", "[session]") {
  FrameLoop whole = make_loop();
  FrameLoop halves = make_loop();
  Scene scenes[2];  // in turn, as in a loop with two threads
  for (int n = 0; n < 6; ++n) {
    const Frame frame = frame_with_finger(n, 0.002 * n);
    const Scene& expected = whole.process(frame);
    Scene& scene = scenes[n % 2];
    halves.camera.see(frame, scene.seen);
    halves.session.respond(scene);
    CHECK(scene.number == expected.number);
    CHECK(scene.seen.depth.width() == expected.seen.depth.width());
    CHECK(scene.bodies[0].vertices == expected.bodies[0].vertices);
    CHECK(scene.bodies[0].normals == expected.bodies[0].normals);
    CHECK(scene.touches.size() == expected.touches.size());
  }
  CHECK(scenes[1].touches.size() == 1);
}

TEST_CASE("a scene that was kept stays as it was", "[session]") {
  FrameLoop loop = make_loop({.press_static = true});
  for (int n = 0; n < 6; ++n) loop.process(frame_with_finger(n, 0.010));
  const Scene kept = loop.scene;
  const DepthImage depth = kept.seen.depth;
  const Eigen::Matrix3Xf vertices = kept.bodies[0].vertices;
  REQUIRE(kept.touches.size() == 1);
  REQUIRE_FALSE(kept.moving.empty());
  const MaskImage moving = kept.moving;
  for (int n = 6; n < 12; ++n) loop.process(frame_with_finger(n, -0.2));
  REQUIRE(loop.scene.touches.empty());
  CHECK(kept.number == 5);
  CHECK(kept.touches.size() == 1);
  CHECK(kept.bodies[0].vertices == vertices);
  CHECK(kept.moving == moving);
  CHECK(std::equal(depth.begin(), depth.end(), kept.seen.depth.begin(),
                   [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
  CHECK_FALSE(kept.bodies[0].vertices == loop.scene.bodies[0].vertices);
}

// Frames in which only the room is seen: enough for the finger's place to be known as free.
constexpr int kBefore = 40;

// An obstacle presses from the third frame on in which it is seen.
constexpr int kUntilItPresses = 3;

TEST_CASE("a thing that was there when the body was anchored presses it only with press_static",
          "[session][presses]") {
  // The finger rests in the body from the first frame on.
  FrameLoop everything = make_loop({.press_static = true});
  CHECK(everything.process(frame_with_finger(0, 0.010)).touches.size() == 1);
  FrameLoop loop = make_loop({});
  for (int n = 0; n < 60; ++n) { CHECK(loop.process(frame_with_finger(n, 0.010)).touches.empty()); }
}

TEST_CASE("a thing that comes after the body was anchored presses it, and releases it at once",
          "[session][presses]") {
  FrameLoop loop = make_loop({});
  int n = 0;
  for (; n < kBefore; ++n) CHECK(loop.process(frame_with_finger(n, -0.3)).touches.empty());
  for (int k = 1; k < kUntilItPresses; ++k) loop.process(frame_with_finger(n++, 0.010));
  CHECK(loop.process(frame_with_finger(n++, 0.010)).touches.size() == 1);
  const MaskImage& shows = loop.session.shows();
  CHECK(std::count(shows.begin(), shows.end(), kShowsPresser) > 100);
  CHECK(loop.process(frame_with_finger(n++, -0.3)).touches.empty());
  CHECK(std::count(shows.begin(), shows.end(), kShowsPresser) == 0);
}

TEST_CASE("a thing that was put against the body and left there keeps pressing it",
          "[session][presses][long]") {
  FrameLoop loop = make_loop({});
  int n = 0;
  for (; n < kBefore; ++n) CHECK(loop.process(frame_with_finger(n, -0.3)).touches.empty());
  for (int k = 1; k < kUntilItPresses; ++k) loop.process(frame_with_finger(n++, 0.010));
  for (const int end = n + 2000; n < end; ++n) {
    INFO("frame " << n);
    CHECK(loop.process(frame_with_finger(n, 0.010)).touches.size() == 1);
  }
  CHECK(loop.process(frame_with_finger(n++, -0.3)).touches.empty());
}

TEST_CASE("the paper's algorithm stays pressed when the hand leaves fast, the default does not",
          "[session][Alg1]") {
  SessionSettings settings = kEverythingPresses;
  settings.contact = ContactKind::kPaper;
  FrameLoop paper = make_loop(settings);
  FrameLoop ours = make_loop();
  for (int n = 0; n < 20; ++n) {
    const Frame frame = frame_with_finger(n, n < 8 ? 0.004 : -0.2);
    const bool paper_pressed = !paper.process(frame).touches.empty();
    const bool our_pressed = !ours.process(frame).touches.empty();
    if (n == 7) {
      CHECK(paper_pressed);
      CHECK(our_pressed);
    }
    if (n >= 8) {
      CHECK(paper_pressed);
      CHECK_FALSE(our_pressed);
    }
  }
}

TEST_CASE("a frame without any depth holds the press; after a while it fades",
          "[session][presses]") {
  FrameLoop loop = make_loop();
  int n = 0;
  for (; n < 60; ++n) loop.process(frame_with_finger(n, 0.010));  // until the filter has settled
  REQUIRE(loop.scene.touches.size() == 1);
  const double before = loop.scene.touches[0].press_depth;
  CHECK(loop.scene.touches[0].unseen_for == 0);
  const auto show_nothing = [&] {
    Frame blind = frame_with_finger(n++, 0.010);
    for (float& z : blind.depth) z = std::numeric_limits<float>::quiet_NaN();
    return loop.process(blind).touches;
  };
  for (int k = 0; k < 8; ++k) {  // 0.27 s
    const auto touches = show_nothing();
    REQUIRE(touches.size() == 1);
    CHECK(touches[0].press_depth == Approx(before).epsilon(1e-6));
    CHECK(touches[0].unseen_for == Approx((k + 1) / 30.0).epsilon(1e-5));
  }
  for (int k = 0; k < 12; ++k) show_nothing();  // 0.67 s in all
  CHECK(loop.scene.touches.empty());
}

// Two scenes, with a finger away from a body and one that presses it, processed in turn.
struct AwayAndPressing {
  explicit AwayAndPressing(FrameLoop& the_loop) : loop(the_loop) {
    loop.camera.see(frame_with_finger(0, -0.3), away.seen);
    loop.camera.see(frame_with_finger(9, 0.006), pressing.seen);
  }
  void respond(Scene& scene, int times) {
    for (int k = 0; k < times; ++k) {
      scene.seen.time = time += 1.0 / 30;
      loop.session.respond(scene);
    }
  }
  FrameLoop& loop;
  Scene away, pressing;
  double time = 0;
};

TEST_CASE("contact and reconstruction allocate nothing after the first frames",
          "[session][frame loop]") {
  struct Case {
    ContactKind kind;
    PaperSettings paper;
  };
  const PaperSettings all{.nodes = QueriedNodes::kAll, .distance = DistanceQuery::kVoxmap};
  for (const auto& [kind, paper] : {Case{ContactKind::kSite, {}}, Case{ContactKind::kPaper, {}},
                                    Case{ContactKind::kPaper, all}}) {
    SessionSettings settings;
    settings.contact = kind;
    settings.paper = paper;
    FrameLoop loop = make_loop(settings);
    AwayAndPressing finger(loop);
    finger.respond(finger.away, kBefore);
    finger.respond(finger.pressing, kUntilItPresses + 1);
    finger.respond(finger.away, 1);
    CHECK(test::allocations_during([&] {
            finger.respond(finger.pressing, kUntilItPresses + 1);
            finger.respond(finger.away, 1);
          }) == 0);
    CHECK(finger.pressing.touches.size() == 1);
    // As printed, Algorithm 1 leaves a body pressed when nothing is near any more.
    CHECK(finger.away.touches.empty() == (kind == ContactKind::kSite));
  }
}

TEST_CASE("a scene that keeps extras takes memory for them once", "[session]") {
  FrameLoop loop = touchable_sphere_loop();
  loop.session.keep(kAllExtras);
  AwayAndPressing finger(loop);
  finger.respond(finger.away, kBefore);
  finger.respond(finger.pressing, kUntilItPresses + 3);
  finger.respond(finger.away, 1);
  CHECK(test::allocations_during([&] {
          finger.respond(finger.pressing, kUntilItPresses + 3);
          finger.respond(finger.away, 1);
          loop.session.keep({});
          finger.respond(finger.pressing, 1);
          loop.session.keep(kAllExtras);
          finger.respond(finger.pressing, 1);
        }) == 0);
  CHECK_FALSE(finger.pressing.touches.empty());
}

TEST_CASE("a scene has the times of all stages of its frame, and not of earlier ones",
          "[session]") {
  FrameLoop loop = make_loop();
  loop.process(frame_with_finger(0, 0.006));
  const Scene& scene = loop.process(frame_with_finger(1, 0.006));
  CHECK(scene.times.ms("contact") > 0);
  CHECK(scene.times.ms("evaluate") > 0);
  const StageTimes& seeing = loop.camera.last_times();
  REQUIRE_FALSE(seeing.stages().empty());
  for (const StageTime& stage : seeing.stages()) CHECK(scene.times.ms(stage.name) == stage.ms);
}

TEST_CASE("settings out of range and formats without numbers are problems, not crashes",
          "[session][errors]") {
  const auto refused = [](const SessionSettings& settings) {
    return !FrameLoop::make(test::DentedSphere{}.body(), sphere_pose(), depth_format(), settings)
                .ok();
  };
  CHECK_FALSE(refused({}));
  CHECK(refused({.map = false}));  // what was there before would be unknown
  CHECK_FALSE(refused({.press_static = true, .map = false}));
  SessionSettings thin;
  thin.surface.balls.most_radius = 0;
  CHECK(refused(thin));
  SessionSettings crossed;
  crossed.paper = {.press_distance = 0.02, .release_distance = 0.01};
  CHECK(refused(crossed));
  SessionSettings endless;
  endless.paper.release_distance = std::numeric_limits<double>::infinity();
  CHECK(refused(endless));
  for (const double side : {0.0, -0.004, std::nan(""), std::numeric_limits<double>::infinity()}) {
    SessionSettings voxels;
    voxels.paper.voxel = side;
    CHECK(refused(voxels));
  }
  FrameFormat nothing = depth_format();
  nothing.kind = FrameFormat::Kind::kStereo;
  CHECK_FALSE(FrameLoop::make(test::DentedSphere{}.body(), sphere_pose(), nothing).ok());
}

TEST_CASE("a body keeps its pose in the room while the camera moves, if the camera is tracked",
          "[session]") {
  SessionSettings settings;
  settings.track = true;
  FrameLoop followed = make_loop(settings);
  FrameLoop fixed = make_loop();
  for (int n = 0; n < 12; ++n) {
    const double x = 0.004 * n;
    const Scene& scene = followed.process(test::frame_of_wall(n, x));
    INFO("frame " << n << ", state " << static_cast<int>(scene.camera.state));
    CHECK((scene.bodies[0].camera_from_body.translation() - sphere_pose().translation() +
           Vector3d(x, 0, 0))
              .norm() <=
          tolerance(1.5e-3,
                    "a third of a pixel of 250 px at 0.8 m; less than 0.3 px counts as no motion"));
    CHECK(fixed.process(test::frame_of_wall(n, x)).bodies[0].camera_from_body.matrix() ==
          sphere_pose().matrix());
  }
  CHECK(followed.session.slam().tracker()->counts().lost == 0);
}

TEST_CASE(
    "a session with given poses responds as one with a fixed camera, whatever the world frame",
    "[session]") {
  Rigid3 world_from_camera = Rigid3::Identity();
  world_from_camera.linear() =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  world_from_camera.translation() = Vector3d(0.3, -0.2, 0.5);
  FrameLoop stands = make_loop({});
  FrameLoop given =
      value_or_throw(FrameLoop::make(test::DentedSphere{}.body(), world_from_camera * sphere_pose(),
                                     depth_format(), SessionSettings{}));
  const auto respond = [&](const Frame& frame, const std::optional<Rigid3>& where) {
    given.camera.see(frame, given.scene.seen);
    given.session.respond(given.scene, where);
  };
  int n = 0, touching = 0;
  for (; n < kBefore + 6; ++n) {
    const Frame frame = frame_with_finger(n, n < kBefore ? -0.3 : 0.010);
    stands.process(frame);
    respond(frame, world_from_camera);
    CHECK(given.scene.camera.state == TrackState::kTracking);
    REQUIRE(given.scene.touches.size() == stands.scene.touches.size());
    CHECK(given.scene.bodies[0].camera_from_body.isApprox(sphere_pose(), 1e-12));
    touching += given.scene.touches.empty() ? 0 : 1;
  }
  REQUIRE(touching > 0);
  CHECK(given.scene.touches[0].press_depth ==
        Approx(stands.scene.touches[0].press_depth)
            .margin(tolerance(2e-4, "m: the room's voxels have another orientation")));
  respond(frame_with_finger(n, 0.010), std::nullopt);
  CHECK(given.scene.camera.state == TrackState::kLost);
  CHECK_THROWS_AS(make_loop({.track = true}).session.respond(given.scene, world_from_camera),
                  ContractViolation);
}

TEST_CASE("nothing presses while the camera is lost, and the mask is empty", "[session]") {
  FrameLoop loop = make_loop({.track = true, .map = true});
  int number = 0;
  for (const double x : {0.0, 0.0, 0.01, 0.02, 0.03, 0.02, 0.01, 0.0}) {
    CHECK_FALSE(loop.process(test::frame_of_wall(number++, x)).moving.empty());
  }
  for (int n = 0; n < 5; ++n) {
    Frame frame = frame_with_finger(number++, 0.006);
    std::fill(frame.left.begin(), frame.left.end(), Rgb{0, 0, 0});
    const Scene& scene = loop.process(frame);
    REQUIRE(scene.camera.state == TrackState::kLost);
    CHECK(scene.touches.empty());
    CHECK(scene.moving.empty());
  }
}

TEST_CASE("a session knows what was in the room when the body was anchored", "[session]") {
  CHECK(make_loop().session.anchored_scene() == nullptr);
  SessionSettings settings;
  settings.map = true;
  FrameLoop loop = make_loop(settings);
  int number = 0;
  for (; number < 30; ++number) loop.process(test::frame_of_wall(number, 0));
  const auto was_there = [&](double Z) {
    return loop.session.anchored_scene()->was_there({0, 0, Z}, 0.015, *loop.session.slam().space());
  };
  CHECK(was_there(test::kWallZ));
  CHECK_FALSE(was_there(test::kWallZ - 0.05));
  CHECK_FALSE(was_there(0.4));
  CHECK(loop.session.slam().space()->is_free({0, 0, 0.4}));
}

TEST_CASE("what a camera saw before it moved in the dark is not the body's room", "[session]") {
  FrameLoop loop = make_loop({.track = true, .map = true});
  int number = 0;
  const auto show = [&](double z, bool dark) {
    Frame frame = test::frame_of_wall(number++, 0, z);
    if (dark) std::fill(frame.left.begin(), frame.left.end(), Rgb{});
    return loop.process(frame).camera;
  };
  for (int n = 0; n < 20; ++n) CHECK(show(0, true).state == TrackState::kStarting);
  CHECK(loop.session.anchored_scene()->blocks() > 0);
  for (int n = 0; n < 5; ++n) CHECK(show(0.3, true).state == TrackState::kLost);
  bool began = false;
  for (int n = 0; n < 6 && !began; ++n) began = show(0.3, false).new_world;
  REQUIRE(began);
  CHECK(loop.session.anchored_scene()->blocks() == 0);
}

TEST_CASE("what was in the room when the body was anchored is not forgotten when a loop is closed",
          "[session][long]") {
  SessionSettings settings;
  settings.track = true;
  settings.map = true;
  FrameLoop loop = std::move(
      FrameLoop::make(test::DentedSphere{}.body(), sphere_pose(), test::creeping_format(), settings)
          .value());
  int closed = 0;
  for (int n = 0; n < test::kCreepingFrames; ++n) {
    const int blocks = loop.session.anchored_scene()->blocks();
    if (!loop.process(test::creeping_frame(n)).camera.closed_loop) continue;
    ++closed;
    CHECK(loop.session.slam().map()->blocks() == 0);
    CHECK(loop.session.anchored_scene()->blocks() > blocks / 2);
  }
  CHECK(closed >= 1);
  // The map has no walls to the right and behind the camera yet. A thing close in front of one was
  // not there at first, which is remembered from before the loop was closed. (What is unknown
  // counts as the room. The wall to the left is not used: its measured depths shrink while it is
  // seen, so it seems to move and not all of it came into the map.)
  for (const Vector3d& out : {Vector3d(1, 0, 0), Vector3d(0, 0, -1)}) {
    INFO("towards " << out.transpose());
    int before_wall = 0;  // points, 5 mm apart
    for (double away = 1; away < 2; away += 0.005) {
      const Vector3d p = Vector3d(0, 0, -0.7) + away * out;  // from the room's middle
      REQUIRE_FALSE(loop.session.slam().map()->distance(p));
      before_wall +=
          loop.session.anchored_scene()->was_there(p, 0.015, *loop.session.slam().space()) ? 0 : 1;
    }
    CHECK(before_wall >= 3);  // distances are kept up to 40 mm
  }
}

}  // namespace
}  // namespace palpable
