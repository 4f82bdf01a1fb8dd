#include "palpable/common/response/skin_contact.h"

#include "tests/support/allocations.h"
#include "tests/support/elastic_sheet.h"
#include "tests/support/seen_surface.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

constexpr float kFinger = 0.008f;  // m, radius
const Vector3f kCamera(0, 0, 0.5f);

// A finger that points down at the sheet, its tip `depth` below the sheet's plane: balls on its
// axis, seen from above.
void add_finger(std::vector<ObjectBall>& balls, float x, float y, float depth, float sigma = 0,
                float unseen_for = 0) {
  for (float along = kFinger; along < 0.045f; along += 0.0005f) {
    const Vector3f centre(x, y, along - depth);
    balls.push_back(
        {centre + Vector3f(0, 0, kFinger), Vector3f::UnitZ(), centre, kFinger, sigma, unseen_for});
  }
}

struct Loop {
  test::ElasticSheet sheet;
  TouchSettings settings;
  SkinContact contact{sheet.skin, sheet.fixed, sheet.tables, settings};
  AlignedBox3d region{Vector3d(-0.03, -0.03, -0.02), Vector3d(0.03, 0.03, 0.02)};
  ObjectSurface seen;
  TouchState state;
  std::vector<Touch> touches;

  TouchReport see(const std::vector<ObjectBall>& balls) {
    seen.build(balls, region, kCamera);
    return contact.advance(state, seen, touches);
  }
  // m: how deep the deepest vertex is in the balls.
  [[nodiscard]] double penetration() const {
    float deepest = 0;
    for (int v = 0; v < sheet.skin.vertex_count(); ++v) {
      const auto found = seen.nearest(sheet.skin.vertices.col(v).cast<float>() + state.u.col(v));
      if (found) deepest = std::max(deepest, -found->distance);
    }
    return static_cast<double>(deepest);
  }
};

TEST_CASE("a nearly flat obstacle is one touch, though few contact points take part",
          "[contact][skin contact]") {
  constexpr float kRadius = 0.5f;
  Loop loop;
  const Vector3f centre(0, 0, kRadius - 0.0005f);
  loop.see({{centre + Vector3f(0, 0, kRadius), Vector3f::UnitZ(), centre, kRadius}});
  REQUIRE(loop.state.forces.size() > 6);
  CHECK(loop.touches.size() == 1);
  // A ball of radius R that is d deep meets the plane on a disc of 2 pi R d; the sheet has 60 mm.
  const double disc = 2 * 3.1416 * 0.5 * 0.0005;
  CHECK(loop.touches.front().area > 0.3 * disc);
  CHECK(loop.touches.front().area < 1.5 * disc);
}

TEST_CASE("a seen finger presses the skin out of its way, and lets go when it leaves",
          "[contact][skin contact]") {
  Loop loop;
  std::vector<ObjectBall> balls;
  add_finger(balls, 0.001f, -0.002f, 0.004f);
  loop.see(balls);
  REQUIRE(loop.touches.size() == 1);
  const Touch& touch = loop.touches.front();
  CHECK(touch.site == -1);
  CHECK(touch.press_depth == Approx(0.004).margin(tolerance(3e-4, "m: vertices 4 mm apart")));
  CHECK(touch.force > 0);
  CHECK(touch.direction.z() < -1 + tolerance(0.02, "the sheet leans towards the tip"));
  CHECK((touch.point_in_body - Vector3d(0.001, -0.002, -0.004)).head<2>().norm() <
        tolerance(1e-3, "m: a quarter of the vertices' distance"));
  CHECK(touch.area > 0);
  CHECK(touch.area < 0.02 * 0.02);
  CHECK(loop.penetration() < tolerance(1e-4, "m: softness, and the balls' bumps"));
  const std::vector<ObjectBall> nothing;
  loop.see(nothing);
  CHECK(loop.touches.empty());
  CHECK(loop.state.forces.empty());
  CHECK(loop.state.u.isZero(0));
  CHECK(loop.see(nothing).steps == 0);  // nothing is solved for a body at rest without obstacles
}

