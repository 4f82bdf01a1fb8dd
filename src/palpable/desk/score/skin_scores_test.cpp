#include "palpable/desk/score/skin_scores.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

TEST_CASE("the distance to a capsule of constant radius is that to its axis minus the radius",
          "[score]") {
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.1}, 0.01, 0.01};
  CHECK(distance_to(capsule, {0.03, 0, 0.05}) == Approx(0.02));
  CHECK(distance_to(capsule, {0.004, 0, 0.05}) == Approx(-0.006));
  CHECK(distance_to(capsule, {0, 0, -0.03}) == Approx(0.02));
  CHECK(distance_to(capsule, {0, 0.03, 0.14}) == Approx(0.04));
}

TEST_CASE("the distance to a tapered capsule is the least over all its balls", "[score][law]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> place(-0.05, 0.05), radius(0.005, 0.03);
    const auto point = [&] { return Vector3d(place(random), place(random), place(random)); };
    const Capsule capsule{point(), point(), radius(random), radius(random)};
    for (int i = 0; i < 50; ++i) {
      const Vector3d x = 1.5 * point();
      double least = std::numeric_limits<double>::infinity();
      for (int j = 0; j <= 2000; ++j) {
        const double t = j / 2000.0;
        least = std::min(least, (x - capsule.a - t * (capsule.b - capsule.a)).norm() -
                                    (capsule.ra + t * (capsule.rb - capsule.ra)));
      }
      CHECK(std::abs(distance_to(capsule, x) - least) <
            tolerance(2e-7, "balls every 0.1 mm: (5e-5)^2 / 2 over the distance of at least 6 mm"));
    }
  }
}

TEST_CASE("an end ball inside the other one changes nothing", "[score]") {
  const Capsule capsule{{0, 0, 0}, {0, 0, 0.005}, 0.02, 0.01};
  CHECK(distance_to(capsule, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({capsule.b, capsule.a, 0.01, 0.02}, {0, 0, 0.03}) == Approx(0.01));
  CHECK(distance_to({{1, 2, 3}, {1, 2, 3}, 0.5, 0.5}, {1, 2, 4}) == Approx(0.5));
}

// A mesh of degenerate triangles, one at each of the given points.
SurfaceMesh points(const std::vector<Vector3d>& at) {
  SurfaceMesh surface;
  surface.vertices.resize(3, static_cast<Eigen::Index>(at.size()));
  surface.triangles.resize(3, surface.vertices.cols());
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i) {
    surface.vertices.col(i) = at[i];
    surface.triangles.col(i).setConstant(static_cast<int>(i));
  }
  return surface;
}

TEST_CASE("the penetration is that of the deepest vertex in any capsule", "[score]") {
  const Vector3d outside(0.5, 0, 0);
  const Vector3d in_first(0.007, 0, 0.05);    // 3 mm inside
  const Vector3d in_second(0.2, 0.001, 0);    // 19 mm inside
  const Vector3d also_second(0.2, 0.010, 0);  // 10 mm inside
  const std::vector<Capsule> capsules{{{0, 0, 0}, {0, 0, 0.1}, 0.01, 0.01},
                                      {{0.2, 0, 0}, {0.2, 0, 0}, 0.02, 0.02}};
  CHECK(deepest_penetration(points({outside, in_first, in_second, also_second}), capsules) ==
        Approx(0.019));
  CHECK(deepest_penetration(points({outside, in_first}), capsules) == Approx(0.003));
  CHECK(deepest_penetration(points({outside}), capsules) == 0);
  CHECK(deepest_penetration(points({outside, in_first}), {}) == 0);
}

// A right triangle with legs of 40 mm in the plane Z = 0.
SurfaceMesh large_triangle() {
  SurfaceMesh surface;
  surface.vertices.resize(3, 3);
  surface.vertices.col(0) = Vector3d(0, 0, 0);
  surface.vertices.col(1) = Vector3d(0.04, 0, 0);
  surface.vertices.col(2) = Vector3d(0, 0.04, 0);
  surface.triangles.resize(3, 1);
  surface.triangles.col(0) = Eigen::Vector3i(0, 1, 2);
  return surface;
}

TEST_CASE("a pencil that comes through between the vertices is found", "[score]") {
  // A tip of 1.2 mm radius that reaches 5 mm through the plane: the plane is 1.2 mm deep on its
  // axis.
  const std::vector<Capsule> pencil{
      {{0.0117, 0.0093, -0.005}, {0.0117, 0.0093, 0.1}, 0.0012, 0.0012}};
  const double depth = deepest_penetration(large_triangle(), pencil);
  // With samples 1.25 mm apart (40 mm / 32), one is nearer to the axis than 0.9 mm.
  CHECK(depth <= 0.0012);
  CHECK(depth >= 0.0012 - 0.0009);
}

