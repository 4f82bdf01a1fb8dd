#include "palpable/common/contact/near_points.h"

#include "palpable/common/contact/capsule_obstacles.h"
#include "tests/support/ball_gap.h"
#include "tests/support/test.h"
#include "tests/support/touchable_ball.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3f;
using test::tolerance;

constexpr double kEntry = 0.00025;  // m

struct Ball : test::TouchableBall {
  Ball() : TouchableBall(kEntry) {}
};

std::vector<int> found_by(NearPoints& near_points, float band, const Obstacles& obstacles) {
  std::vector<int> points;
  near_points.for_each(band, obstacles, [&](int point, const SurfaceGap& seen) {
    CHECK(seen.distance <= band);
    points.push_back(point);
  });
  std::sort(points.begin(), points.end());
  return points;
}

// The gap of one point at x. False: nothing is near.
bool find_gap(NearPoints& near_points, int point, const Vector3f& x, const Obstacles& obstacles,
              float far, SurfaceGap& gap) {
  near_points.find_gaps({&point, 1}, {&x, 1}, obstacles, far, {&gap, 1});
  return std::isfinite(gap.distance);
}

// The same by querying every point.
std::vector<int> near_by_all(Ball& ball, float band, const test::GapFunction& gap) {
  std::vector<int> points;
  const SkinPointSet all = ball.body->contact_points();
  for (int p = 0; p < static_cast<int>(all.points.size()); ++p) {
    SurfaceGap seen;
    if (!gap(ball.body->shape_at(p), seen) || seen.distance > band) continue;
    const float bend = largest_curvature(seen.curvature);
    if (is_point_needed(all.levels[static_cast<std::size_t>(p)], bend, static_cast<float>(kEntry),
                        all.coarsest, all.finest)) {
      points.push_back(p);
    }
  }
  return points;
}

TEST_CASE("the larger curvature of cylinders, balls and concave surfaces", "[contact]") {
  const auto bent = [](float x, float y) -> Eigen::Matrix3f {
    return Vector3f(x, y, 0).asDiagonal();
  };
  CHECK(largest_curvature(bent(100, 0)) == Approx(100));
  CHECK(largest_curvature(bent(50, 50)) == Approx(50));
  CHECK(largest_curvature(bent(-80, 20)) == Approx(20));
}

TEST_CASE("a sharp obstacle needs all points, a flat one the coarse ones", "[contact]") {
  const float flat = 0, pencil = 1 / 0.0035f;
  const float coarsest = 0.006f, finest = 0.0015f, entry = 0.00025f;
  CHECK(is_point_needed(0.006f, flat, entry, coarsest, finest));
  CHECK_FALSE(is_point_needed(0.003f, flat, entry, coarsest, finest));
  CHECK(is_point_needed(0.003f, pencil, entry, coarsest, finest));
}

TEST_CASE("clusters leave out no near point, for balls of any size", "[contact]") {
  Ball ball;
  ball.state.u.row(0).setConstant(0.003f);  // the shape has moved, too
  for (const float radius : {0.0035f, 0.008f, 0.030f}) {
    for (const float band : {0.0f, 0.001f, 0.004f}) {
      INFO(radius << " " << band);
      const test::GapFunction gap = test::gap_to_ball({0.003f + 0.02f, 0, 0.074f + radius}, radius);
      NearPoints near_points(*ball.body);
      near_points.start();
      const test::GapFunction always(gap, [](const Vector3f&, float) { return true; });
      const std::vector<int> points = found_by(near_points, band, always);
      CHECK(points == near_by_all(ball, band, gap));
      CHECK((band == 0.0f || !points.empty()));
      // may_be_within(), which is called first, does not change the result.
      NearPoints beside(*ball.body);
      beside.start();
      const test::GapFunction::Near near = [&](const Vector3f& x, float reach) {
        SurfaceGap seen;
        return reach > kGapReach || (gap(x, seen) && seen.distance < reach);
      };
      CHECK(found_by(beside, band, test::GapFunction(gap, near)) == points);
    }
  }
}

