#include "palpable/track/new_corners.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace palpable {
namespace {

constexpr int kBlock = 5;  // px of the half image
// OpenCV's smaller eigenvalue of a block with a gradient of g grey levels per px is 4 g^2 / 255^2:
// this is one level per px.
constexpr float kLeastStrength = 6e-5F;
constexpr int kBorder = 6;  // px of the half image
constexpr int kEighths = 8;
constexpr double kJump = 0.06;  // largest spread of depths around a corner, as a share

struct Strong {
  float strength = 0;
  int x = 0, y = 0;  // of the half image
};

// The depth at a pixel if it and its neighbours are known and are one surface.
std::optional<double> depth_at(const DepthImage& depth, int x, int y) {
  if (x < 1 || y < 1 || x >= depth.width() - 1 || y >= depth.height() - 1) return std::nullopt;
  float least = INFINITY, most = 0;
  int known = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float Z = depth(x + dx, y + dy);
      if (!(Z > 0)) continue;
      ++known;
      least = std::min(least, Z);
      most = std::max(most, Z);
    }
  }
  const float Z = depth(x, y);
  if (known < 6 || !(Z > 0) || most - least > static_cast<float>(kJump) * least)
    return std::nullopt;
  return static_cast<double>(Z);
}

// d(1/Z) per px of the depth image along (dx, dy); 0 where the surface ends or jumps.
double slope_along(const DepthImage& depth, int x, int y, int dx, int dy) {
  constexpr int kReach = 4;
  const int x0 = x - kReach * dx, x1 = x + kReach * dx;
  const int y0 = y - kReach * dy, y1 = y + kReach * dy;
  if (x0 < 0 || y0 < 0 || x1 >= depth.width() || y1 >= depth.height()) return 0;
  const auto before = static_cast<double>(depth(x0, y0));
  const auto after = static_cast<double>(depth(x1, y1));
  const auto here = static_cast<double>(depth(x, y));
  if (!(before > 0 && after > 0)) return 0;
  const double bend = 1 / before + 1 / after - 2 / here;
  if (std::abs(after - before) > 0.3 * here || std::abs(bend) * here > 0.1) return 0;
  return (1 / after - 1 / before) / (2 * kReach);
}

}  // namespace

std::vector<Corner> new_corners(const GrayImage& half, const DepthImage& depth,
                                const MaskImage* moving, std::span<const Eigen::Vector2d> taken,
                                int cells_across, int most) {
  std::vector<Corner> corners;
  if (most <= 0 || half.width() <= 2 * kBorder || half.height() <= 2 * kBorder) return corners;
  cv::Mat strength;
  try {
    const cv::Mat image(half.height(), half.width(), CV_8UC1,
                        const_cast<std::uint8_t*>(half.data()));  // NOLINT: read only
    cv::cornerMinEigenVal(image, strength, kBlock);
  } catch (const cv::Exception&) { return corners; }

  const double cell = static_cast<double>(half.width()) / cells_across;
  const int down = static_cast<int>(std::ceil(half.height() / cell));
  const auto cell_of = [&](double x, double y) {
    const int cx = std::clamp(static_cast<int>(x / cell), 0, cells_across - 1);
    const int cy = std::clamp(static_cast<int>(y / cell), 0, down - 1);
    return static_cast<std::size_t>(cy * cells_across + cx);
  };
  std::vector<char> full(static_cast<std::size_t>(cells_across * down), 0);
  for (const Eigen::Vector2d& uv : taken) full[cell_of(uv.x() / 2, uv.y() / 2)] = 1;
  std::vector<Strong> best(full.size());
  const double scale = static_cast<double>(depth.width()) / half.width();
  const auto depth_pixel = [&](int x) { return static_cast<int>((x + 0.5) * scale); };
  for (int y = kBorder; y < half.height() - kBorder; ++y) {
    const auto* row = strength.ptr<float>(y);
    for (int x = kBorder; x < half.width() - kBorder; ++x) {
      if (row[x] < kLeastStrength) continue;
      const std::size_t c = cell_of(x, y);
      if (full[c] != 0 || row[x] <= best[c].strength) continue;
      const int dx = depth_pixel(x), dy = depth_pixel(y);
      if (moving != nullptr && !moving->empty() && (*moving)(dx, dy) != 0) continue;
      if (!depth_at(depth, dx, dy)) continue;
      best[c] = {row[x], x, y};
    }
  }
  std::stable_sort(best.begin(), best.end(),
                   [](const Strong& a, const Strong& b) { return a.strength > b.strength; });
  std::vector<int> of_eighth(kEighths * kEighths, 0);
  const int most_of_eighth = std::max(3, 2 * most / (kEighths * kEighths) + 1);
  for (const Strong& strong : best) {
    if (strong.strength <= 0 || static_cast<int>(corners.size()) >= most) break;
    int& count = of_eighth[static_cast<std::size_t>(strong.y * kEighths / half.height() * kEighths +
                                                    strong.x * kEighths / half.width())];
    if (count >= most_of_eighth) continue;
    ++count;
    const int dx = depth_pixel(strong.x), dy = depth_pixel(strong.y);
    Corner corner;
    corner.uv = {2.0 * strong.x, 2.0 * strong.y};
    corner.depth = depth_at(depth, dx, dy).value_or(0);
    const double per_full = scale / 2;  // depth px per px of the full image
    corner.slope = per_full * Eigen::Vector2d(slope_along(depth, dx, dy, 1, 0),
                                              slope_along(depth, dx, dy, 0, 1));
    corners.push_back(corner);
  }
  return corners;
}

}  // namespace palpable
