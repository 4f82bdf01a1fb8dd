#include "palpable/desk/score/warped_depth.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace palpable {

std::optional<double> warped_disagreement(std::span<const DepthImage> depths,
                                          std::span<const Rigid3> world_from_depth,
                                          const PinholeCamera& camera) {
  constexpr double kNearest = 0.1;      // m, smallest depth in image j
  constexpr double kSameSurface = 0.1;  // m, larger differences are different surfaces
  PALPABLE_EXPECT(depths.size() == world_from_depth.size(), "a pose per image");
  for (const DepthImage& depth : depths) {
    PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                    "images are of the camera's size");
  }
  std::vector<double> differences;
  for (std::size_t i = 0; i < depths.size(); i += 6) {
    for (const std::size_t apart : {5U, 15U, 40U}) {
      const std::size_t j = i + apart;
      if (j >= depths.size()) break;
      const Rigid3 j_from_i = world_from_depth[j].inverse() * world_from_depth[i];
      for (int y = 2; y < camera.height; y += 8) {
        for (int x = 2; x < camera.width; x += 8) {
          const auto Z = static_cast<double>(depths[i](x, y));
          if (!(Z > 0)) continue;
          const Eigen::Vector3d at = j_from_i * camera.unproject(x, y, Z);
          if (!(at.z() > kNearest)) continue;
          const Eigen::Vector2d uv = camera.project(at);
          const auto u = static_cast<int>(std::lround(uv.x()));
          const auto v = static_cast<int>(std::lround(uv.y()));
          if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
          const double difference = std::abs(static_cast<double>(depths[j](u, v)) - at.z());
          if (difference < kSameSurface) differences.push_back(difference);  // false for NaN
        }
      }
    }
  }
  if (differences.empty()) return std::nullopt;
  return percentile(std::move(differences), 0.5);
}

}  // namespace palpable
