#include "palpable/common/contact/contact_solver.h"

#include "palpable/common/contact/capsule_obstacles.h"
#include "tests/support/allocations.h"
#include "tests/support/ball_gap.h"
#include "tests/support/cushion_stack.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <thread>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

using test::finger;
using test::kApart;
using test::Kind;
using test::Layer;
using test::Stack;

constexpr Kind T = Kind::kTables, M = Kind::kModes, F = Kind::kFixed;
constexpr int kLeading = 12;

double apart(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

TEST_CASE("a pressed cushion presses the one below, which presses back as hard",
          "[contact][bodies]") {
  // Two bodies with tables have the whole compliance; others the leading modes, which both kinds
  // hold.
  for (const std::vector<Kind>& kinds :
       {std::vector{T, T}, std::vector{M, M}, std::vector{T, M}, std::vector{M, T}}) {
    const bool is_whole = kinds == std::vector{T, T};
    const int leading = is_whole ? 0 : kLeading;
    Stack stack(kinds, kApart, leading);
    for (const double depth : {0.0015, 0.003, 0.0045, 0.006}) {
      stack.press(depth);
      INFO(depth << " m, kinds " << static_cast<int>(kinds[0]) << static_cast<int>(kinds[1]));
      CHECK(stack.report.imbalance < tolerance(1e-6, "N: rounding"));
      CHECK(stack.report.mutual_penetration <
            tolerance(5e-5, "m: softness, a hundredth of the compliance"));
      CHECK(stack.entry(0) < tolerance(1.5e-4, "m: points 3 mm apart on a dent of this size"));
    }
    const Vector3d down = stack.force(1, true), up = stack.force(0, true);
    CHECK(down.z() < (is_whole ? -0.5 : -0.4));
    CHECK((down + up).norm() < tolerance(1e-6, "N: rounding"));
    CHECK(stack.layers[1]->largest_move() > (is_whole ? 0.0015 : 0.001));
    // Alone, the upper one deforms more easily.
    Stack alone(kinds, 0.02, leading);
    alone.press(0.006);
    CHECK(alone.report.rounds == 1);
    CHECK(alone.force(1, true).isZero(0));
    CHECK(-stack.force(0, false).z() > -1.1 * alone.force(0, false).z());
  }
}

TEST_CASE("a body by its tables and the same one in modes have the same contact",
          "[contact][bodies]") {
  Stack tables({T}, kApart, kLeading), modes({M}, kApart, kLeading);
  for (const double depth : {0.001, 0.003, 0.006, 0.002}) {
    tables.press(depth);
    modes.press(depth);
    INFO(depth);
    const double f = tables.force(0, false).norm(), g = modes.force(0, false).norm();
    CHECK(std::abs(f / g - 1) < tolerance(0.03, "points 6 and 1.5 mm apart, and their softness"));
    CHECK(apart(tables.layers[0]->skin(), modes.layers[0]->skin()) <
          tolerance(0.03, "likewise") * modes.layers[0]->largest_move());
  }
}

TEST_CASE("the displacement of a body by another one is its whole response to the forces",
          "[contact][bodies]") {
  Stack stack({T, T});
  for (int frame = 0; frame < 4; ++frame) stack.press(0.005);
  // The lower one's linear response to the upper one's forces, from the closed form.
  const Layer &upper = *stack.layers[0], &lower = *stack.layers[1];
  const Eigen::Isometry3f to_lower = stack.from_to(0, 1);
  Eigen::Matrix3Xd f = Eigen::Matrix3Xd::Zero(3, lower.cushion.skin.vertex_count());
  MovingSurface skin(lower.cushion.skin);
  skin.move(lower.skin());
  for (const PointForce& at : upper.state.forces) {
    if (at.by != 1) continue;
    const SkinPoint& point = upper.tables->points()[static_cast<std::size_t>(at.point)];
    const auto found = skin.nearest(to_lower * point.at(upper.skin()), 0.01f);
    REQUIRE(found);
    for (int k = 0; k < 3; ++k) {
      f.col(skin.corners(found->triangle)[k]) -=
          (found->weights[k] * (to_lower.linear() * at.force)).cast<double>();
    }
  }
  double off = 0;
  for (int v = 0; v < lower.cushion.skin.vertex_count(); v += 7) {
    Vector3d u = Vector3d::Zero();
    for (int w = 0; w < lower.cushion.skin.vertex_count(); ++w) {
      u += lower.cushion.compliance(v, w) * f.col(w);
    }
    off = std::max(off, (lower.state.u.col(v).cast<double>() - u).norm());
  }
  CHECK(lower.largest_move() > 0.001);
  CHECK(off < tolerance(1e-5, "m: feet are those of a round ago"));
}

TEST_CASE("under an obstacle that stands still no body oscillates", "[contact][bodies]") {
  for (const std::size_t count : {2, 3}) {
    Stack stack(std::vector<Kind>(count, T));
    stack.press(0.006);
    stack.press(0.006);
    std::vector<Matrix3Xf> before;
    for (const auto& layer : stack.layers) before.push_back(layer->state.u);
    for (int frame = 0; frame < 30; ++frame) {
      stack.press(0.006);
      for (std::size_t k = 0; k < stack.layers.size(); ++k) {
        INFO("frame " << frame << ", body " << k << " of " << count);
        CHECK(apart(stack.layers[k]->state.u, before[k]) <
              tolerance(2e-5, "m: of the solver's iterations"));
      }
    }
    CHECK(stack.report.rounds == 1);
  }
}

TEST_CASE("contact that does not converge in one frame converges in the next ones",
          "[contact][bodies]") {
  Stack slow({T, T}), fast({T, T});
  for (int frame = 1; frame <= 20; ++frame) slow.press(0.0003 * frame);
  for (int frame = 0; frame < 3; ++frame) fast.press(0.006);
  for (const std::size_t k : {0, 1}) {
    CHECK(apart(slow.layers[k]->state.u, fast.layers[k]->state.u) <
          tolerance(1e-4, "m: of 4 mm; points that press are not quite the same"));
  }
}

TEST_CASE("bodies that are released return to rest", "[contact][bodies]") {
  for (const std::vector<Kind>& kinds : {std::vector{T, T, T}, std::vector{M, T, M}}) {
    Stack stack(kinds, kApart, kLeading);
    stack.press(0.006);
    stack.press(0.006);
    CHECK_FALSE(stack.force(2, true).isZero(0));
    CHECK_FALSE(stack.solver->is_at_rest(2));
    for (int frame = 0; frame < 4; ++frame) stack.let_go();
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(stack.layers[k]->largest_move() == 0);
      CHECK(stack.force(k, true).isZero(0));
      CHECK(stack.solver->is_at_rest(static_cast<int>(k)));
    }
    stack.let_go();
    CHECK(stack.report.iterations == 0);  // nothing is solved
  }
}

