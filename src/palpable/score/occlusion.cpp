#include "palpable/score/occlusion.h"

#include "palpable/base/contract.h"

#include <cmath>

namespace palpable {

MaskOverlap compare_visible(const MaskImage& visible, const DepthImage& body_depth,
                            const DepthImage& true_depth) {
  const int width = body_depth.width();
  const int height = body_depth.height();
  PALPABLE_EXPECT(true_depth.width() == width && true_depth.height() == height,
                  "both depths have one size");
  const bool same = visible.width() == width && visible.height() == height;
  const bool twice = visible.width() == 2 * width && visible.height() == 2 * height;
  PALPABLE_EXPECT(same || twice, "the mask is as large as the depths, or twice");

  MaskOverlap overlap;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool drawn = false;
      if (same) {
        drawn = visible(x, y) != 0;
      } else {
        const int set = (visible(2 * x, 2 * y) != 0) + (visible(2 * x + 1, 2 * y) != 0) +
                        (visible(2 * x, 2 * y + 1) != 0) + (visible(2 * x + 1, 2 * y + 1) != 0);
        drawn = set >= 2;
      }
      const float body = body_depth(x, y);
      const bool has_body = !std::isnan(body);
      const bool hidden = has_body && true_depth(x, y) < body;  // false for NaN
      const bool truly = has_body && !hidden;
      overlap.both += drawn && truly;
      overlap.either += drawn || truly;
      overlap.body += has_body;
      overlap.hidden += hidden;
    }
  }
  return overlap;
}

}  // namespace palpable
