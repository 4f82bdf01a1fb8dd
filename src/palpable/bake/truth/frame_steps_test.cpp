#include "palpable/bake/truth/frame_steps.h"

#include "palpable/bake/solid/obstacle.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// A ball of radius 10 mm.
Capsule at(double x, double z) { return ball({x, 0.05, z}, 0.01); }

TEST_CASE("only what may touch the skin divides a frame into steps", "[truth]") {
  const TetMesh block = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 10, 10, 10);
  const Matrix3Xd rest = Matrix3Xd::Zero(3, block.node_count());
  const auto steps = [&](std::vector<Capsule> before, std::vector<Capsule> now, int shorter) {
    ClipHands hands;
    hands.capsules = {std::move(before), std::move(now)};
    return FrameSteps(hands, block).count(1, rest, 1e-3, shorter);
  };
  const Capsule touching = at(0.05, 0.108), far = at(0.05, 0.3);
  // At rest: one step, whatever else moves far away.
  CHECK(steps({touching}, {touching}, 1) == 1);
  CHECK(steps({touching}, {touching}, 4) == 1);
  CHECK(steps({touching, far}, {touching, at(0.09, 0.3)}, 4) == 1);
  // 2.5 mm along the skin.
  CHECK(steps({touching}, {at(0.0525, 0.108)}, 1) == 3);
  CHECK(steps({touching}, {at(0.0525, 0.108)}, 2) == 6);
  // Less than a step.
  CHECK(steps({touching}, {at(0.0501, 0.108)}, 1) == 1);
  CHECK(steps({touching}, {at(0.0501, 0.108)}, 2) == 2);
  // What comes from afar, and what leaves.
  CHECK(steps({far}, {touching}, 1) == 192);
  CHECK(steps({touching}, {far}, 1) == 192);
  // What passes by in reach of the skin, and what does not.
  CHECK(steps({at(0.05, 0.118)}, {at(0.0525, 0.118)}, 1) == 3);
  CHECK(steps({at(0.05, 0.135)}, {at(0.0525, 0.135)}, 1) == 1);
  // Where the first capsule of the list has gone, the second has its number, but has not moved.
  CHECK(steps({far, touching}, {touching}, 2) == 1);
  CHECK(steps({far, touching}, {at(0.0525, 0.108)}, 1) == 3);
  CHECK(steps({}, {touching}, 2) == 1);
  CHECK(steps({touching}, {}, 2) == 1);
}

TEST_CASE("reach is measured to the skin where it is now", "[truth]") {
  const TetMesh block = box_tets({0, 0, 0}, {0.1, 0.1, 0.1}, 10, 10, 10);
  ClipHands hands;
  hands.capsules = {{at(0.05, 0.135)}, {at(0.0525, 0.135)}};
  const FrameSteps steps(hands, block);
  Matrix3Xd moved = Matrix3Xd::Zero(3, block.node_count());
  CHECK(steps.count(1, moved, 1e-3, 1) == 1);
  moved.row(2).setConstant(0.02);
  CHECK(steps.count(1, moved, 1e-3, 1) == 3);
  CHECK(steps.count(0, moved, 1e-3, 1) == 1);
}

}  // namespace
}  // namespace palpable
