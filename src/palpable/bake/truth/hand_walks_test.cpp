#include "palpable/bake/truth/hand_walks.h"

#include "palpable/bake/solid/selection.h"
#include "palpable/bake/truth/frame_steps.h"
#include "tests/support/test.h"

#include <algorithm>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;

// A cube of 0.1 m and 20 kPa, held at its base.
SolidModel block() {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 5, 5, 5);
  model.material = material_from_young("neo-hookean", 20e3, 0.3);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
  return model;
}

// A fingertip that comes down by 2 mm a frame, and then goes aside by as much.
ClipHands pressing_hand(int down, int aside) {
  ClipHands hands;
  for (int frame = 0; frame <= down + aside; ++frame) {
    const double depth = 2e-3 * std::min(frame, down), along = 2e-3 * std::max(0, frame - down);
    hands.capsules.push_back({ball({0.03 + along, 0.048, 0.1081 - depth}, 0.008)});
  }
  hands.contacts.resize(hands.capsules.size());
  return hands;
}

// The displacement at the last frame, followed in `shorter` times as many steps as the first walk.
Matrix3Xd followed(const EquilibriumSolver& solver, const ClipHands& hands, int shorter,
                   const ContactSettings& settings) {
  const auto way = [&](double t) { return Obstacle{.capsules = capsules_at(hands, t)}; };
  const FrameSteps steps(hands, solver.model().mesh);
  ContactWalk walk(solver, way, 0.0, settings);
  const int last = static_cast<int>(hands.capsules.size()) - 1;
  for (int frame = 1; frame <= last; ++frame) {
    const int count = steps.count(frame, walk.now().displacement, kFrictionStep, shorter);
    for (int k = 1; k <= count; ++k) {
      const double t = frame - 1 + static_cast<double>(k) / count;
      REQUIRE((frame == last && k == count ? walk.advance(t) : walk.pass(t)));
    }
  }
  return walk.now().displacement;
}

// What follow_hand() finds at the last frame, by shorter steps and by longer ones.
std::pair<Matrix3Xd, Matrix3Xd> found_by_hand(const EquilibriumSolver& solver,
                                              const ClipHands& hands,
                                              const ContactSettings& settings) {
  const int last = static_cast<int>(hands.capsules.size()) - 1;
  std::pair<Matrix3Xd, Matrix3Xd> found;
  follow_hand(solver, hands, {{.first = 1, .wanted = {last}}}, {.contact = settings, .threads = 1},
              {}, [&](const Episode&, const Walked& fine, const Walked& coarse) {
                found = {fine.frames.at(last).displacement, coarse.frames.at(last).displacement};
              });
  return found;
}

TEST_CASE("frames that say nothing about a response are not scored", "[truth]") {
  CHECK(why_not_scored(0.5 * kPathMatters, false, 0.0).empty());
  CHECK(why_not_scored(0.02, false, 0.0) ==
        "depends on the way: half the step changes it by 2.0 %");
  CHECK_FALSE(why_not_scored(0.0, true, 0.0).empty());
  CHECK(why_not_scored(0.0, false, 1e-4) == "presses skin that the support holds");

  // A ball against the lower edge of the block, which is held.
  const EquilibriumSolver solver(block());
  ClipHands hands;
  for (const double deep : {-1e-3, 1e-3}) {
    hands.capsules.push_back({ball({-0.02 + deep, 0.05, 0.0}, 0.02)});
  }
  hands.contacts.resize(2);
  double entry = 0;
  follow_hand(solver, hands, {{.first = 1, .wanted = {1}}}, {.threads = 1}, {},
              [&](const Episode&, const Walked& fine, const Walked&) {
                entry = fine.frames.at(1).held_entry;
              });
  CHECK(entry > 0.5e-3);
  CHECK(entry <= 1e-3);
}

TEST_CASE("where steps and half steps differ, quarter steps take the place of steps",
          "[truth][friction]") {
  const EquilibriumSolver solver(block());
  const ContactSettings settings{.friction = 0.3};
  const auto follow = [&](const ClipHands& hands, int shorter) {
    return followed(solver, hands, shorter, settings);
  };
  // Pressed straight: the two agree.
  const ClipHands straight = pressing_hand(3, 0);
  REQUIRE(relative_change(follow(straight, 1), follow(straight, 2), {}) < 0.5 * kPathMatters);
  const auto [half, whole] = found_by_hand(solver, straight, settings);
  CHECK(half == follow(straight, 2));
  CHECK(whole == follow(straight, 1));
  // Dragged over coarse elements.
  const ClipHands dragged = pressing_hand(3, 6);
  REQUIRE(relative_change(follow(dragged, 1), follow(dragged, 2), {}) > 0.5 * kPathMatters);
  const auto [quarter, half_again] = found_by_hand(solver, dragged, settings);
  CHECK(quarter == follow(dragged, 4));
  CHECK(half_again == follow(dragged, 2));
}

}  // namespace
}  // namespace palpable
