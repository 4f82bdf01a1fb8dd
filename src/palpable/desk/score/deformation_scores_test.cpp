#include "palpable/desk/score/deformation_scores.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Forces = std::vector<Eigen::Vector3d>;
using test::tolerance;

// Two vertices; the area of the second is three times that of the first.
const Eigen::Vector2d kAreas(1e-4, 3e-4);

Eigen::Matrix3Xd two(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix3Xd u(3, 2);
  u.col(0) = first;
  u.col(1) = second;
  return u;
}

TEST_CASE("the error of a displacement is the one computed by hand", "[score]") {
  // True displacements of 4 mm and 1 mm: weighted squares 1 x 16 + 3 x 1 = 19. Errors of 0 and 2
  // mm: 3 x 4 = 12.
  const Eigen::Matrix3Xd truth = two({0.004, 0, 0}, {0, 0.001, 0});
  const Eigen::Matrix3Xd found = two({0.004, 0, 0}, {0, 0.001, 0.002});
  const DisplacementError error = displacement_error(truth, found, kAreas);
  CHECK(error.relative == Approx(std::sqrt(12.0 / 19.0)));
  CHECK(error.worst == Approx(0.002));
}

TEST_CASE("the truth has no error; a body at rest and twice the truth have a relative error of 1",
          "[score]") {
  const Eigen::Matrix3Xd truth = two({0.004, 0, 0}, {0, 0.001, 0.002});
  CHECK(displacement_error(truth, truth, kAreas).relative == 0);
  CHECK(displacement_error(truth, truth, kAreas).worst == 0);
  for (const double times : {0.0, 2.0}) {
    INFO(times << " times the truth");
    const DisplacementError error = displacement_error(truth, times * truth, kAreas);
    CHECK(error.relative == Approx(1));
    CHECK(error.worst == Approx(0.004));
  }
}

TEST_CASE("where the truth is at rest, only rest is right", "[score]") {
  const Eigen::Matrix3Xd rest = two({0, 0, 0}, {0, 0, 0});
  CHECK(displacement_error(rest, rest, kAreas).relative == 0);
  const DisplacementError error = displacement_error(rest, two({0.001, 0, 0}, {0, 0, 0}), kAreas);
  CHECK(std::isinf(error.relative));
  CHECK(error.worst == 0.001);
}

TEST_CASE("displacements of two skins are refused", "[score][errors]") {
  const Eigen::Matrix3Xd u = two({0, 0, 0}, {0, 0, 0});
  CHECK_THROWS_AS(displacement_error(u, u.leftCols(1), kAreas), ContractViolation);
  CHECK_THROWS_AS(displacement_error(u, u, Eigen::Vector3d::Ones()), ContractViolation);
}

TEST_CASE("the error of a stress is that of the worst vertex against the true maximum", "[score]") {
  const Eigen::Vector4d truth(1000, 4000, 0, 500);
  CHECK(von_mises_error(truth, truth) == 0);
  CHECK(von_mises_error(truth, Eigen::Vector4d(1000, 3600, 0, 500)) == Approx(0.1));
  CHECK(von_mises_error(truth, Eigen::Vector4d(1000, 3600, 1000, 500)) == Approx(0.25));
  CHECK(von_mises_error(truth, Eigen::Vector4d::Zero()) == Approx(1));  // a body at rest
  CHECK(von_mises_error(truth, 3 * truth) == Approx(2));
}

TEST_CASE("where the truth has no stress, only none is right", "[score]") {
  const Eigen::Vector2d none(0, 0);
  CHECK(von_mises_error(none, none) == 0);
  CHECK(std::isinf(von_mises_error(none, Eigen::Vector2d(0, 1))));
}

TEST_CASE("stresses of two skins are refused", "[score][errors]") {
  CHECK_THROWS_AS(von_mises_error(Eigen::Vector2d(0, 1), Eigen::Vector3d(0, 1, 2)),
                  ContractViolation);
  CHECK_THROWS_AS(von_mises_error({}, {}), ContractViolation);
}