TEST_CASE("a prescribed skin is an obstacle, and moves as prescribed", "[contact][bodies]") {
  Stack stack({T, F});
  for (int frame = 0; frame < 3; ++frame) stack.press(0.006);
  const double on_hard = stack.force(0, true).z();
  CHECK(stack.entry(0) < tolerance(1.5e-4, "m, as of two"));
  Stack both({T, T});
  for (int frame = 0; frame < 3; ++frame) both.press(0.006);
  CHECK(on_hard > 1.2 * both.force(0, true).z());
  // The lower skin moves away.
  Matrix3Xf lower = stack.layers[1]->skin();
  lower.row(2).array() += 0.01f;  // its frame is upside down
  stack.layers[1]->fixed->move(lower);
  for (int frame = 0; frame < 3; ++frame) stack.press(0.006);
  CHECK(stack.force(0, true).isZero(0));
}

TEST_CASE("a frame reports how it ended", "[contact][bodies]") {
  Stack converged({T});
  converged.press(0.001);
  CHECK(converged.report.left_to_move == 0);
  CHECK(converged.report.dropped == 0);
  CHECK(converged.report.last_change < 2e-5);

  TouchSettings one_iteration;
  one_iteration.last_iterations = 1;
  Stack unsettled({T}, kApart, 0, one_iteration);
  unsettled.press(0.0012);
  CHECK(unsettled.report.left_to_move > 0);  // its first iteration moved points by millimetres
  CHECK(unsettled.report.left_to_move == unsettled.report.last_change);

  // Two steps, and the rest in later frames.
  TouchSettings few_steps;
  few_steps.most_steps = 2;
  Stack stopped({T}, kApart, 0, few_steps);
  stopped.press(0.006);
  CHECK(stopped.report.steps == 2);

  // No vertex moves farther than the step limit.
  Stack slow({T});
  const CapsuleObstacles deep = finger(0.006);
  const std::array near{ContactSolver::Near{&deep, 0.001}};
  slow.report = slow.solver->advance(near);
  CHECK(slow.layers[0]->largest_move() == Approx(0.001).margin(1e-7));
  CHECK(slow.report.left_to_move > 0);

  // A plate over the whole cushion has more points than there is room for.
  const test::GapFunction plate([](const Vector3f& x, SurfaceGap& gap) {
    gap.distance = 0.002f - x.z();  // from above, 6 mm below the top
    gap.normal = -Vector3f::UnitZ();
    gap.curvature.diagonal().setConstant(300);  // 1/m: as sharp as a pencil everywhere
    return true;
  });
  Stack crowded({T});
  crowded.advance(plate);
  CHECK(crowded.report.dropped > 0);
}