TEST_CASE("skipping parts does not change the result: all samples give the same depth",
          "[score][law]") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> place(-0.03, 0.06), radius(0.001, 0.02);
    const auto point = [&] { return Vector3d(place(random), place(random), 0.5 * place(random)); };
    std::vector<Capsule> hand;
    for (int i = 0; i < 3; ++i) hand.push_back({point(), point(), radius(random), radius(random)});
    // The longest edge, 40 sqrt(2) mm, is halved five times to be at most 2 mm: 32 parts.
    double deepest = 0;
    for (int i = 0; i <= 32; ++i) {
      for (int j = 0; i + j <= 32; ++j) {
        const Vector3d x(0.04 * i / 32, 0.04 * j / 32, 0);
        for (const Capsule& c : hand) deepest = std::max(deepest, -distance_to(c, x));
      }
    }
    CHECK(std::abs(deepest_penetration(large_triangle(), hand) - deepest) <=
          tolerance(1e-15, "rounding of sums in another order"));
  }
}

TEST_CASE("a triangle of 1000 km is searched quickly", "[score]") {
  SurfaceMesh huge = large_triangle();
  huge.vertices *= 25e3;
  const std::vector<Capsule> ball{{{10, 10, 0}, {10, 10, 0}, 3, 3}};
  CHECK(deepest_penetration(huge, ball) == Approx(3).margin(0.2));
}

constexpr double kFar = 10;  // m, X of a hand that touches nothing

// Two vertices at X = 0 and 0.1 m, the first one lifted, and a ball of 10 mm radius as the hand.
PopFrame frame(int number, double lifted, double hand_x) {
  PopFrame f;
  f.number = number;
  f.surface.resize(3, 2);
  f.surface.col(0) = Vector3d(0, 0, lifted);
  f.surface.col(1) = Vector3d(0.1, 0, 0);
  const Vector3d at(hand_x, 0, 0.01);
  f.hand = {{at, at, 0.01, 0.01}};
  return f;
}

TEST_CASE("a jump of 5 mm while the hand moves 2 mm is a pop of 3 mm", "[score]") {
  PopScorer scorer;
  scorer.add(frame(7, 0, 0));
  CHECK_FALSE(scorer.largest().has_value());
  scorer.add(frame(8, 0.005, 0.002));
  REQUIRE(scorer.largest().has_value());
  CHECK(scorer.largest()->size == Approx(0.003));
  CHECK(scorer.largest()->frame == 8);
  scorer.add(frame(9, 0.006, 0.002));  // a smaller pop changes nothing
  CHECK(scorer.largest()->frame == 8);
}

TEST_CASE("pops of more than 4 mm are counted, one by one", "[score]") {
  PopScorer scorer;
  CHECK_FALSE(scorer.counted().has_value());
  int n = 0;
  for (const double lifted : {0.0, 0.005, 0.0, 0.0039, 0.0085, 0.0085}) {
    scorer.add(frame(n++, lifted, kFar));  // 5, 5, 3.9, 4.6 and 0 mm
  }
  CHECK(scorer.counted() == 3);
}

TEST_CASE("a surface that moves with the hand does not pop", "[score]") {
  PopScorer scorer;
  for (int n = 0; n < 10; ++n) scorer.add(frame(n, 0.003 * n, 0.003 * n));
  CHECK(scorer.largest()->size == Approx(0).margin(1e-15));
}

TEST_CASE("a response may be two frames late, not three", "[score]") {
  for (const int late : {1, 2, 3}) {
    INFO("late by " << late);
    PopScorer scorer;
    scorer.add(frame(0, 0, 0));
    for (int n = 1; n < 8; ++n)
      scorer.add(frame(n, n >= 1 + late ? 0.004 : 0, 0.004));  // the hand moves in frame 1
    CHECK(scorer.largest()->size == Approx(late <= 2 ? 0 : 0.004).margin(1e-15));
  }
}

TEST_CASE("a hand that is far away explains nothing", "[score]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, kFar));
  scorer.add(frame(1, 0.004, kFar + 1));
  CHECK(scorer.largest()->size == Approx(0.004));
}

TEST_CASE("a hand that comes into view far away does not stop the comparison, near by it does",
          "[score]") {
  for (const bool near : {false, true}) {
    PopScorer scorer;
    PopFrame before = frame(0, 0, 0);
    before.hand.clear();
    scorer.add(before);
    scorer.add(frame(1, 0.004, near ? 0 : kFar));
    CHECK(scorer.largest().has_value() == !near);
  }
}

TEST_CASE("a jump is found although the frames in between were skipped", "[score]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, kFar));
  scorer.add(frame(5, 0.0045, kFar));
  CHECK(scorer.largest()->size == Approx(0.0045));
  CHECK(scorer.largest()->frame == 5);
  CHECK(scorer.counted() == 1);
  scorer.add(frame(6, 0.0045, 0));
  scorer.add(frame(9, 0.0065, 0.002));  // as far as the hand since frame 6
  CHECK(scorer.largest()->frame == 5);
}

