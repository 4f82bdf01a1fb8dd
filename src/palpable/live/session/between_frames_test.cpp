#include "palpable/live/session/between_frames.h"

#include "palpable/live/session/frame_loop.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/pressed_sphere.h"
#include "tests/support/test.h"

#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

double force_of(const std::vector<Touch>& touches) {
  double force = 0;
  for (const Touch& touch : touches) force += touch.force;
  return force;
}

double farthest(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

// A session and its BetweenFrames, for frames in which a finger presses a sphere.
struct Pressed {
  explicit Pressed(const SessionSettings& settings = test::kEverythingPresses)
      : loop(test::touchable_sphere_loop(settings)) {}

  FrameLoop loop;
  BetweenFrames between{loop.session};
  SolvedFrame solved;

  void press(int frame, double depth) {
    loop.process(test::frame_with_finger(frame, depth));
    solved.take(loop.session, loop.scene);
    between.begin(solved);
  }
};

TEST_CASE(
    "between frames a finger advances, and the body deforms towards the state of the next frame",
    "[session][between]") {
  Pressed of;
  for (int n = 0; n < 6; ++n) of.press(n, 0.001 * n);
  const Eigen::Matrix3Xf before = of.loop.scene.bodies[0].vertices;
  const double force_before = force_of(of.loop.scene.touches);
  REQUIRE(force_before > 0);
  CHECK(of.between.interval() == Approx(1.0 / 30).margin(1e-9));
  CHECK(force_of(of.between.touches()) == Approx(force_before));  // it begins where the frame is
  Eigen::Matrix3Xf skin(3, before.cols());
  of.between.place(skin);
  CHECK(farthest(skin, before) == 0);
  double last = 0;
  for (int tick = 1; tick <= 10; ++tick) {
    of.between.advance(tick / 300.0);
    last = force_of(of.between.touches());
    CHECK(last > force_before);
  }
  of.between.place(skin);
  of.press(6, 0.006);
  const Eigen::Matrix3Xf& next = of.loop.scene.bodies[0].vertices;
  // A pixel of this camera is 2.3 mm there, so the seen finger advances unevenly.
  CHECK(farthest(skin, next) < farthest(before, next));
  const double next_force = force_of(of.loop.scene.touches);
  CHECK(std::abs(last - next_force) < tolerance(0.8, "of the step") * (next_force - force_before));
}

TEST_CASE("results between frames are the same each time, and change no frame",
          "[session][between]") {
  Pressed one, other;
  FrameLoop alone = test::touchable_sphere_loop();
  Eigen::Matrix3Xf skin(3, one.loop.session.body().model().surface.vertex_count()), again = skin;
  for (int n = 0; n < 6; ++n) {
    one.press(n, 0.001 * n);
    other.press(n, 0.001 * n);
    for (int tick = 1; tick <= 8; ++tick) {
      one.between.advance(tick * 0.004);
      other.between.advance(tick * 0.004);
    }
    one.between.place(skin);
    other.between.place(again);
    CHECK(skin == again);
    CHECK(one.loop.scene.bodies[0].vertices ==
          alone.process(test::frame_with_finger(n, 0.001 * n)).bodies[0].vertices);
  }
}

TEST_CASE("between frames things rub as in the frame before, and change no frame",
          "[session][between][friction]") {
  SessionSettings settings = test::kEverythingPresses;
  settings.touch.friction = 0.5;
  Pressed one(settings), other(settings);
  FrameLoop alone = test::touchable_sphere_loop(settings);
  Eigen::Matrix3Xf skin(3, one.loop.session.body().model().surface.vertex_count()), again = skin;
  for (int n = 0; n < 8; ++n) {
    one.press(n, 0.001 * n);
    other.press(n, 0.001 * n);
    REQUIRE(one.solved.interval);  // the session knows the motion: it is not estimated again
    CHECK(one.solved.velocities.size() == one.solved.balls.size());
    CHECK(one.between.interval() == *one.solved.interval);
    for (int tick = 1; tick <= 8; ++tick) {
      one.between.advance(tick * 0.004);
      other.between.advance(tick * 0.004);
      for (const Touch& touch : one.between.touches()) {
        const double normal = (touch.whole_force() - touch.friction).norm();
        CHECK(touch.friction.norm() <=
              tolerance(1.1, "normals differ by some degrees") * 0.5 * normal);
      }
    }
    one.between.place(skin);
    other.between.place(again);
    CHECK(skin == again);
    CHECK(one.loop.scene.bodies[0].vertices ==
          alone.process(test::frame_with_finger(n, 0.001 * n)).bodies[0].vertices);
  }
  REQUIRE_FALSE(one.loop.scene.touches.empty());
  CHECK(one.loop.scene.touches[0].coefficient == 0.5);  // it has faded in
  CHECK(one.loop.session.body().response.coefficient() == 0.5);
}

TEST_CASE("a session whose contact cannot be solved between frames is refused with the reason",
          "[session][between]") {
  const FrameLoop sites =
      std::move(FrameLoop::make(test::DentedSphere{}.body(), test::sphere_pose(),
                                test::wall_format(), test::kEverythingPresses)
                    .value());
  const auto trouble = BetweenFrames::trouble_of(sites.session);
  REQUIRE(trouble);
  CHECK(trouble->message == "contact between frames needs a body with tables of touch");
  CHECK_FALSE(BetweenFrames::trouble_of(test::touchable_sphere_loop().session));
}

}  // namespace
}  // namespace palpable