TEST_CASE("a gap is queried once at a position, and given by its curvature near it", "[contact]") {
  Ball ball;
  NearPoints near_points(*ball.body);
  near_points.start();
  const float radius = 0.008f;
  const test::GapFunction exact = test::gap_to_ball(Vector3f::Zero(), radius);
  int queried = 0;
  const test::GapFunction gap = [&](const Vector3f& x, SurfaceGap& seen) {
    ++queried;
    return exact(x, seen);
  };
  const float far = 1;  // m: all distances are needed
  SurfaceGap seen, wanted;
  const Vector3f x(0, 0, radius + 0.001f), beside = x + Vector3f(0.00025f, 0, 0.0001f);
  CHECK(find_gap(near_points, 5, x, gap, far, seen));
  CHECK(find_gap(near_points, 5, beside, gap, far, seen));
  CHECK(queried == 1);
  CHECK(exact(beside, wanted));
  CHECK(std::abs(seen.distance - wanted.distance) <
        tolerance(1e-7, "m: third order of 0.27 mm by a ball of 8 mm, and single precision"));
  CHECK((seen.normal - wanted.normal).norm() < tolerance(1e-3, "second order of the normal"));
  // Queried again: another point, a position farther away, another frame.
  CHECK(find_gap(near_points, 6, x, gap, far, seen));
  CHECK(find_gap(near_points, 5, x + Vector3f(0, 0, 0.0004f), gap, far, seen));
  near_points.start();
  CHECK(find_gap(near_points, 5, x + Vector3f(0, 0, 0.0004f), gap, far, seen));
  CHECK(queried == 4);
}

TEST_CASE("a point that stays far is not queried again, and gets a lower bound of its distance",
          "[contact]") {
  Ball ball;
  NearPoints near_points(*ball.body);
  near_points.start();
  int queried = 0;
  const test::GapFunction exact = test::gap_to_ball(Vector3f::Zero(), 0.008f);
  const test::GapFunction gap = [&](const Vector3f& x, SurfaceGap& seen) {
    ++queried;
    return exact(x, seen);
  };
  SurfaceGap seen;
  const float far = 0.001f;
  CHECK(find_gap(near_points, 0, {0, 0, 0.018f}, gap, far, seen));  // 10 mm away
  CHECK(find_gap(near_points, 0, {0, 0, 0.014f}, gap, far, seen));  // at least 6 mm
  CHECK(queried == 1);
  CHECK(seen.distance >= 0.006f - 1e-7f);
  CHECK(find_gap(near_points, 0, {0, 0, 0.0085f}, gap, far, seen));  // might be near
  CHECK(queried == 2);
  CHECK(seen.distance == Approx(0.0005).margin(1e-7));
}

TEST_CASE("many positions are queried in one call, and known ones not at all", "[contact]") {
  struct Counting : Obstacles {
    mutable std::vector<std::size_t> calls;  // positions in each call
    const test::GapFunction exact = test::gap_to_ball(Vector3f::Zero(), 0.008f);
    void find_gaps(std::span<const Vector3f> places, std::span<SurfaceGap> gaps) const override {
      calls.push_back(places.size());
      exact.find_gaps(places, gaps);
    }
    [[nodiscard]] bool may_be_within(const Vector3f& place, float reach) const override {
      return exact.may_be_within(place, reach);
    }
  } obstacles;
  Ball ball;
  NearPoints near_points(*ball.body);
  near_points.start();
  const std::vector<int> points{3, 1, 7};
  std::vector<Vector3f> places{{0, 0, 0.009f}, {0, 0.01f, 0}, {0.05f, 0, 0}};
  std::vector<SurfaceGap> gaps(3);
  near_points.find_gaps(points, places, obstacles, 1, gaps);
  CHECK(gaps[0].distance == Approx(0.001).margin(1e-7));
  CHECK(gaps[1].distance == Approx(0.002).margin(1e-7));
  CHECK(std::isinf(gaps[2].distance));
  places[1].y() += 0.001f;
  near_points.find_gaps(points, places, obstacles, 1, gaps);
  CHECK(gaps[1].distance == Approx(0.003).margin(1e-7));
  CHECK(obstacles.calls == std::vector<std::size_t>{3, 1});
}

TEST_CASE("a gap with NaN counts as no obstacle", "[contact]") {
  Ball ball;
  NearPoints near_points(*ball.body);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int which = 0; which < 3; ++which) {
    near_points.start();
    const test::GapFunction gap = [&](const Vector3f&, SurfaceGap& seen) {
      seen.distance = 0.001f;
      if (which == 0) seen.distance = nan;
      if (which == 1) seen.normal.x() = nan;
      if (which == 2) seen.curvature(1, 1) = nan;
      return true;
    };
    SurfaceGap seen;
    CHECK_FALSE(find_gap(near_points, 0, Vector3f::Zero(), gap, 0, seen));
  }
}

