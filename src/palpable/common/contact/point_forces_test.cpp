#include "palpable/common/contact/point_forces.h"

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

using Eigen::Vector3f;

constexpr std::size_t kMost = 4;

// At each point a force of that number of N.
std::vector<PointForce> forces_at(std::initializer_list<int> points) {
  std::vector<PointForce> forces;
  forces.reserve(kMost);
  for (const int point : points) {
    forces.push_back({point, Vector3f(0, 0, static_cast<float>(point))});
  }
  return forces;
}

}  // namespace

TEST_CASE("under the step limit forces change by a share", "[contact]") {
  ForcesAtStart begun(kMost);
  begun.start(forces_at({1, 4}));
  std::vector<PointForce> forces = forces_at({2, 4});
  forces.back().force *= 3;
  CHECK(test::allocations_during([&] { begun.limit_step(forces, 0.25f); }) == 0);
  REQUIRE(forces.size() == 3);
  const std::array wanted{std::pair(1, 0.75f), std::pair(2, 0.5f), std::pair(4, 6.0f)};
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    CHECK(forces[k].point == wanted[k].first);
    CHECK(std::abs(forces[k].force.z() - wanted[k].second) < 1e-6f);
  }
}

TEST_CASE("under the step limit friction changes by the same share", "[contact][friction]") {
  ForcesAtStart begun(kMost);
  begun.start({{1, Vector3f(0, 1, 4), -1, Vector3f(0, 1, 0)},
               {2, Vector3f(2, 0, 6), -1, Vector3f(2, 0, 0)}});
  std::vector<PointForce> forces{{2, Vector3f(0, 4, 8), -1, Vector3f(0, 4, 0)}};
  begun.limit_step(forces, 0.25f);
  REQUIRE(forces.size() == 2);
  CHECK(forces[0].friction == Vector3f(0, 0.75f, 0));  // of a point that presses no longer
  CHECK(forces[1].friction == Vector3f(1.5f, 1, 0));
}

TEST_CASE("the forces of two bodies at one point stay separate", "[contact]") {
  ForcesAtStart begun(kMost);
  begun.start({{3, Vector3f(0, 0, 1), -1}, {3, Vector3f(0, 0, 2), 1}});
  std::vector<PointForce> forces{{3, Vector3f(0, 0, 5), 1}};
  begun.limit_step(forces, 0.5f);
  REQUIRE(forces.size() == 2);
  CHECK(forces[0].by == -1);
  CHECK(forces[0].force.z() == 0.5f);
  CHECK(forces[1].by == 1);
  CHECK(forces[1].force.z() == 3.5f);
}

TEST_CASE("if there are more forces than there is room for, the smallest are dropped",
          "[contact]") {
  ForcesAtStart begun(kMost);
  begun.start(forces_at({1, 3, 5}));
  std::vector<PointForce> forces = forces_at({2, 4, 6});
  begun.limit_step(forces, 0.5f);
  REQUIRE(forces.size() == kMost);
  CHECK(forces.front().point == 3);
}

}  // namespace palpable
