#include "palpable/live/track/picture_turn.h"

#include "palpable/live/calibrate/rectification.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace palpable {
namespace {

constexpr int kEighth = 8;           // px of the full picture per px of the kept one
constexpr int kLargestShift = 16;    // px of the kept picture
constexpr int kSmallestSide = 16;    // px; smaller pictures show too little to be compared
constexpr double kLeastAlike = 0.5;  // correlation from which a shift counts as found

// Correlation of the parts of two pictures that overlap after a shift; 0 without contrast.
double correlation(const GrayImage& first, const GrayImage& later, int dx, int dy) {
  const int x0 = std::max(0, -dx), x1 = std::min(first.width(), first.width() - dx);
  const int y0 = std::max(0, -dy), y1 = std::min(first.height(), first.height() - dy);
  std::int64_t sum_a = 0, sum_b = 0, aa = 0, ab = 0, bb = 0;
  for (int y = y0; y < y1; ++y) {
    const std::uint8_t* a = first.row(y) + x0;
    const std::uint8_t* b = later.row(y + dy) + x0 + dx;
    std::int32_t row_a = 0, row_b = 0, row_aa = 0, row_ab = 0, row_bb = 0;  // < 2^31 to 33000 px
    for (int i = 0; i < x1 - x0; ++i) {
      const std::int32_t va = a[i], vb = b[i];
      row_a += va;
      row_b += vb;
      row_aa += va * va;
      row_ab += va * vb;
      row_bb += vb * vb;
    }
    sum_a += row_a;
    sum_b += row_b;
    aa += row_aa;
    ab += row_ab;
    bb += row_bb;
  }
  const double n = static_cast<double>(x1 - x0) * (y1 - y0);
  const double a = static_cast<double>(sum_a), b = static_cast<double>(sum_b);
  const double variances =
      (n * static_cast<double>(aa) - a * a) * (n * static_cast<double>(bb) - b * b);
  return variances > 0 ? (n * static_cast<double>(ab) - a * b) / std::sqrt(variances) : 0;
}

// The shift (dx, dy) of largest correlation between two pictures of one size: `later` at
// (x + dx, y + dy) shows what `first` shows at (x, y). Brightness and contrast do not matter.
// @param around, reach  shifts of up to `reach` px from `around` are tried, in x and in y
// @param least  correlation below which nothing is returned, -1..1
std::optional<Eigen::Vector2i> best_shift(const GrayImage& first, const GrayImage& later,
                                          const Eigen::Vector2i& around,
                                          const Eigen::Vector2i& reach, double least) {
  std::optional<Eigen::Vector2i> best;
  const int most_x = first.width() / 2, most_y = first.height() / 2;
  for (int dy = around.y() - reach.y(); dy <= around.y() + reach.y(); ++dy) {
    for (int dx = around.x() - reach.x(); dx <= around.x() + reach.x(); ++dx) {
      if (std::abs(dx) > most_x || std::abs(dy) > most_y) continue;
      const double alike = correlation(first, later, dx, dy);
      if (alike <= least) continue;
      least = alike;
      best = Eigen::Vector2i(dx, dy);
    }
  }
  return best;
}

}  // namespace

std::optional<Eigen::Matrix3d> PictureTurn::turn_to(const GrayImage& eighth,
                                                    const PinholeCamera& camera) {
  if (eighth.width() != kept_.width() || eighth.height() != kept_.height() ||
      std::min(eighth.width(), eighth.height()) < kSmallestSide) {
    return std::nullopt;
  }
  // All shifts are tried at half the size, and those around the best one at the full size.
  Rectification::halve(kept_, half_kept_);
  Rectification::halve(eighth, half_later_);
  const int reach = kLargestShift / 2;
  const auto coarse = best_shift(half_kept_, half_later_, {0, 0},
                                 {reach, std::min(reach, eighth.height() / 8)}, kLeastAlike);
  if (!coarse) return std::nullopt;
  const auto fine = best_shift(kept_, eighth, 2 * *coarse, {1, 1}, kLeastAlike);
  if (!fine) return std::nullopt;
  const Eigen::Vector2d middle(0.5 * camera.width, 0.5 * camera.height);
  const Eigen::Vector2d found = middle + kEighth * fine->cast<double>();
  return Eigen::Quaterniond::FromTwoVectors(camera.unproject(middle.x(), middle.y(), 1),
                                            camera.unproject(found.x(), found.y(), 1))
      .toRotationMatrix();
}

}  // namespace palpable
