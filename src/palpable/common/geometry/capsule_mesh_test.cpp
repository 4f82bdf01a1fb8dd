#include "palpable/common/geometry/capsule_mesh.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <numbers>

using namespace palpable;

TEST_CASE("a capsule's triangles stay within the chord error of its surface", "[geometry]") {
  constexpr double kError = 0.00009;
  for (const Capsule& c : {Capsule{{0, 0, 0}, {0.02, 0.01, 0.005}, 0.008, 0.007},
                           Capsule{{0.1, 0, 0}, {0.35, 0.05, 0}, 0.042, 0.050}}) {
    const CapsuleMesh mesh = tessellate(c, Eigen::Vector3d::UnitZ(), kError);
    double volume = 0.0;
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3d p = mesh.vertices.col(mesh.triangles(0, t));
      const Eigen::Vector3d q = mesh.vertices.col(mesh.triangles(1, t));
      const Eigen::Vector3d r = mesh.vertices.col(mesh.triangles(2, t));
      volume += p.dot(q.cross(r)) / 6.0;
      for (const Eigen::Vector3d& x :
           {p, q, r, Eigen::Vector3d((p + q + r) / 3), Eigen::Vector3d((p + r) / 2)}) {
        const double d = signed_distance(c, x);
        if (d > 1e-12 || d < -kError) FAIL("a point of a triangle lies " << d << " m outside");
      }
    }
    // With outward orientation the enclosed volume is positive: that of the frustum and two caps.
    const double length = (c.b - c.a).norm();
    const double rough = std::numbers::pi * (c.ra + c.rb) * (c.ra + c.rb) / 4 * length +
                         4.0 / 3.0 * std::numbers::pi * c.ra * c.rb * (c.ra + c.rb) / 2;
    CHECK(volume > 0.97 * rough);
    CHECK(volume < 1.03 * rough);
  }
  CHECK_THROWS_AS(tessellate({{0, 0, 0}, {1, 0, 0}, 0.0, 1.0}, Eigen::Vector3d::UnitZ(), kError),
                  ContractViolation);
}
