// Coulomb's law at one contact point: the cone, the potential, its derivatives, dissipation.
#include "palpable/bake/solid/point_friction.h"

#include "tests/support/test.h"

#include <Eigen/Eigenvalues>

#include <random>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::tolerance;

constexpr Friction kLaw{.coefficient = 0.4, .stiffness = 0.5};
constexpr double kPenalty = 2000;  // N/m
constexpr double kPressing = 0.3;  // N

Vector3d random_vector(std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  Vector3d v;
  for (double& x : v) x = number(random);
  return v;
}

// An anchored point in a plane of some direction.
PointFriction some_point(std::mt19937_64& random) {
  PointFriction point;
  point.anchored = true;
  point.normal = random_vector(random).normalized();
  return point;
}

TEST_CASE("friction stays in Coulomb's cone and in the plane, and resists the slide",
          "[solid][friction]") {
  auto random = test::random_case(1);
  int slipping = 0;
  for (int i = 0; i < 200; ++i) {
    PointFriction point = some_point(random);
    const Vector3d apart = 1.5e-4 * random_vector(random);
    evaluate_friction(kLaw, kPenalty, kPressing, apart, false, point);
    CHECK(point.limit == Approx(0.12));
    CHECK(point.force.norm() <= point.limit * (1.0 + 1e-12));
    CHECK(std::abs(point.force.dot(point.normal)) <= tolerance(1e-15, "rounding, N"));
    if (point.slips) {
      ++slipping;
      CHECK(point.force.norm() == Approx(point.limit));
      CHECK(dissipated(point) >= 0.0);
    } else {
      CHECK(dissipated(point) == 0.0);
    }
  }
  CHECK(slipping > 20);
  CHECK(slipping < 180);
}

TEST_CASE("friction is the slope of its potential, and the stiffness its derivative",
          "[solid][friction]") {
  auto random = test::random_case(2);
  for (int i = 0; i < 50; ++i) {
    PointFriction point = some_point(random);
    const Vector3d apart = 1.5e-4 * random_vector(random), way = random_vector(random);
    const double h = 1e-9;
    const auto at = [&](double step, Vector3d& force) {
      PointFriction moved = point;
      const double energy =
          evaluate_friction(kLaw, kPenalty, kPressing, apart + step * way, false, moved);
      force = moved.force;
      return energy;
    };
    Vector3d low, high;
    const double slope = (at(h, high) - at(-h, low)) / (2 * h);
    evaluate_friction(kLaw, kPenalty, kPressing, apart, false, point);
    CHECK(slope == Approx(-point.force.dot(way)).margin(tolerance(1e-6, "differences, N")));
    const Matrix3d K = friction_stiffness(point);
    CHECK((K - K.transpose()).norm() <= tolerance(1e-12, "rounding") * kPenalty);
    CHECK(Eigen::SelfAdjointEigenSolver<Matrix3d>(K).eigenvalues()[0] >= -1e-9 * kPenalty);
    const Vector3d change = (low - high) / (2 * h);
    CHECK((K * way - change).norm() <=
          tolerance(1e-3, "differences; N/m, of 1000") * kLaw.stiffness * kPenalty);
  }
}

TEST_CASE("a point without an anchor, and one that is not pressed, have no friction",
          "[solid][friction]") {
  auto random = test::random_case(3);
  PointFriction loose = some_point(random), light = loose;
  loose.anchored = false;
  for (PointFriction* point : {&loose, &light}) {
    const double pressing = point == &loose ? kPressing : 0.0;
    CHECK(evaluate_friction(kLaw, kPenalty, pressing, Vector3d(1e-3, 0, 0), false, *point) == 0.0);
    CHECK(point->force == Vector3d::Zero());
    CHECK(friction_stiffness(*point) == Matrix3d::Zero());
    CHECK(dissipated(*point) == 0.0);
  }
}

TEST_CASE("a point that is pulled slips once, and is then held with the same force for ever",
          "[solid][friction]") {
  // A spring of 500 N/m pulls the point by more than its limit of 0.12 N.
  PointFriction point;
  point.anchored = true;
  const double spring = 500, limit = kLaw.coefficient * kPressing, k = kLaw.stiffness * kPenalty;
  double anchor = 0, x = 0, lost = 0;
  const auto step = [&](double end_of_spring) {
    // Equilibrium: spring (end - x) = k (x - anchor), or the limit.
    x = (spring * end_of_spring + k * anchor) / (spring + k);
    if (k * (x - anchor) > limit) x = end_of_spring - limit / spring;
    evaluate_friction(kLaw, kPenalty, kPressing, Vector3d(x - anchor, 0, 0), false, point);
    lost += dissipated(point);
    if (point.slips) anchor = x - elastic_slip(point).x();
  };
  step(1e-3);
  REQUIRE(point.slips);
  CHECK(point.force.x() == Approx(-limit));
  // The spring's work on the point is what is lost and what the elastic slip stores.
  CHECK(lost == Approx(limit * (x - limit / k)));
  const double after = x, after_lost = lost;
  for (int i = 0; i < 100; ++i) step(1e-3);
  CHECK(x == Approx(after).epsilon(tolerance(1e-12, "rounding")));
  CHECK(point.force.x() == Approx(-limit));
  CHECK(lost == Approx(after_lost));
  // A third less pull: it sticks, and gives way as the two springs together.
  step(0.8e-3);
  CHECK_FALSE(point.slips);
  CHECK(after - x == Approx(0.2e-3 * spring / (spring + k)));
}

TEST_CASE("an update turns the plane, and tells how far the cone still changes",
          "[solid][friction]") {
  auto random = test::random_case(4);
  PointFriction point = some_point(random);
  evaluate_friction(kLaw, kPenalty, kPressing, Vector3d(1e-3, 2e-3, 0), false, point);
  const Vector3d normal = (point.normal + Vector3d(0.1, 0, 0.1)).normalized();
  CHECK(update_cone(kLaw, kPenalty, kPressing, 0.5 * kPressing, normal, point) ==
        Approx(0.4 * 0.5 * kPressing / (0.5 * kPenalty)));
  CHECK(point.normal == normal);
  // Far inside of the cone its size does not matter.
  evaluate_friction(kLaw, kPenalty, kPressing, Vector3d(1e-7, 0, 0), false, point);
  CHECK(update_cone(kLaw, kPenalty, kPressing, 0.5 * kPressing, normal, point) == 0.0);
}

TEST_CASE("a gap closes where its straight line meets zero", "[solid][friction]") {
  CHECK(time_of_contact(1e-3, -3e-3) == Approx(0.25));
  CHECK(time_of_contact(-1e-6, -3e-3) == 0.0);
  CHECK(time_of_contact(1e-3, 1e-4) == 1.0);
}

}  // namespace
}  // namespace palpable