TEST_CASE("the error of a force is that of the resultants", "[score]") {
  const Eigen::Vector3d truth(0, 3, -4);
  CHECK(force_error(truth, Forces{truth}) == 0);
  CHECK(force_error(truth, Forces{{0, 3, -3}}) == Approx(0.2));
  CHECK(force_error(truth, Forces{2 * truth}) == Approx(1));
  CHECK(force_error(truth, Forces{-truth}) == Approx(2));  // the opposite force
  // The forces of the two fingers of a squeeze add up.
  CHECK(force_error(truth, Forces{{5, 3, 0}, {-5, 0, -4}}) == 0);
  CHECK(force_error(truth, Forces{{3, 3, -4}, {0, 0, 0}}) == Approx(0.6));
}

TEST_CASE("a touch that was not felt counts as rest", "[score]") {
  CHECK(force_error({0, 3, -4}, {}) == Approx(1));
}

TEST_CASE("where nothing presses, only no force is right", "[score]") {
  CHECK(force_error(Eigen::Vector3d::Zero(), {}) == 0);
  CHECK(std::isinf(force_error(Eigen::Vector3d::Zero(), Forces{{1, 0, 0}})));
}

Capsule ball(const Vector3d& middle, double radius) { return {middle, middle, radius, radius}; }

// A block of 60 x 60 x 60 mm with 12 triangles: touches lie far from its vertices.
const SurfaceMesh kBlock = box_surface({-0.03, -0.03, 0}, {0.03, 0.03, 0.06});

TEST_CASE("finger and thumb touch two places, a hand in the air none", "[score]") {
  // One ball on the top, one on the right side, and one 1 mm away from the left side.
  const std::vector<Capsule> hand{ball({0.01, 0.01, 0.07}, 0.01), ball({0.04, -0.01, 0.03}, 0.01),
                                  ball({-0.041, 0, 0.03}, 0.01)};
  const std::vector<Vector3d> places = touched_places(kBlock, kBlock, hand);
  REQUIRE(places.size() == 2);
  // With samples 2 mm apart, one is this near to the touching point of the ball.
  const double near = tolerance(0.0015, "m; samples 2 mm apart in a triangle");
  for (const Vector3d& truth : {Vector3d(0.01, 0.01, 0.06), Vector3d(0.03, -0.01, 0.03)}) {
    CHECK(std::any_of(places.begin(), places.end(),
                      [&](const Vector3d& place) { return (place - truth).norm() <= near; }));
  }
  CHECK(touched_places(kBlock, kBlock, {}).empty());
  CHECK(touched_places(kBlock, kBlock, std::vector{ball({0, 0, 0.0706}, 0.01)}).empty());
  CHECK(touched_places(kBlock, kBlock, std::vector{ball({0, 0, 0.0704}, 0.01)}).size() == 1);
}

TEST_CASE("places are those of the skin at rest, and the one that moves farthest comes first",
          "[score]") {
  SurfaceMesh pressed = kBlock;
  for (int v = 0; v < pressed.vertex_count(); ++v) {
    if (pressed.vertices(2, v) > 0.05)
      pressed.vertices(2, v) -= 0.01 + 0.1 * pressed.vertices(0, v);
  }
  // The top sinks by 10 mm in the middle and is inclined by 1 : 10.
  const auto lies_on = [](double x) {
    const Vector3d on(x, 0, 0.05 - 0.1 * x), normal = Vector3d(0.1, 0, 1).normalized();
    return ball(on + 0.008 * normal, 0.008);
  };
  const std::vector<Vector3d> places =
      touched_places(kBlock, pressed, std::vector{lies_on(-0.02), lies_on(0.02)});
  REQUIRE(places.size() == 2);
  const double near = tolerance(0.0015, "m; samples 2 mm apart in a triangle");
  CHECK((places[0] - Vector3d(0.02, 0, 0.06)).norm() <= near);   // 12 mm
  CHECK((places[1] - Vector3d(-0.02, 0, 0.06)).norm() <= near);  // 8 mm
}