TEST_CASE("the motion of the hand is measured in the world, independently of the camera",
          "[score]") {
  // The camera moves from 30 mm left of the body to 50 mm right of it; the hand, above the body,
  // moves 1 mm to the right.
  PopScorer scorer;
  PopFrame before = frame(0, 0, 0.03);
  before.world_from_camera.translation() = Vector3d(-0.03, 0, 0);
  before.camera_from_body.translation() = Vector3d(0.03, 0, 0);
  PopFrame now = frame(1, 0.004, -0.05 + 0.001);
  now.world_from_camera.translation() = Vector3d(0.05, 0, 0);
  now.camera_from_body.translation() = Vector3d(-0.05, 0, 0);
  scorer.add(before);
  scorer.add(now);
  CHECK(scorer.largest()->size == Approx(0.003));
}

TEST_CASE("the part of the hand that is far away explains nothing either", "[score]") {
  PopScorer scorer;
  for (int n = 0; n < 2; ++n) {
    PopFrame f = frame(n, 0.004 * n, 0);
    f.hand.push_back(frame(n, 0, kFar + n).hand.front());
    scorer.add(f);
  }
  CHECK(scorer.largest()->size == Approx(0.004));
}

TEST_CASE("a surface with another number of vertices is refused", "[score][errors]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, 0));
  PopFrame other = frame(1, 0, 0);
  other.surface.conservativeResize(3, 1);
  CHECK_THROWS_AS(scorer.add(other), ContractViolation);
}

TEST_CASE("the offset of balls of two sizes is the difference of the radii", "[score]") {
  const SurfaceMesh fine = sphere_surface({0, 0, 0.05}, 0.05, 4);
  CHECK(skin_offset(fine, fine) <= tolerance(1e-15, "rounding"));
  const SurfaceMesh larger = sphere_surface({0, 0, 0.05}, 0.052, 4);
  CHECK(skin_offset(fine, larger) == Approx(0.002).epsilon(tolerance(0.02, "chords of 4 mm")));
  CHECK(skin_offset(larger, fine) == skin_offset(fine, larger));
}

TEST_CASE("a shifted ball has half its shift as offset", "[score]") {
  // |cos| of a direction is 1/2 on average over a sphere.
  const SurfaceMesh ball = sphere_surface({0, 0, 0.05}, 0.05, 4);
  const SurfaceMesh beside = sphere_surface({0.004, 0, 0.05}, 0.05, 4);
  CHECK(skin_offset(ball, beside) == Approx(0.002).epsilon(tolerance(0.02, "chords of 4 mm")));
}

TEST_CASE("the offset of a coarse mesh of the same ball is that of its chords", "[score]") {
  // The middles of edges of 28 mm lie 28^2 / (8 * 50) = 2 mm inside.
  const double coarse = skin_offset(sphere_surface(Vector3d::Zero(), 0.05, 1),
                                    sphere_surface(Vector3d::Zero(), 0.05, 4));
  CHECK(coarse > 0.0005);
  CHECK(coarse < 0.0040);
}

TEST_CASE("a part that one skin lacks counts in both orders", "[score]") {
  const SurfaceMesh whole = box_surface({0, 0, 0}, {0.1, 0.1, 0.1});
  SurfaceMesh half = whole;  // its vertices all lie on the sides of the whole box
  for (int v = 0; v < half.vertex_count(); ++v) half.vertices(2, v) *= 0.5;
  const double offset = skin_offset(whole, half);
  CHECK(offset == Approx(0.025));  // half of the vertices are 50 mm off
  CHECK(skin_offset(half, whole) == offset);
}

// Two vertices: the base, and one 100 mm above it.
Eigen::Matrix3Xd rod() {
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 2);
  rest(2, 1) = 0.1;
  return rest;
}

TEST_CASE("a body drawn 3 mm beside its position has an error of 3 mm for any camera pose",
          "[score]") {
  Rigid3 truth = Rigid3::Identity();
  truth.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  truth.translation() = Vector3d(0.1, -0.2, 0.4);
  CHECK(placement_error(rod(), truth, truth) == 0);
  Rigid3 drawn = truth;
  drawn.translation() += Vector3d(0, 0.003, 0);
  CHECK(placement_error(rod(), truth, drawn) == Approx(0.003));
}

TEST_CASE("the error of a tilted body is the displacement of its top", "[score]") {
  Rigid3 drawn = Rigid3::Identity();
  drawn.linear() = Eigen::AngleAxisd(0.2, Vector3d::UnitX()).toRotationMatrix();
  CHECK(placement_error(rod(), Rigid3::Identity(), drawn) == Approx(2 * 0.1 * std::sin(0.1)));
  CHECK_THROWS_AS(placement_error(Eigen::Matrix3Xd(3, 0), drawn, drawn), ContractViolation);
}

}  // namespace
}  // namespace palpable
