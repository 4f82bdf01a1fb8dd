#include "palpable/render/outlines.h"

#include "palpable/base/contract.h"
#include "palpable/render/outline_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr float kNothing = 1e-3f;  // a sum of weights below this counts as none

// Lattice pixels of a window in one row, rounded up to whole vector registers.
constexpr int kWindowColumns = OutlineWindow::kColumns;
static_assert(kWindowColumns >= 2 * RealOutlines::kWindow / RealOutlines::kLatticeStep + 1);

constexpr float kFactor = 1 + RealOutlines::kJump;

float total(const OutlineLanes& lanes) {
  float sum = 0;
  for (const float value : lanes) sum += value;
  return sum;
}

}  // namespace

void RealOutlines::find(const ColorImage& picture, const PixelRange& box,
                        std::span<const float> depth, std::span<const signed char> guessed,
                        const PixelRange& inner) {
  PALPABLE_EXPECT(
      box.x0 >= 0 && box.y0 >= 0 && 2 * box.x1 <= picture.width() && 2 * box.y1 <= picture.height(),
      "the picture is twice as large as the depth image");
  PALPABLE_EXPECT(box.x0 <= inner.x0 && inner.x0 <= inner.x1 && inner.x1 <= box.x1 &&
                      box.y0 <= inner.y0 && inner.y0 <= inner.y1 && inner.y1 <= box.y1,
                  "the inner box lies within the other");
  w_ = box.width();
  h_ = box.height();
  const std::size_t count = at(0, h_);
  PALPABLE_EXPECT(depth.size() >= count && guessed.size() >= count, "depth and guesses fill a box");
  z_.assign(depth.begin(), depth.begin() + static_cast<std::ptrdiff_t>(count));
  average_colors(picture, box);
  find_doubts(guessed);
  build_lattice();
  const PixelRange own{inner.x0 - box.x0, inner.y0 - box.y0, inner.x1 - box.x0, inner.y1 - box.y0};
  decide(own);
  smooth(own);
  write_fine(picture, box, own);
}

void RealOutlines::average_colors(const ColorImage& picture, const PixelRange& box) {
  color_.resize(at(0, h_));
  for (int y = 0; y < h_; ++y) {
    const Rgb* upper = picture.row(2 * (box.y0 + y)) + 2 * box.x0;
    const Rgb* lower = picture.row(2 * (box.y0 + y) + 1) + 2 * box.x0;
    Color* to = color_.data() + at(0, y);
    for (int x = 0; x < w_; ++x) {
      const Rgb &a = upper[2 * x], &b = upper[2 * x + 1], &c = lower[2 * x], &d = lower[2 * x + 1];
      to[x] = {0.25f * static_cast<float>(a.r + b.r + c.r + d.r),
               0.25f * static_cast<float>(a.g + b.g + c.g + d.g),
               0.25f * static_cast<float>(a.b + b.b + c.b + d.b)};
    }
  }
}

void RealOutlines::find_doubts(std::span<const signed char> guessed) {
  doubt_.assign(at(0, h_), 0);
  // Compares each pixel with the one at (dx, dy) from it. Branch-free, so that it is vectorised.
  const auto compare = [&](int dx, int dy, const auto& doubtful) {
    const int first = std::max(-dx, 0);
    const int last = w_ - std::max(dx, 0);
    for (int y = std::max(-dy, 0); y < h_ - std::max(dy, 0); ++y) {
      const float* z = z_.data() + at(0, y);
      const float* other_z = z_.data() + at(first + dx, y + dy) - first;
      const signed char* other_guessed = guessed.data() + at(first + dx, y + dy) - first;
      std::uint8_t* doubt = doubt_.data() + at(0, y);
      for (int x = first; x < last; ++x) {
        doubt[x] =
            static_cast<std::uint8_t>(doubt[x] | doubtful(z[x], other_z[x], other_guessed[x] != 0));
      }
    }
  };
  const auto farther = [](float z, float other, bool guess) {
    return static_cast<int>(other > kFactor * z) | static_cast<int>(guess);
  };
  const auto nearer = [](float z, float other, bool) {
    return static_cast<int>(z > kFactor * other);
  };
  for (int i = 1; i <= kDoubtLeft; ++i) compare(-i, 0, farther);
  for (int i = 1; i <= kDoubtRight; ++i) compare(i, 0, farther);
  for (int i = 1; i <= kDoubtAcross; ++i) {
    compare(0, -i, farther);
    compare(0, i, farther);
  }
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx != 0 || dy != 0) compare(dx, dy, nearer);
    }
  }
  for (std::size_t i = 0; i < doubt_.size(); ++i) {
    doubt_[i] |= static_cast<std::uint8_t>(guessed[i] != 0 || !(z_[i] > 0.0f));
  }
}