TEST_CASE("one long touch is covered by places of 10 mm radius", "[score]") {
  // A stick that lies along the top of a bar with vertices 2 mm apart.
  constexpr int kParts = 40;
  SurfaceMesh bar;
  bar.vertices.resize(3, 2 * (kParts + 1));
  bar.triangles.resize(3, 2 * kParts);
  for (int i = 0; i <= kParts; ++i) {
    bar.vertices.col(2 * i) << 0.002 * i, -0.003, 0;
    bar.vertices.col(2 * i + 1) << 0.002 * i, 0.003, 0;
    if (i == kParts) break;
    bar.triangles.col(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    bar.triangles.col(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  const std::vector<Capsule> stick{{{-0.01, 0, 0.005}, {0.09, 0, 0.005}, 0.005, 0.005}};
  const std::vector<Vector3d> places = touched_places(bar, bar, stick);
  CHECK(places.size() >= 4);  // 80 mm in parts of 20
  CHECK(places.size() <= 8);  // no two of them nearer than 10 mm
  for (double x = 0; x <= 0.08; x += 0.002) {
    INFO("x " << x);
    CHECK(std::any_of(places.begin(), places.end(), [&](const Vector3d& place) {
      return (place - Vector3d(x, 0, 0)).norm() <= kTouchedPlace + 0.002;
    }));
  }
}

TEST_CASE("a skin of other triangles is refused", "[score][errors]") {
  SurfaceMesh other = kBlock;
  other.triangles.conservativeResize(3, 11);
  CHECK_THROWS_AS(touched_places(kBlock, other, {}), ContractViolation);
}

// Vertices at 0, 5 and 30 mm of X. The true skin sinks by 4, 2 and 0 mm.
struct Dent {
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 3);
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 3);
  Dent() {
    rest.row(0) << 0, 0.005, 0.030;
    truth.row(2) << -0.004, -0.002, 0;
  }
  [[nodiscard]] double of(const Eigen::Matrix3Xd& found) const { return at(found, {0.001, 0, 0}); }
  [[nodiscard]] double at(const Eigen::Matrix3Xd& found, const Vector3d& touched) const {
    return overpress(rest, truth, found, std::array{touched});
  }
};

TEST_CASE("a body pressed farther than the truth is overpressed by the difference", "[score]") {
  const Dent dent;
  CHECK(dent.of(dent.truth) == 0);
  CHECK(dent.of(2 * dent.truth) == Approx(0.004));
  Eigen::Matrix3Xd broad = dent.truth;
  broad(2, 1) = -0.009;  // correct at the touch, 7 mm too deep beside it
  CHECK(dent.of(broad) == Approx(0.007));
  CHECK(dent.of(0 * dent.truth) == 0);  // too small a displacement is no overpress
}

TEST_CASE("motion elsewhere, or across the true direction, is no overpress", "[score]") {
  const Dent dent;
  Eigen::Matrix3Xd found = dent.truth;
  found(2, 2) = -0.02;  // 30 mm away
  found(0, 0) = 0.003;  // across the true direction
  CHECK(dent.of(found) == Approx(0).margin(1e-15));
}

TEST_CASE("a touch between coarse vertices is at the nearest of them", "[score]") {
  const Dent dent;
  CHECK(dent.at(2 * dent.truth, {-0.05, 0, 0}) == Approx(0.004));
}

TEST_CASE("where the true skin does not move, every direction counts", "[score]") {
  Dent dent;
  dent.truth.setZero();
  Eigen::Matrix3Xd found = Eigen::Matrix3Xd::Zero(3, 3);
  found(1, 0) = 0.003;
  CHECK(dent.at(found, {0, 0, 0}) == Approx(0.003));
}

TEST_CASE("each touched place has its own direction, and the worst place counts", "[score]") {
  // Finger and thumb push the ends of a bar towards each other by 4 and 3 mm.
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 2);
  rest(0, 1) = 0.05;
  Eigen::Matrix3Xd truth = Eigen::Matrix3Xd::Zero(3, 2);
  truth.row(0) << 0.004, -0.003;
  Eigen::Matrix3Xd found = truth;
  found(0, 1) = -0.008;
  const std::array places{Vector3d(0, 0, 0), Vector3d(0.05, 0, 0)};
  CHECK(overpress(rest, truth, found, std::span(places).first(1)) == 0);
  CHECK(overpress(rest, truth, found, places) == Approx(0.005));
  for (const double first : {0.005, 0.010}) {  // 1 and 6 mm too far
    found.row(0) << first, -0.008;
    CHECK(overpress(rest, truth, found, places) == Approx(std::max(first - 0.004, 0.005)));
  }
  CHECK(overpress(rest, truth, truth, places) == 0);
}

