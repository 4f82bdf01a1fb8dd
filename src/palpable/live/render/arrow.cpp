#include "palpable/live/render/arrow.h"

#include "palpable/live/render/mix_color.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr float kRim = 1.5f;  // px
constexpr Rgb kRimColor{24, 26, 30};
constexpr float kHeadLength = 3.2f;     // ratio to the shaft's width
constexpr float kHeadHalfWidth = 1.5f;  // likewise

}  // namespace

void draw_arrow(ColorImage& picture, const Eigen::Vector2f& tail, const Eigen::Vector2f& tip,
                float width, Rgb color) {
  if (!tail.allFinite() || !tip.allFinite()) return;
  const float length = std::max((tip - tail).norm(), 1e-3f);
  const Eigen::Vector2f along = (tip - tail) / length;
  const float head = std::min(kHeadLength * width, length);
  const float half_head = kHeadHalfWidth * width;
  const float reach = half_head + kRim + 1.0f;
  const auto bound = [](float value, int size) {
    return static_cast<int>(std::clamp(value, 0.0f, static_cast<float>(size)));
  };
  const int x0 = bound(std::min(tail.x(), tip.x()) - reach, picture.width());
  const int x1 = bound(std::max(tail.x(), tip.x()) + reach + 1.0f, picture.width());
  const int y0 = bound(std::min(tail.y(), tip.y()) - reach, picture.height());
  const int y1 = bound(std::max(tail.y(), tip.y()) + reach + 1.0f, picture.height());
  // Factor from a distance perpendicular to the arrow to one perpendicular to the head's side.
  const float side = head / std::hypot(head, half_head);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const Eigen::Vector2f p(static_cast<float>(x) - tail.x(), static_cast<float>(y) - tail.y());
      const float a = p.dot(along);                                     // px along the arrow
      const float b = std::abs(p.x() * along.y() - p.y() * along.x());  // px across it
      // Distances outside of shaft and head, px; negative inside.
      const float of_shaft = std::max({b - 0.5f * width, -a, a - (length - 0.5f * head)});
      const float from_tip = length - a;
      const float of_head =
          std::max({(b - half_head * from_tip / head) * side, from_tip - head, -from_tip});
      const float outside = std::min(of_shaft, of_head);
      const float rim = std::clamp(kRim + 0.5f - outside, 0.0f, 1.0f);
      if (rim == 0.0f) continue;
      Rgb& pixel = picture(x, y);
      mix_color(pixel, kRimColor, 0.7f * rim);
      mix_color(pixel, color, std::clamp(0.5f - outside, 0.0f, 1.0f));
    }
  }
}

}  // namespace palpable