TEST_CASE("an unseen side that jumps moves the skin over some frames, a fast finger at once",
          "[contact][skin contact]") {
  const auto jump_of = [](Loop& loop, const std::vector<ObjectBall>& balls) {
    const Eigen::Matrix3Xf before = loop.state.u;
    loop.see(balls);
    return static_cast<double>((loop.state.u - before).colwise().norm().maxCoeff());
  };
  Loop guessed;
  std::vector<ObjectBall> balls;
  add_finger(balls, 0, 0, 0.001f);
  guessed.see(balls);
  for (ObjectBall& ball : balls) ball.centre.z() -= 0.005f;  // its seen front stays
  CHECK(jump_of(guessed, balls) < 0.00375 + tolerance(1e-6, "m: rounding"));
  CHECK(guessed.penetration() > 0.001);
  guessed.see(balls);
  CHECK(guessed.penetration() < tolerance(2e-4, "m: softness, and the balls' bumps"));

  Loop seen;
  for (const float depth : {-0.012f, -0.003f}) {
    balls.clear();
    add_finger(balls, 0, 0, depth);
    seen.see(balls);
  }
  balls.clear();
  add_finger(balls, 0, 0, 0.006f);
  CHECK(jump_of(seen, balls) > 0.005);
}

TEST_CASE("two fingers are two touches, the stronger one first", "[contact][skin contact]") {
  Loop loop;
  std::vector<ObjectBall> balls;
  add_finger(balls, -0.014f, 0, 0.002f);
  add_finger(balls, 0.014f, 0, 0.004f);
  loop.see(balls);
  REQUIRE(loop.touches.size() == 2);
  CHECK(loop.touches[0].force > loop.touches[1].force);
  CHECK(loop.touches[0].point_in_body.x() > 0.01);
  CHECK(loop.touches[1].point_in_body.x() < -0.01);
  CHECK(loop.penetration() < tolerance(1e-4, "m, as of one"));
}

TEST_CASE("a touch reports an assumed far side, and how long the obstacle has not been seen",
          "[contact][skin contact]") {
  Loop loop;
  std::vector<ObjectBall> balls;
  add_finger(balls, 0, 0, 0.003f);
  loop.see(balls);
  REQUIRE(loop.touches.size() == 1);
  // The tip points down and is seen from above, so its pressing side is assumed.
  CHECK(loop.touches[0].assumed == Approx(1.0));
  CHECK(loop.touches[0].unseen_for == 0);
  balls.clear();
  add_finger(balls, 0, 0, 0.003f, 0, 0.2f);
  loop.see(balls);
  REQUIRE(loop.touches.size() == 1);
  CHECK(loop.touches[0].unseen_for == Approx(0.2));
}

TEST_CASE("an obstacle that is known with more uncertainty presses more softly",
          "[contact][skin contact]") {
  double before = std::numeric_limits<double>::infinity();
  for (const float sigma : {0.0f, 0.001f, 0.003f}) {
    Loop loop;
    std::vector<ObjectBall> balls;
    add_finger(balls, 0, 0, 0.004f, sigma);
    loop.see(balls);
    REQUIRE(loop.touches.size() == 1);
    CHECK(loop.touches[0].force < before);
    before = loop.touches[0].force;
    CHECK(loop.penetration() < tolerance(1e-3, "m: a third of 3 mm even then"));
  }
}

TEST_CASE("the same frames give the same touches, whatever was solved before them",
          "[contact][skin contact]") {
  Loop one, other;
  std::vector<ObjectBall> elsewhere;
  add_finger(elsewhere, -0.01f, 0.01f, 0.005f);
  other.see(elsewhere);
  other.state = {};  // the state is all that is carried over
  for (const float depth : {0.001f, 0.003f, 0.002f}) {
    std::vector<ObjectBall> balls;
    add_finger(balls, 0.005f, 0, depth);
    one.see(balls);
    other.see(balls);
    CHECK(one.state.u == other.state.u);
    REQUIRE(one.touches.size() == other.touches.size());
    CHECK(one.touches[0].force == other.touches[0].force);
  }
}

TEST_CASE("a frame of touch allocates nothing", "[contact][skin contact]") {
  Loop loop;
  std::vector<std::vector<ObjectBall>> frames(3);
  add_finger(frames[0], 0, 0, 0.002f);
  add_finger(frames[1], 0.002f, 0, 0.004f);
  add_finger(frames[2], -0.014f, 0, 0.003f);
  add_finger(frames[2], 0.014f, 0, 0.004f);
  for (const auto& frame : frames) loop.see(frame);
  for (const auto& frame : frames) {
    loop.seen.build(frame, loop.region, kCamera);
    CHECK(test::allocations_during(
              [&] { loop.contact.advance(loop.state, loop.seen, loop.touches); }) == 0);
  }
}

TEST_CASE("coincident obstacles press as one", "[contact][skin contact]") {
  Loop twice, once;
  std::vector<ObjectBall> balls;
  add_finger(balls, 0, 0, 0.003f);
  once.see(balls);
  add_finger(balls, 0, 0, 0.003f);
  twice.see(balls);
  CHECK(twice.state.u == once.state.u);
}

}  // namespace
}  // namespace palpable