TEST_CASE("gaps that are NaN press nothing", "[contact][bodies]") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const test::GapFunction bad([nan](const Vector3f&, SurfaceGap& gap) {
    gap.distance = nan;
    gap.normal.setConstant(nan);
    return true;
  });
  for (const Kind kind : {T, M}) {
    Stack stack({kind, kind}, kApart, kLeading);
    stack.advance(bad);
    CHECK(stack.force(0, false).isZero(0));
    CHECK(stack.layers[0]->skin().allFinite());
  }
}

TEST_CASE("the same frames give the same bytes, and allocate nothing", "[contact][bodies]") {
  for (const std::vector<Kind>& kinds : {std::vector{T, T, T}, std::vector{M, T, F}}) {
    Stack one(kinds, kApart, kLeading), other(kinds, kApart, kLeading);
    for (const double depth : {0.001, 0.006, 0.004, 0.002}) {
      one.press(depth);
      other.press(depth);
      for (std::size_t k = 0; k < 3; ++k) {
        CHECK(one.layers[k]->skin() == other.layers[k]->skin());
      }
    }
    for (const double depth : {0.001, 0.006}) {
      const CapsuleObstacles here = finger(depth);
      CHECK(test::allocations_during([&] { one.advance(here); }) == 0);
    }
  }
}

TEST_CASE("a stack has the same bytes when others are solved at the same time",
          "[contact][bodies]") {
  // A stack is solved by one thread. Data shared between stacks would show with several threads.
  const auto played = [] {
    Stack stack({T, M}, kApart, kLeading);
    for (const double depth : {0.002, 0.006, 0.003}) stack.press(depth);
    return std::array<Matrix3Xf, 2>{stack.layers[0]->skin(), stack.layers[1]->skin()};
  };
  const std::array<Matrix3Xf, 2> alone = played();
  for (const std::size_t count : {2, 8}) {
    INFO(count << " threads");
    std::vector<std::array<Matrix3Xf, 2>> found(count);
    std::vector<std::thread> threads;
    for (std::array<Matrix3Xf, 2>& result : found) {
      threads.emplace_back([&result, &played] { result = played(); });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::array<Matrix3Xf, 2>& result : found) {
      CHECK(result[0] == alone[0]);
      CHECK(result[1] == alone[1]);
    }
  }
}

}  // namespace
}  // namespace palpable
