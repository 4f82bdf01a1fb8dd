#include "palpable/live/render/fill_unknown.h"

#include <algorithm>
#include <cmath>

namespace palpable {

void fill_unknown(const DepthImage& depth, const MaskImage* borrowed, const PixelBox& box,
                  int radius, std::vector<signed char>& nearest_in_row,
                  std::vector<float>& filled) {
  PALPABLE_EXPECT(
      0 <= box.x && box.right() <= depth.width() && 0 <= box.y && box.bottom() <= depth.height(),
      "the box lies within the image");
  PALPABLE_EXPECT(borrowed == nullptr ||
                      (borrowed->width() == depth.width() && borrowed->height() == depth.height()),
                  "the mask of borrowed depths has the depth's size");
  PALPABLE_EXPECT(0 <= radius && radius < 64, "the radius fits a signed char");
  const int width = std::max(box.width, 0);
  const int height = std::max(box.height, 0);
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  filled.resize(at(0, height));
  nearest_in_row.resize(at(0, height));
  constexpr signed char kNone = 127;

  // Along rows: the offset to the nearest known pixel; of two equally near, the farther depth.
  for (int y = 0; y < height; ++y) {
    const float* in = depth.row(box.y + y) + box.x;
    const std::uint8_t* not_own = borrowed != nullptr ? borrowed->row(box.y + y) + box.x : nullptr;
    float* out = filled.data() + at(0, y);
    signed char* offset = nearest_in_row.data() + at(0, y);
    int last_known = -1000;
    for (int x = 0; x < width; ++x) {
      const bool known =
          in[x] > 0.0f && std::isfinite(in[x]) && (not_own == nullptr || not_own[x] == 0);
      out[x] = known ? in[x] : 0.0f;
      if (known) last_known = x;
      offset[x] = x - last_known <= radius ? static_cast<signed char>(last_known - x) : kNone;
    }
    int next_known = width + 1000;
    for (int x = width - 1; x >= 0; --x) {
      if (offset[x] == 0) next_known = x;
      const int ahead = next_known - x;
      if (ahead > radius || offset[x] == 0) continue;
      const bool nearer = offset[x] == kNone || ahead < -offset[x];
      const bool tie_farther =
          offset[x] != kNone && ahead == -offset[x] && out[next_known] > out[x + offset[x]];
      if (nearer || tie_farther) offset[x] = static_cast<signed char>(ahead);
    }
  }
  // Along columns: the nearest of the pixels found in the rows. `filled` can be read and written at
  // once, because all offsets lead to known pixels, which are not written.
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (nearest_in_row[at(x, y)] == 0) continue;
      int best = radius * radius + 1;
      float value = 0.0f;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); ++v) {
        const int dx = nearest_in_row[at(x, v)];
        if (dx == kNone) continue;
        const int distance = dx * dx + (v - y) * (v - y);
        const float candidate = filled[at(x + dx, v)];
        if (distance < best || (distance == best && candidate > value)) {
          best = distance;
          value = candidate;
        }
      }
      filled[at(x, y)] = value;
    }
  }
  // Runs that only the left eye sees get the depth on their left, even if another known pixel is
  // nearer. Offset 0 marks a known pixel.
  for (int y = 0; y < height; ++y) {
    float* out = filled.data() + at(0, y);
    signed char* offset = nearest_in_row.data() + at(0, y);
    int last_known = -1;
    for (int x = 0; x < width; ++x) {
      if (offset[x] != 0) continue;
      const int run = x - last_known - 1;
      if (last_known >= 0 && run > 0 && run <= kLongestHalfSeen &&
          out[last_known] > 1.1f * out[x]) {
        std::fill(out + last_known + 1, out + x, out[last_known]);
        std::fill(offset + last_known + 1, offset + x, kHalfSeen);
      }
      last_known = x;
    }
  }
}

}  // namespace palpable
