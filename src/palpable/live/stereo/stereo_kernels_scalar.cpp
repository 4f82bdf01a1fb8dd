// The matcher's loops, written like the formulas of stereo_kernels.h. Tests compare the vectorised
// loops with these.

#include "palpable/live/stereo/disparity_filters.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace palpable {
namespace {

constexpr int kCensusReach = 2;  // px from the middle of the census window to its sides

void census(const GrayImage& image, CensusCodes& codes, std::uint8_t* /*workspace*/) {
  const int width = image.width();
  const int height = image.height();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int centre = image(x, y);
      std::uint32_t code = 0;
      int bit = 0;
      for (int dy = -kCensusReach; dy <= kCensusReach; ++dy) {
        for (int dx = -kCensusReach; dx <= kCensusReach; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const int neighbour =
              image(std::clamp(x + dx, 0, width - 1), std::clamp(y + dy, 0, height - 1));
          if (neighbour + kCensusStep < centre) code |= 1U << bit;
          ++bit;
        }
      }
      for (std::size_t i = 0; i < codes.size(); ++i) {
        codes[i](x, y) = static_cast<std::uint8_t>(code >> (8 * i));
      }
    }
  }
}

std::uint32_t code_at(const CensusCodes& codes, int x, int y) {
  return codes[0](x, y) | static_cast<std::uint32_t>(codes[1](x, y)) << 8U |
         static_cast<std::uint32_t>(codes[2](x, y)) << 16U;
}

using Costs = std::vector<int>;  // (W x D): of one row

void costs_of_row(const MatchJob& job, int y, Costs& raw, Costs& costs) {
  const int width = (*job.left)[0].width();
  const int D = job.disparities;
  const auto at = [D](Costs& c, int x, int d) -> int& { return c[x * D + d]; };
  for (int x = 0; x < width; ++x) {
    const std::uint32_t left = code_at(*job.left, x, y);
    for (int d = 0; d < D; ++d) {
      const int partner = std::clamp(x - job.first - d, 0, width - 1);
      at(raw, x, d) = std::popcount(left ^ code_at(*job.right, partner, y));
    }
  }
  for (int x = 0; x < width; ++x) {
    for (int d = 0; d < D; ++d) {
      const int sides =
          (at(raw, std::max(x - 1, 0), d) + at(raw, std::min(x + 1, width - 1), d) + 1) / 2;
      at(costs, x, d) = (sides + at(raw, x, d) + 1) / 2;
    }
  }
}

// One step of a path, between pixels whose grey levels differ by `difference`. If `previous` is
// null the path starts here.
void step(const MatchJob& job, const int* cost, int difference, const int* previous, int* path) {
  const int D = job.disparities;
  if (previous == nullptr) {
    std::copy(cost, cost + D, path);
    return;
  }
  const int least = *std::min_element(previous, previous + D);
  const int p2 = job.penalties.p2_across(difference);
  for (int d = 0; d < D; ++d) {
    int best = std::min(previous[d], least + p2);
    if (d > 0) best = std::min(best, previous[d - 1] + job.penalties.p1);
    if (d + 1 < D) best = std::min(best, previous[d + 1] + job.penalties.p1);
    path[d] = cost[d] + best - least;
  }
}

void match(const MatchJob& job, int first_strip, int count, std::uint8_t* /*workspace*/) {
  const int width = (*job.left)[0].width();
  const int height = (*job.left)[0].height();
  const int D = job.disparities;
  const int row_size = width * D;
  Costs raw(row_size), costs(row_size), above(row_size), above_next(row_size), across(row_size),
      sum(row_size);
  const auto at = [D](Costs& c, int x) { return c.data() + x * D; };
  for (int strip = first_strip; strip < first_strip + count; ++strip) {
    const StripRows rows = rows_of_strip(strip, height);
    const int start = std::max(rows.begin - kWarmUpRows, 0);
    for (int y = start; y < rows.end; ++y) {
      costs_of_row(job, y, raw, costs);
      const std::uint8_t* grey = job.image->row(y);
      const std::uint8_t* grey_above = job.image->row(std::max(y - 1, 0));
      for (int x = 0; x < width; ++x) {
        step(job, at(costs, x), grey[x] - grey_above[x], y > start ? at(above, x) : nullptr,
             at(above_next, x));
      }
      above.swap(above_next);
      if (y < rows.begin) continue;
      sum = above;
      const auto add = [&](int x) {
        for (int d = 0; d < D; ++d) at(sum, x)[d] += at(across, x)[d];
      };
      for (int x = 0; x < width; ++x) {
        step(job, at(costs, x), grey[x] - grey[std::max(x - 1, 0)],
             x > 0 ? at(across, x - 1) : nullptr, at(across, x));
        add(x);
      }
      for (int x = width - 1; x >= 0; --x) {
        step(job, at(costs, x), grey[x] - grey[std::min(x + 1, width - 1)],
             x + 1 < width ? at(across, x + 1) : nullptr, at(across, x));
        add(x);
      }
      for (int x = 0; x < width; ++x) {
        const int* S = at(sum, x);
        const auto best = static_cast<int>(std::min_element(S, S + D) - S);
        job.winners->best(x, y) = static_cast<std::uint16_t>(best);
        job.winners->cost(x, y) = static_cast<std::uint8_t>(S[best]);
        job.winners->before(x, y) = best > 0 ? static_cast<std::uint8_t>(S[best - 1]) : 255;
        job.winners->after(x, y) = best + 1 < D ? static_cast<std::uint8_t>(S[best + 1]) : 255;
      }
    }
  }
}

void refine(const GrayImage& left, const GrayImage& right, int y_begin, int y_end, Disparities& d,
            std::uint8_t* /*workspace*/) {
  for (int y = y_begin; y < y_end; ++y) {
    for (int x = 0; x < d.width(); ++x) {
      if (!is_measured(d(x, y))) continue;
      const RefineWindow window(x, y, d(x, y), left.width(), left.height());
      if (!window.inside) continue;
      RefineSums sums;
      for (int i = 0; i < kRefineRows; ++i) {
        const std::uint8_t* L = left.row(window.top + i) + window.left;
        const std::uint8_t* R = right.row(window.top + i) + window.right;
        for (int j = 0; j < kRefineColumns; ++j) {
          const int g = L[j + 1] - L[j - 1];
          const int r = 64 * L[j] - (64 * R[j] + (R[j + 1] - R[j]) * window.fraction);
          sums.g += g;
          sums.r += r;
          sums.gg += g * g;
          sums.gr += g * r;
        }
      }
      d(x, y) = static_cast<std::int16_t>(d(x, y) + sums.step());
    }
  }
}

}  // namespace

int RefineSums::step() const {
  constexpr std::int64_t n = kRefineColumns * kRefineRows;
  // g is twice the gradient and r is 64 times the difference: their ratio is 1/32 full px = 1/64
  // half px.
  const auto covariance = static_cast<double>(n * gr - g * r);
  const auto variance = static_cast<double>(n * gg - g * g + 4 * n * kFlatness);
  const double moved = std::clamp(-covariance / variance, -1.0 * kLongestStep, 1.0 * kLongestStep);
  return static_cast<int>(moved < 0 ? moved - 0.5 : moved + 0.5);
}

void Winners::resize(int width, int height) {
  best.resize(width, height);
  cost.resize(width, height);
  before.resize(width, height);
  after.resize(width, height);
}

const StereoKernels& scalar_stereo_kernels() {
  static constexpr StereoKernels kernels{"scalar", census,     match,
                                         refine,   median_3x3, smooth_surfaces};
  return kernels;
}

}  // namespace palpable
