/// @file
/// Loops of disparity_filters.h that are compiled once for each instruction set
/// (stereo_kernels.cpp): always inlined, so that the compiler vectorises them with the instructions
/// of their caller.
#pragma once

#include "palpable/live/stereo/disparity_filters.h"

#include <algorithm>
#include <cstdint>

namespace palpable {

[[gnu::always_inline]] inline void median_3x3_loops(const Disparities& in, int y_begin, int y_end,
                                                    Disparities& out) {
  const int width = in.width();
  const int height = in.height();
  const auto sort = [](std::int16_t& a, std::int16_t& b) {
    const std::int16_t small = std::min(a, b);
    b = std::max(a, b);
    a = small;
  };
  for (int y = y_begin; y < y_end; ++y) {
    const std::int16_t* here = in.row(y);
    std::int16_t* to = out.row(y);
    if (y == 0 || y + 1 == height || width < 3) {
      std::copy(here, here + width, to);
      continue;
    }
    const std::int16_t* above = in.row(y - 1);
    const std::int16_t* below = in.row(y + 1);
    to[0] = here[0];
    to[width - 1] = here[width - 1];
    for (int x = 1; x + 1 < width; ++x) {
      const std::int16_t centre = here[x];
      const auto known = [centre](std::int16_t d) { return is_measured(d) ? d : centre; };
      std::int16_t a = known(above[x - 1]), b = known(above[x]), c = known(above[x + 1]);
      std::int16_t d = known(here[x - 1]), e = centre, f = known(here[x + 1]);
      std::int16_t g = known(below[x - 1]), h = known(below[x]), i = known(below[x + 1]);
      // The median of nine by 19 exchanges (Smith 1996).
      sort(b, c), sort(e, f), sort(h, i), sort(a, b), sort(d, e), sort(g, h), sort(b, c);
      sort(e, f), sort(h, i);
      d = std::max(a, d), f = std::min(f, i), sort(e, h);
      g = std::max(d, g), e = std::max(b, e), c = std::min(c, f);
      e = std::min(e, h), sort(e, c), e = std::max(g, e);
      to[x] = is_measured(centre) ? std::min(e, c) : centre;
    }
  }
}

[[gnu::always_inline]] inline void smooth_surfaces_loops(const Disparities& in, int y_begin,
                                                         int y_end, Disparities& out) {
  constexpr int kReach = 2;
  constexpr int kChunk = 128;  // columns at a time, so that the sums stay in the L1 cache
  const int width = in.width();
  const int height = in.height();
  std::int16_t sum[kChunk];
  std::int16_t count[kChunk];
  for (int y = y_begin; y < y_end; ++y) {
    const std::int16_t* here = in.row(y);
    for (int begin = 0; begin < width; begin += kChunk) {
      const int end = std::min(begin + kChunk, width);
      std::fill_n(sum, end - begin, std::int16_t{0});
      std::fill_n(count, end - begin, std::int16_t{0});
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, height - 1); ++v) {
        for (int i = -kReach; i <= kReach; ++i) {
          const std::int16_t* other = in.row(v) + i;
          const int from = std::max(begin, -i);
          const int to = std::min(end, width - i);
          for (int x = from; x < to; ++x) {
            // Differences wrap around. Because of kMostDisparities, those between a measured
            // disparity and the marks for unknown and too close are still large.
            const auto difference = static_cast<std::uint16_t>(other[x] - here[x]);
            const auto moved = static_cast<std::uint16_t>(difference + kSmoothStep);
            const auto near = static_cast<std::uint16_t>(moved <= 2 * kSmoothStep ? 0xffff : 0);
            sum[x - begin] = static_cast<std::int16_t>(sum[x - begin] + (difference & near));
            count[x - begin] = static_cast<std::int16_t>(count[x - begin] + (near & 1));
          }
        }
      }
      for (int x = begin; x < end; ++x) {
        const int n = count[x - begin];  // >= 1: the pixel itself
        const int twice = 2 * sum[x - begin];
        const int mean = (twice >= 0 ? twice + n : twice - n) / (2 * n);
        out(x, y) = is_measured(here[x]) ? static_cast<std::int16_t>(here[x] + mean) : here[x];
      }
    }
  }
}

}  // namespace palpable