// The deepest contact point by querying every one.
float deepest_of_all(Ball& ball, const Obstacles& obstacles) {
  float deepest = 0;
  for (int p = 0; p < static_cast<int>(ball.body->contact_points().points.size()); ++p) {
    deepest = std::max(deepest, obstacles.depth_at(ball.body->shape_at(p)));
  }
  return deepest;
}

TEST_CASE("the deepest point is found for balls of any size and depth, and when the body is inside",
          "[contact]") {
  Ball ball;
  ball.state.u.row(0).setConstant(0.003f);  // the shape has moved, too
  const NearPoints near_points(*ball.body);
  for (const double radius : {0.002, 0.008, 0.030, 1.0}) {
    for (const double depth : {-0.01, 0.0001, 0.004, 0.02, 0.5, 1.0}) {
      INFO(radius << " " << depth);
      CapsuleObstacles obstacles;
      const Eigen::Vector3d centre(0.003 + 0.01, -0.004, 0.08 + radius - depth);
      obstacles.set(std::vector<Capsule>{{centre, centre, radius, radius}});
      CHECK(near_points.depth_of_points(obstacles) == deepest_of_all(ball, obstacles));
    }
  }
}

TEST_CASE("the depth of the skin costs a query of each point near an obstacle, and few if none is",
          "[contact]") {
  struct Counting : CapsuleObstacles {
    mutable std::size_t near = 0, depths = 0;
    [[nodiscard]] bool may_be_within(const Vector3f& place, float reach) const override {
      ++near;
      return CapsuleObstacles::may_be_within(place, reach);
    }
    [[nodiscard]] float depth_at(const Vector3f& place) const override {
      ++depths;
      return CapsuleObstacles::depth_at(place);
    }
  } obstacles;
  Ball ball;
  const NearPoints near_points(*ball.body);
  const std::size_t all = ball.body->contact_points().points.size();
  const auto press = [&](double radius, double depth) {
    const Eigen::Vector3d centre(0, 0, 0.08 + radius - depth);
    obstacles.set(std::vector<Capsule>{{centre, centre, radius, radius}});
    obstacles.near = obstacles.depths = 0;
    return near_points.depth_of_points(obstacles);
  };
  CHECK(press(0.008, -0.1) == 0);
  CHECK(obstacles.depths == 0);
  CHECK(obstacles.near < all / 100);
  CHECK(press(0.008, 0.004) > 0.0035f);  // a finger
  CHECK(obstacles.depths > 4);
  CHECK(obstacles.depths < all / 8);
  // Around the whole body: one for each point and for the middle of each cluster at most.
  CHECK(press(1, 0.6) == Approx(0.6).margin(tolerance(1e-3, "m: edges of 5 mm")));
  CHECK(obstacles.depths <= all + ball.body->contact_points().clusters->clusters().size());
}

TEST_CASE("vertices that the support holds are judged, though they are no contact points",
          "[contact]") {
  Ball ball;
  for (int v = 0; v < ball.surface.vertex_count(); ++v) {
    ball.fixed[static_cast<std::size_t>(v)] = ball.surface.vertices(2, v) < 0.010;
  }
  ball.body = ball.made();
  const NearPoints near_points(*ball.body);
  CapsuleObstacles obstacles;
  obstacles.set(std::vector<Capsule>{{{0, 0, -0.005}, {0, 0, -0.005}, 0.008, 0.008}});
  // The lowest vertex is at (0, 0, 0) to within half an edge.
  CHECK(near_points.depth_of_held(obstacles) == Approx(0.003).margin(tolerance(1e-3, "m: edges")));
  CHECK(near_points.depth_of_points(obstacles) == 0);
  obstacles.set(std::vector<Capsule>{{{0, 0, 0.085}, {0, 0, 0.085}, 0.008, 0.008}});
  CHECK(near_points.depth_of_held(obstacles) == 0);
  CHECK(near_points.depth_of_points(obstacles) > 0.002f);
}

}  // namespace
}  // namespace palpable
