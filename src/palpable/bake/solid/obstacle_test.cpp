#include "palpable/bake/solid/obstacle.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/test.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

constexpr double kTurned = 0.8;  // rad

// One part of each kind, turned about z and moved along x.
Obstacle obstacle_at(const std::shared_ptr<const SurfaceDistance>& shape, double share) {
  Obstacle obstacle;
  obstacle.capsules = {{Vector3d(0, 0, 0), Vector3d(0.04, 0, 0), 0.008, 0.006}};
  obstacle.half_spaces = {{Vector3d(0.01, 0, 0), Vector3d::UnitX()}};
  obstacle.surfaces = {{shape, Rigid3::Identity()}};
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::AngleAxisd(share * kTurned, Vector3d::UnitZ()).toRotationMatrix();
  obstacle = moved(obstacle, pose);
  // Each part turns about its own origin, which goes straight.
  const Vector3d way = share * Vector3d(0.02, 0.01, 0);
  for (Vector3d* at : {&obstacle.capsules[0].a, &obstacle.capsules[0].b}) *at += way;
  obstacle.half_spaces[0].point = Vector3d(0.01, 0, 0) + way;
  obstacle.surfaces[0].body_from_shape.translation() = way;
  return obstacle;
}

TEST_CASE("an obstacle on its way goes straight and turns evenly", "[contact]") {
  const auto shape =
      std::make_shared<const SurfaceDistance>(sphere_surface(Vector3d::Zero(), 0.01, 2));
  const Obstacle from = obstacle_at(shape, 0), to = obstacle_at(shape, 1);
  const Vector3d place(0.013, 0.002, 0.003);
  for (const double t : {0.0, 0.3, 1.0}) {
    INFO("t " << t);
    const Obstacle now = interpolated(from, to, t), expected = obstacle_at(shape, t);
    REQUIRE(has_same_parts(now, expected));
    for (int part = 0; part < now.part_count(); ++part) {
      INFO("part " << part);
      CHECK((carried(from, now, part, place) - carried(from, expected, part, place)).norm() <
            tolerance(1e-12, "m: rounding"));
    }
  }
}

}  // namespace
}  // namespace palpable