void RealOutlines::build_lattice() {
  Lattice& l = lattice_;
  l.width = (w_ + kLatticeStep - 1) / kLatticeStep + kWindowColumns;
  l.height = (h_ + kLatticeStep - 1) / kLatticeStep;
  const auto count = static_cast<std::size_t>(l.width) * static_cast<std::size_t>(l.height);
  for (std::vector<float>* plane : {&l.sure, &l.r, &l.g, &l.b, &l.inverse}) {
    plane->assign(count, 0.0f);
  }
  for (int v = 0; v < l.height; ++v) {
    const auto row = static_cast<std::size_t>(v) * static_cast<std::size_t>(l.width);
    for (int u = 0; u * kLatticeStep < w_; ++u) {
      const std::size_t from = at(u * kLatticeStep, v * kLatticeStep);
      if (doubt_[from] != 0) continue;
      const std::size_t to = row + static_cast<std::size_t>(u);
      l.sure[to] = 1.0f;
      l.r[to] = color_[from].r;
      l.g[to] = color_[from].g;
      l.b[to] = color_[from].b;
      l.inverse[to] = 1.0f / z_[from];
    }
  }
}

RealOutlines::Verdict RealOutlines::of_window(int x, int y) const {
  const Lattice& l = lattice_;
  const int u0 = std::max((x - kWindow + kLatticeStep - 1) / kLatticeStep, 0);
  const int v0 = std::max((y - kWindow + kLatticeStep - 1) / kLatticeStep, 0);
  const int v1 = std::min((y + kWindow) / kLatticeStep, l.height - 1);
  const std::size_t first = static_cast<std::size_t>(v0) * static_cast<std::size_t>(l.width) +
                            static_cast<std::size_t>(u0);
  const Color c = color_[at(x, y)];
  const OutlineWindow window{.sure = l.sure.data() + first,
                             .r = l.r.data() + first,
                             .g = l.g.data() + first,
                             .b = l.b.data() + first,
                             .inverse = l.inverse.data() + first,
                             .stride = static_cast<std::size_t>(l.width),
                             .rows = v1 - v0 + 1,
                             .dx = static_cast<float>(u0 * kLatticeStep - x),
                             .dy = static_cast<float>(v0 * kLatticeStep - y),
                             .step = kLatticeStep,
                             .red = c.r,
                             .green = c.g,
                             .blue = c.b};
  const OutlineKernels& kernels = outline_kernels().front();
  const OutlineRange range = kernels.range(window);
  const float low = *std::min_element(range.low.begin(), range.low.end());
  const float high = *std::max_element(range.high.begin(), range.high.end());
  Verdict verdict;
  verdict.parted = high > kFactor * low;
  if (!verdict.parted) return verdict;
  const float split = verdict.split = 0.5f * (low + high);
  const OutlineSums sums = kernels.sums(window, split);
  const float near_weight = total(sums.near_weight),
              far_weight = total(sums.all_weight) - near_weight;
  verdict.parted = near_weight > kNothing && far_weight > kNothing;
  if (!verdict.parted) return verdict;
  const float near_fit = total(sums.near_fit), near_inverse = total(sums.near_inverse);
  verdict.near_fit = near_fit / near_weight;
  verdict.far_fit = (total(sums.all_fit) - near_fit) / far_weight;
  verdict.near_depth = near_weight / near_inverse;
  verdict.far_depth = far_weight / (total(sums.all_inverse) - near_inverse);
  return verdict;
}

