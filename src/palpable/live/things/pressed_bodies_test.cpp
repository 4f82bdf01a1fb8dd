#include "palpable/live/things/pressed_bodies.h"

#include "tests/support/dented_sphere.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// A ball of 50 mm radius that stands on Z = 0, with tables that give way.
std::shared_ptr<const TouchableBody> ball_body() {
  ReducedBody body = test::DentedSphere{}.body();
  TouchTables tables = test::yielding_tables(body.surface);
  tables.point_spacing = 0.003;
  return std::make_shared<const TouchableBody>(std::move(body), std::move(tables));
}

// A small ball that penetrates the large one by `depth`, from a direction between +X and +Z.
Capsule pressing(double x, double depth) {
  const Eigen::Vector3d from(x, 0, std::sqrt(1 - x * x));
  const Eigen::Vector3d centre = Eigen::Vector3d(0, 0, 0.05) + (0.058 - depth) * from;
  return {centre, centre, 0.008, 0.008};
}

struct Pressing {
  PressedBodies bodies;
  std::vector<SceneBody> shown = std::vector<SceneBody>(1);
  std::vector<Touch> touches;

  explicit Pressing(const Rigid3& pose = Rigid3::Identity(), double friction = 0)
      : bodies({{ball_body(), pose, friction}}) {}
  ContactReport press(const std::vector<CapsuleThing>& things) {
    return bodies.advance(things, shown, touches);
  }
};

TEST_CASE("a capsule presses the skin until it gives way", "[things]") {
  Pressing one;
  const std::array capsules{pressing(0, 0.003)};
  ContactReport report;
  for (int call = 0; call < 4; ++call) report = one.press({{5, capsules}});
  CHECK(report.reached() == Reached::kYes);
  REQUIRE(one.touches.size() == 1);
  CHECK(one.touches[0].thing == 0);
  CHECK(one.touches[0].direction.z() < -0.9);
  CHECK(std::abs(report.inside()) < tolerance(3e-4, "m: kReached"));
}

TEST_CASE("touches name their thing by its place in the list", "[things]") {
  Pressing two;
  const std::array left{pressing(-0.5, 0.001)}, right{pressing(0.5, 0.002)};
  for (int call = 0; call < 4; ++call) two.press({{7, left}, {3, right}});
  REQUIRE(two.touches.size() == 2);
  CHECK(two.touches[0].thing == 1);  // the deeper one is the stronger
  CHECK(two.touches[1].thing == 0);
}

// The tip of a small ball that presses from above, `aside` (m) along x.
Capsule above(double aside, double depth) {
  const Eigen::Vector3d centre(aside, 0, 0.108 - depth);
  return {centre, centre, 0.008, 0.008};
}

TEST_CASE("a thing is known by its id, and rubs where it goes", "[things][friction]") {
  Pressing rubs(Rigid3::Identity(), 1), slides, forgets(Rigid3::Identity(), 1);
  for (int call = 0; call < 8; ++call) {
    const std::array capsules{above(0.0001 * call, 0.003)};
    rubs.press({{5, capsules}});
    slides.press({{5, capsules}});
    forgets.press({{call, capsules}});  // another thing each time
  }
  REQUIRE(rubs.touches.size() == 1);
  REQUIRE(forgets.touches.size() == 1);
  CHECK(rubs.touches[0].friction.x() > 0.05 * rubs.touches[0].force);
  CHECK(slides.touches[0].friction.isZero(0));
  CHECK(rubs.touches[0].coefficient == 1);
  CHECK(slides.touches[0].coefficient == 0);
  CHECK(std::abs(forgets.touches[0].friction.x()) < 0.5 * rubs.touches[0].friction.x());
  // Forces have their friction; the normal is without it.
  const Touch& touch = rubs.touches[0];
  CHECK((touch.whole_force() - touch.friction).normalized().dot(touch.normal()) ==
        Approx(-1).margin(tolerance(1e-9, "rounding")));
  CHECK(slides.touches[0].normal() == -slides.touches[0].direction);
}

TEST_CASE("a thing's own coefficient counts more than the bodies'", "[things][friction]") {
  Pressing one(Rigid3::Identity(), 1), plain;
  for (int call = 0; call < 6; ++call) {
    const std::array capsules{above(0.0002 * call, 0.003)};
    one.press({{.id = 5, .capsules = capsules, .friction = 0}});
    plain.press({{5, capsules}});
  }
  CHECK(one.touches[0].friction.isZero(0));
  CHECK(one.touches[0].coefficient == 0);
  CHECK(one.shown[0].vertices == plain.shown[0].vertices);
}

TEST_CASE("capsules are in the world, the shown skin in the body's frame", "[things]") {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() << 0.5, -0.25, 1;
  Pressing here, there(pose);
  const std::array capsules{pressing(0, 0.003)};
  std::array moved = capsules;
  moved[0].a = pose * moved[0].a;
  moved[0].b = pose * moved[0].b;
  for (int call = 0; call < 4; ++call) {
    here.press({{0, capsules}});
    there.press({{0, moved}});
  }
  CHECK((here.shown[0].vertices - there.shown[0].vertices).cwiseAbs().maxCoeff() <
        tolerance(1e-6, "m: the pose rounds"));
}

TEST_CASE("forgotten bodies are as if nothing had pressed them", "[things]") {
  Pressing one, fresh;
  const std::array deep{pressing(0, 0.004)}, light{pressing(0.1, 0.001)};
  one.press({{0, deep}});
  one.bodies.forget();
  one.press({{0, light}});
  fresh.press({{0, light}});
  CHECK(one.shown[0].vertices == fresh.shown[0].vertices);
}

TEST_CASE("additional arrays are filled only on request", "[things]") {
  Pressing one;
  const std::array capsules{pressing(0, 0.003)};
  one.press({{0, capsules}});
  CHECK(one.shown[0].cauchy.empty());
  CHECK(one.shown[0].contact_pressure.empty());
  one.bodies.keep({.components = true, .contact_pressure = true});
  one.press({{0, capsules}});
  CHECK(one.shown[0].cauchy.size() == 6 * one.shown[0].von_mises.size());
  CHECK(one.shown[0].contact_pressure.size() == one.shown[0].von_mises.size());
}

}  // namespace
}  // namespace palpable
