#include "palpable/live/track/new_corners.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace palpable {
namespace {

constexpr int kBlock = 5;  // px of the half image
// Smallest strength of a corner, which is OpenCV's smaller eigenvalue. For a block with a gradient
// of g grey levels per px that is 4 g^2 / 255^2; the value is for g = 1.
constexpr float kLeastStrength = 6e-5F;
constexpr int kCornerBorder = 6;  // px of the half image
constexpr int kParts = 8;         // parts of the image across and down, to spread the corners
constexpr int kLeastKnown = 6;    // depths that must be known among a pixel and its neighbours
constexpr double kJump = 0.06;    // largest range of these depths, as a share of the least

struct Strong {
  float strength = 0;
  int x = 0, y = 0;  // of the half image
};

// The depth at a pixel, if it and most of its neighbours are known and lie on one surface.
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
  if (known < kLeastKnown || !(Z > 0) || most - least > static_cast<float>(kJump) * least)
    return std::nullopt;
  return static_cast<double>(Z);
}

// d(1/Z) per px of the depth image along (dx, dy); 0 where the surface ends or jumps.
double slope_along(const DepthImage& depth, int x, int y, int dx, int dy) {
  constexpr int kReach = 4;          // px to both sides
  constexpr double kSteepest = 0.3;  // difference of the depths there, as a share of the depth
  constexpr double kMostBend = 0.1;  // largest second difference of 1/Z, as a share of 1/Z
  const int x0 = x - kReach * dx, x1 = x + kReach * dx;
  const int y0 = y - kReach * dy, y1 = y + kReach * dy;
  if (x0 < 0 || y0 < 0 || x1 >= depth.width() || y1 >= depth.height()) return 0;
  const auto before = static_cast<double>(depth(x0, y0));
  const auto after = static_cast<double>(depth(x1, y1));
  const auto here = static_cast<double>(depth(x, y));
  if (!(before > 0 && after > 0)) return 0;
  const double bend = 1 / before + 1 / after - 2 / here;
  if (std::abs(after - before) > kSteepest * here || std::abs(bend) * here > kMostBend) return 0;
  return (1 / after - 1 / before) / (2 * kReach);
}

// Converts coordinates of the half image to those of the depth image.
struct DepthScale {
  double scale;
  [[nodiscard]] int operator()(int x) const { return static_cast<int>((x + 0.5) * scale); }
};

// The strongest corner of each cell that contains none of `taken`.
std::vector<Strong> strongest_of_cells(const cv::Mat& strength, const DepthImage& depth,
                                       const MaskImage* moving,
                                       std::span<const Eigen::Vector2d> taken, int cells_across,
                                       const DepthScale& depth_pixel) {
  const int width = strength.cols, height = strength.rows;
  const double cell = static_cast<double>(width) / cells_across;
  const int down = static_cast<int>(std::ceil(height / cell));
  const auto cell_of = [&](double x, double y) {
    const int cx = std::clamp(static_cast<int>(x / cell), 0, cells_across - 1);
    const int cy = std::clamp(static_cast<int>(y / cell), 0, down - 1);
    return cy * cells_across + cx;
  };
  std::vector<char> full(cells_across * down, 0);
  for (const Eigen::Vector2d& uv : taken) full[cell_of(uv.x() / 2, uv.y() / 2)] = 1;
  std::vector<Strong> best(full.size());
  for (int y = kCornerBorder; y < height - kCornerBorder; ++y) {
    const auto* row = strength.ptr<float>(y);
    for (int x = kCornerBorder; x < width - kCornerBorder; ++x) {
      if (row[x] < kLeastStrength) continue;
      const int c = cell_of(x, y);
      if (full[c] != 0 || row[x] <= best[c].strength) continue;
      const int dx = depth_pixel(x), dy = depth_pixel(y);
      if (moving != nullptr && !moving->empty() && (*moving)(dx, dy) != 0) continue;
      if (!depth_at(depth, dx, dy)) continue;
      best[c] = {row[x], x, y};
    }
  }
  return best;
}

}  // namespace

std::vector<Corner> new_corners(const GrayImage& half, const DepthImage& depth,
                                const MaskImage* moving, std::span<const Eigen::Vector2d> taken,
                                int cells_across, int most) {
  std::vector<Corner> corners;
  if (most <= 0 || half.width() <= 2 * kCornerBorder || half.height() <= 2 * kCornerBorder)
    return corners;
  cv::Mat strength;
  try {
    const cv::Mat image(half.height(), half.width(), CV_8UC1,
                        const_cast<std::uint8_t*>(half.data()));  // NOLINT: read only
    cv::cornerMinEigenVal(image, strength, kBlock);
  } catch (const cv::Exception&) { return corners; }

  const DepthScale depth_pixel{static_cast<double>(depth.width()) / half.width()};
  std::vector<Strong> best =
      strongest_of_cells(strength, depth, moving, taken, cells_across, depth_pixel);
  std::stable_sort(best.begin(), best.end(),
                   [](const Strong& a, const Strong& b) { return a.strength > b.strength; });
  std::array<int, kParts * kParts> of_part{};
  const int most_of_part = std::max(3, 2 * most / (kParts * kParts) + 1);
  for (const Strong& strong : best) {
    if (strong.strength <= 0 || static_cast<int>(corners.size()) >= most) break;
    int& count =
        of_part[strong.y * kParts / half.height() * kParts + strong.x * kParts / half.width()];
    if (count >= most_of_part) continue;
    ++count;
    const int dx = depth_pixel(strong.x), dy = depth_pixel(strong.y);
    Corner corner;
    corner.uv = {2.0 * strong.x, 2.0 * strong.y};
    corner.depth = depth_at(depth, dx, dy).value_or(0);
    const double per_full = depth_pixel.scale / 2;  // depth px per px of the full image
    corner.slope = per_full * Eigen::Vector2d(slope_along(depth, dx, dy, 1, 0),
                                              slope_along(depth, dx, dy, 0, 1));
    corners.push_back(corner);
  }
  return corners;
}

}  // namespace palpable
