#include "palpable/common/contact/hold_back.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

constexpr Eigen::Index kNodes = 5, kVertices = 3;
constexpr std::size_t kMostForces = 4;

TouchState pressed(float along, std::initializer_list<int> points) {
  TouchState state;
  state.u = Matrix3Xf::Zero(3, kNodes);
  state.u.col(1) = Vector3f(0, 0, along);
  state.u.col(4) = Vector3f(0, 0, 10 * along);  // an inner node: it does not count
  state.forces.reserve(kMostForces);
  for (const int point : points)
    state.forces.push_back({point, Vector3f(0, 0, static_cast<float>(point))});
  return state;
}

}  // namespace

TEST_CASE("a state that went no farther than it may is left as it is", "[contact]") {
  HoldBack hold_back(kNodes, kVertices, kMostForces);
  hold_back.start(pressed(0.001f, {1}));
  TouchState state = pressed(0.002f, {1, 2});
  CHECK(hold_back.bound(state, 0.0011) == 0);
  CHECK(state.u == pressed(0.002f, {}).u);
  CHECK(state.forces.size() == 2);
}

TEST_CASE("a state that is held back goes a share of the way, forces and all nodes alike",
          "[contact]") {
  HoldBack hold_back(kNodes, kVertices, kMostForces);
  hold_back.start(pressed(0.001f, {1, 4}));
  TouchState state = pressed(0.005f, {2, 4});
  double left = 0;
  CHECK(test::allocations_during([&] { left = hold_back.bound(state, 0.001); }) == 0);
  CHECK(std::abs(left - 0.003) < 1e-8);
  CHECK(std::abs(state.u(2, 1) - 0.002f) < 1e-8f);
  CHECK(std::abs(state.u(2, 4) - 0.020f) < 1e-7f);
  REQUIRE(state.forces.size() == 3);
  const std::array wanted{std::pair(1, 0.75f), std::pair(2, 0.5f), std::pair(4, 4.0f)};
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    CHECK(state.forces[k].point == wanted[k].first);
    CHECK(std::abs(state.forces[k].force.z() - wanted[k].second) < 1e-6f);
  }
}

TEST_CASE("of more forces than there is room for the least go", "[contact]") {
  HoldBack hold_back(kNodes, kVertices, kMostForces);
  hold_back.start(pressed(0, {1, 3, 5}));
  TouchState state = pressed(0.002f, {2, 4, 6});
  CHECK(hold_back.bound(state, 0.001) > 0);
  REQUIRE(state.forces.size() == kMostForces);
  CHECK(state.forces.front().point == 3);
}

}  // namespace palpable