void RealOutlines::decide(const PixelRange& inner) {
  decided_ = z_;
  for (int y = inner.y0; y < inner.y1; ++y) {
    for (int x = inner.x0; x < inner.x1; ++x) {
      const std::size_t i = at(x, y);
      if (doubt_[i] == 0) continue;
      const Verdict verdict = of_window(x, y);
      if (!verdict.parted) continue;
      const bool is_near = verdict.near_fit >= verdict.far_fit;
      const bool known = z_[i] > 0.0f;
      const bool was_near = known && z_[i] * verdict.split < 1.0f;
      if (known && is_near == was_near) continue;
      decided_[i] = is_near ? verdict.near_depth : verdict.far_depth;
    }
  }
  std::swap(z_, decided_);
}

void RealOutlines::smooth(const PixelRange& inner) {
  decided_ = z_;
  for (int y = std::max(inner.y0, 1); y < std::min(inner.y1, h_ - 1); ++y) {
    for (int x = std::max(inner.x0, 1); x < std::min(inner.x1, w_ - 1); ++x) {
      if (doubt_[at(x, y)] == 0) continue;
      std::array<float, 9> nine{};
      for (int v = 0; v < 3; ++v) {
        std::copy_n(decided_.begin() + static_cast<std::ptrdiff_t>(at(x - 1, y - 1 + v)), 3,
                    nine.begin() + 3 * v);
      }
      std::nth_element(nine.begin(), nine.begin() + 4, nine.end());
      z_[at(x, y)] = nine[4];
    }
  }
}

void RealOutlines::write_fine(const ColorImage& picture, const PixelRange& box,
                              const PixelRange& inner) {
  constexpr int kReach = 2;  // px of the depth image: the colours of a side are those this near
  const std::size_t stride = 2 * static_cast<std::size_t>(inner.width());
  fine_.resize(stride * 2 * static_cast<std::size_t>(inner.height()));
  for (int y = inner.y0; y < inner.y1; ++y) {
    for (int x = inner.x0; x < inner.x1; ++x) {
      const float z = z_[at(x, y)];
      float* upper =
          fine_.data() + static_cast<std::size_t>(2 * (y - inner.y0)) * stride + 2 * (x - inner.x0);
      float* lower = upper + stride;
      upper[0] = upper[1] = lower[0] = lower[1] = z;
      if (x < kReach || y < kReach || x + kReach >= w_ || y + kReach >= h_ || !(z > 0.0f)) continue;
      float low = z, high = z;
      for (const std::size_t i : {at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)}) {
        if (!(z_[i] > 0.0f)) continue;
        low = std::min(low, z_[i]);
        high = std::max(high, z_[i]);
      }
      if (!(high > kFactor * low)) continue;
      const float split = 0.5f / low + 0.5f / high;  // 1/m; `low` and `high` lie on either side
      std::array<Color, 2> mean{};
      std::array<float, 2> count{};
      for (int v = y - kReach; v <= y + kReach; ++v) {
        for (int u = x - kReach; u <= x + kReach; ++u) {
          const float other = z_[at(u, v)];
          if (!(other > 0.0f)) continue;
          const std::size_t side = split * other < 1.0f ? 0 : 1;
          const Color& c = color_[at(u, v)];
          mean[side].r += c.r;
          mean[side].g += c.g;
          mean[side].b += c.b;
          count[side] += 1;
        }
      }
      const auto away = [&](const Rgb& c, std::size_t side) {
        const float r = static_cast<float>(c.r) - mean[side].r / count[side];
        const float g = static_cast<float>(c.g) - mean[side].g / count[side];
        const float b = static_cast<float>(c.b) - mean[side].b / count[side];
        return r * r + g * g + b * b;
      };
      for (int k = 0; k < 4; ++k) {
        const Rgb& c = picture(2 * (box.x0 + x) + k % 2, 2 * (box.y0 + y) + k / 2);
        float* row = k < 2 ? upper : lower;
        row[k % 2] = away(c, 0) <= away(c, 1) ? low : high;
      }
    }
  }
}

}  // namespace palpable