TEST_CASE("displacements of another skin, and an empty list of touched places, are refused",
          "[score][errors]") {
  const Dent dent;
  CHECK_THROWS_AS(dent.of(dent.truth.leftCols(2)), ContractViolation);
  CHECK_THROWS_AS(overpress(dent.rest, dent.truth, dent.truth, {}), ContractViolation);
}

TEST_CASE("on the same skin every value stays as it is", "[score]") {
  const SurfaceMesh skin = sphere_surface({0.1, 0, 0}, 0.05, 2);
  const SkinProjection same(skin, skin.vertices);
  const Eigen::Matrix3Xd u = 0.1 * skin.vertices.array().sin();
  const Eigen::VectorXd stress = skin.vertices.row(2).transpose();
  const double rounding = tolerance(1e-15, "weights of a corner, of numbers below 1");
  CHECK((same.vectors(u) - u).cwiseAbs().maxCoeff() <= rounding);
  CHECK((same.numbers(stress) - stress).cwiseAbs().maxCoeff() <= rounding);
}

TEST_CASE("a linear field is the same on any triangulation of a box", "[score]") {
  // A box of 12 triangles; points on its faces, and one 1 mm above the middle of its top.
  const SurfaceMesh box = box_surface({0, 0, 0}, {0.1, 0.2, 0.3});
  Eigen::Matrix3Xd points(3, 3);
  points.col(0) << 0.03, 0.05, 0.3;
  points.col(1) << 0.1, 0.11, 0.12;
  points.col(2) << 0.05, 0.1, 0.301;
  const SkinProjection projection(box, points);
  const Eigen::VectorXd field = (Eigen::RowVector3d(1, 2, 3) * box.vertices).transpose();
  const Eigen::VectorXd found = projection.numbers(field);
  const double rounding = tolerance(1e-15, "sums of three numbers near 1");
  CHECK(std::abs(found[0] - (0.03 + 0.10 + 0.9)) <= rounding);
  CHECK(std::abs(found[1] - (0.1 + 0.22 + 0.36)) <= rounding);
  CHECK(std::abs(found[2] - (0.05 + 0.2 + 0.9)) <= rounding);  // the value at the point below it
  const Eigen::Matrix3Xd moved = projection.vectors(2.0 * box.vertices);
  CHECK((moved.leftCols(2) - 2.0 * points.leftCols(2)).cwiseAbs().maxCoeff() <= rounding);
}

TEST_CASE("a field of another skin is refused", "[score][errors]") {
  const SurfaceMesh box = box_surface({0, 0, 0}, {1, 1, 1});
  const SkinProjection projection(box, box.vertices);
  CHECK_THROWS_AS(projection.vectors(Eigen::Matrix3Xd::Zero(3, 7)), ContractViolation);
  CHECK_THROWS_AS(projection.numbers(Eigen::VectorXd::Zero(9)), ContractViolation);
  CHECK_THROWS_AS(SkinProjection(SurfaceMesh{}, box.vertices), ContractViolation);
}

}  // namespace
}  // namespace palpable
