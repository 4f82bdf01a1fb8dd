#include "palpable/desk/score/warped_depth.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

const PinholeCamera kCamera{64, 48, 50, 50, 31.5, 23.5};

// Six images of a wall at Z = 1 m in the world; the camera moves 2 mm towards it per image.
struct Walk {
  std::vector<DepthImage> depths;
  std::vector<Rigid3> poses;

  Walk() {
    for (int n = 0; n < 6; ++n) {
      DepthImage depth;
      depth.resize(kCamera.width, kCamera.height);
      for (int y = 0; y < kCamera.height; ++y) {
        for (int x = 0; x < kCamera.width; ++x) {
          depth(x, y) = 1 - 0.002f * static_cast<float>(n);
        }
      }
      depths.push_back(depth);
      poses.emplace_back(Eigen::Translation3d(0, 0, 0.002 * n));
    }
  }
};

TEST_CASE("depths of a wall agree with the true poses and differ by the error of a pose",
          "[score]") {
  Walk walk;
  const double near = tolerance(1e-6, "depths near 1 m in single precision");
  CHECK(warped_disagreement(walk.depths, walk.poses, kCamera).value() < near);
  // The first and the last of six images are the only pair.
  walk.poses[5].translation().z() += 0.003;
  CHECK(std::abs(warped_disagreement(walk.depths, walk.poses, kCamera).value() - 0.003) < near);
  // Other surfaces are left out: a tenth of the picture is 0.5 m nearer.
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < kCamera.width; ++x) walk.depths[5](x, y) = 0.5F;
  }
  CHECK(std::abs(warped_disagreement(walk.depths, walk.poses, kCamera).value() - 0.003) < near);
}

TEST_CASE("unknown depths, or too few images, give no result; other sizes are refused", "[score]") {
  Walk walk;
  const std::vector<DepthImage> few(walk.depths.begin(), walk.depths.begin() + 5);
  const std::vector<Rigid3> few_poses(walk.poses.begin(), walk.poses.begin() + 5);
  CHECK_FALSE(warped_disagreement(few, few_poses, kCamera));
  CHECK_THROWS_AS(warped_disagreement(few, walk.poses, kCamera), ContractViolation);
  std::vector<DepthImage> blind = walk.depths;
  for (float& Z : blind[0]) Z = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(warped_disagreement(blind, walk.poses, kCamera));
  walk.depths[3].resize(8, 8);
  CHECK_THROWS_AS(warped_disagreement(walk.depths, walk.poses, kCamera), ContractViolation);
}

}  // namespace
}  // namespace palpable
