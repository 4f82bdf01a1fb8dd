#include "palpable/common/geometry/pixel_box.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

const PinholeCamera kCamera{160, 120, 200, 210, 79.5, 60.5};

TEST_CASE("every point of a box of space is seen in its part of the image", "[geometry]") {
  int inside = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> where(-0.2, 0.2), share(0, 1);
    Rigid3 camera_from_space(
        Eigen::AngleAxisd(10 * where(random), Vector3d(1, 2, -1).normalized()));
    camera_from_space.translation() = Vector3d(where(random), where(random), 0.7);
    const Vector3d corner(where(random), where(random), where(random));
    const AlignedBox3d space(corner, corner + Vector3d(0.1, 0.05, 0.2));
    const PixelBox box = box_in_image(space, camera_from_space, kCamera);
    for (int i = 0; i < 500; ++i) {
      const Vector3d x =
          camera_from_space *
          (space.min() +
           Vector3d(share(random), share(random), share(random)).cwiseProduct(space.sizes()));
      const double u = kCamera.cx_px + kCamera.fx_px * x.x() / x.z();
      const double v = kCamera.cy_px + kCamera.fy_px * x.y() / x.z();
      if (u < 0 || v < 0 || u >= kCamera.width || v >= kCamera.height) continue;
      ++inside;
      CHECK(box.contains(static_cast<int>(u), static_cast<int>(v)));
    }
  }
  CHECK(inside > 1000);
}

TEST_CASE("a box behind the camera is not seen, one around it may be anywhere", "[geometry]") {
  const AlignedBox3d behind(Vector3d(-1, -1, -2), Vector3d(1, 1, -1));
  const PixelBox none = box_in_image(behind, Rigid3::Identity(), kCamera);
  CHECK(none.width * none.height == 0);
  const AlignedBox3d around(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
  const PixelBox all = box_in_image(around, Rigid3::Identity(), kCamera);
  CHECK(all.width == 160);
  CHECK(all.height == 120);
  const AlignedBox3d beside(Vector3d(5, 0, 1), Vector3d(6, 1, 2));
  CHECK(box_in_image(beside, Rigid3::Identity(), kCamera).width == 0);
  CHECK_THROWS_AS(box_in_image(AlignedBox3d(), Rigid3::Identity(), kCamera), ContractViolation);
}

TEST_CASE("a box grows up to the image's border", "[geometry]") {
  const PixelBox box = grown({5, 50, 20, 65}, 10, kCamera);
  CHECK(box.x == 0);
  CHECK(box.y == 40);
  CHECK(box.width == 35);
  CHECK(box.height == 80);
}

}  // namespace
}  // namespace palpable
