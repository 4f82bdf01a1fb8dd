// The refinement and the filters of stereo_kernels.h for all available vector instructions, with
// Google Highway: this file is compiled once for each instruction set.

// Enables AVX-512 with popcount of bytes. Must precede the first header of Highway.
#define HWY_WANT_AVX3_DL
#include "palpable/live/stereo/refine_kernels.h"

#include "palpable/live/stereo/disparity_filters.h"
#include "palpable/live/stereo/disparity_loops.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/stereo/refine_kernels.cpp"
// Highway requires this include before the next:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_REFINE_KERNELS_ONCE
#define PALPABLE_REFINE_KERNELS_ONCE
namespace palpable {
namespace {

#if HWY_ARCH_X86
static_assert(HWY_ATTAINABLE_AVX3_DL != 0,
              "HWY_WANT_AVX3_DL comes before the first header of Highway");
#endif

// The rows of sums that Refinement needs; a row has `stride` numbers, more than the image's width.
struct RefineMemory {
  std::size_t stride;
  std::int16_t *g, *l;  // kRefineRows rows each
  std::int16_t *column, *sum_g, *sum_l, *sum_r;
  std::int32_t *column_32, *sum_gg, *sum_gl;
  std::int32_t *of_g, *of_r, *of_gg, *of_gr;  // RefineSums of each pixel of the half image

  static constexpr std::size_t kRows_16 = 2 * kRefineRows + 4;
  static constexpr std::size_t kRows_32 = 3 + 4;
  static std::size_t stride_of(int width) {
    return (static_cast<std::size_t>(width) + 95) / 32 * 32;
  }
  static std::size_t bytes(int width) { return stride_of(width) * (2 * kRows_16 + 4 * kRows_32); }

  RefineMemory(int width, std::uint8_t* memory) : stride(stride_of(width)) {
    std::size_t used = 0;
    const auto reserve = [&](auto*& at, std::size_t rows) {
      using Number = std::remove_reference_t<decltype(*at)>;
      at = reinterpret_cast<Number*>(memory + used);  // NOLINT: raw, aligned memory
      used += rows * stride * sizeof(Number);
    };
    reserve(g, kRefineRows);
    reserve(l, kRefineRows);
    for (std::int16_t** row : {&column, &sum_g, &sum_l, &sum_r}) reserve(*row, 1);
    for (std::int32_t** row : {&column_32, &sum_gg, &sum_gl, &of_g, &of_r, &of_gg, &of_gr}) {
      reserve(*row, 1);
    }
  }
};

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
// For a processor without any of the vector instructions.
void refine(const GrayImage& left, const GrayImage& right, int y_begin, int y_end, Disparities& d,
            std::uint8_t* workspace) {
  scalar_stereo_kernels().refine(left, right, y_begin, y_end, d, workspace);
}
void median(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  median_3x3(in, y_begin, y_end, out);
}
void smooth(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  smooth_surfaces(in, y_begin, y_end, out);
}
#else

// With f the fraction, the sums over the window are
//
//     r  = sum 64 L - ((64 - f) sum R0 + f sum R1)         R1: R one column further right
//     gr = sum 64 g L - ((64 - f) sum g R0 + f sum g R1)
//
// All sums that do not pair L with R are computed for every window position at once: over the rows
// of each column, then over kRefineColumns columns. Only sum g R0 and sum g R1 must be computed for
// each pixel.
class Refinement {
 public:
  HWY_INLINE Refinement(const GrayImage& left, const GrayImage& right, std::uint8_t* memory)
      : left_(left), right_(right), at_(left.width(), memory) {}

  HWY_ATTR void row(int y, std::int16_t* d, int width) {
    const int top = RefineWindow::top_of(y);
    if (top < 0 || top + kRefineRows > left_.height()) return;
    // Rows that the window before this one also contained are already loaded.
    for (int v = std::max(top, next_); v < top + kRefineRows; ++v) load(v);
    next_ = top + kRefineRows;
    sum_columns(top);
    for (int i = 0; i < kRefineRows; ++i) {
      right_rows_[i] = right_.row(top + i);
      g_rows_[i] = g_row(top + i);
    }
    for (int x = 0; x < width; ++x) gather(x, y, d[x]);
    move(d, width);
  }

 private:
  [[nodiscard]] HWY_INLINE std::int16_t* g_row(int v) const {
    return at_.g + (v % kRefineRows) * at_.stride;
  }
  [[nodiscard]] HWY_INLINE std::int16_t* l_row(int v) const {
    return at_.l + (v % kRefineRows) * at_.stride;
  }
  HWY_ATTR void load(int v) {
    const std::uint8_t* L = left_.row(v);
    std::int16_t* g = g_row(v);
    std::int16_t* l = l_row(v);
    const int W = left_.width();
    for (int u = 0; u < W; ++u) l[u] = L[u];
    g[0] = g[W - 1] = 0;  // not part of any window
    for (int u = 1; u + 1 < W; ++u) g[u] = static_cast<std::int16_t>(L[u + 1] - L[u - 1]);
  }

  HWY_ATTR void sum_columns(int top) {
    const int W = left_.width();
    std::int16_t* column = at_.column;
    std::int32_t* column_32 = at_.column_32;
    const auto over_rows = [&](auto* sums, auto value) HWY_ATTR {
      for (int u = 0; u < W; ++u) sums[u] = value(u, top);
      for (int v = top + 1; v < top + kRefineRows; ++v) {
        for (int u = 0; u < W; ++u) {
          sums[u] = static_cast<std::remove_reference_t<decltype(*sums)>>(sums[u] + value(u, v));
        }
      }
    };
    const auto over_columns = [&](auto* sums, const auto* of_columns) HWY_ATTR {
      static_assert(kRefineColumns == 8);
      for (int u = 0; u + kRefineColumns <= W; ++u) {
        const auto* c = of_columns + u;
        sums[u] = static_cast<std::remove_reference_t<decltype(*sums)>>(c[0] + c[1] + c[2] + c[3] +
                                                                        c[4] + c[5] + c[6] + c[7]);
      }
    };
    over_rows(column, [&](int u, int v) HWY_ATTR { return l_row(v)[u]; });
    over_columns(at_.sum_l, column);
    over_rows(column, [&](int u, int v) HWY_ATTR { return g_row(v)[u]; });
    over_columns(at_.sum_g, column);
    over_rows(column,
              [&](int u, int v) HWY_ATTR { return static_cast<std::int16_t>(right_.row(v)[u]); });
    over_columns(at_.sum_r, column);
    over_rows(column_32,
              [&](int u, int v) HWY_ATTR { return std::int32_t{g_row(v)[u]} * g_row(v)[u]; });
    over_columns(at_.sum_gg, column_32);
    over_rows(column_32,
              [&](int u, int v) HWY_ATTR { return std::int32_t{g_row(v)[u]} * l_row(v)[u]; });
    over_columns(at_.sum_gl, column_32);
  }

  // Computes the RefineSums of pixel x; zeros if it is not to be changed.
  HWY_INLINE void gather(int x, int y, std::int16_t d) {
    at_.of_g[x] = at_.of_r[x] = at_.of_gg[x] = at_.of_gr[x] = 0;
    if (!is_measured(d)) return;
    const RefineWindow window(x, y, d, left_.width(), left_.height());
    if (!window.inside) return;
    const hn::FixedTag<std::uint8_t, 8> d8;
    const hn::FixedTag<std::int16_t, 8> d16;
    const hn::FixedTag<std::int32_t, 4> d32;
    auto sum_0 = hn::Zero(d32), sum_1 = sum_0, rest_0 = sum_0, rest_1 = sum_0;
    for (std::size_t i = 0; i < kRefineRows; ++i) {
      const std::uint8_t* R = right_rows_[i] + window.right;
      const auto g = hn::LoadU(d16, g_rows_[i] + window.left);
      const auto R0 = hn::PromoteTo(d16, hn::LoadU(d8, R));
      const auto R1 = hn::PromoteTo(d16, hn::LoadU(d8, R + 1));
      sum_0 = hn::ReorderWidenMulAccumulate(d32, g, R0, sum_0, rest_0);
      sum_1 = hn::ReorderWidenMulAccumulate(d32, g, R1, sum_1, rest_1);
    }
    const int f = window.fraction;
    const auto weighted =
        hn::Add(hn::Mul(hn::Add(sum_0, rest_0), hn::Set(d32, kDisparitySteps - f)),
                hn::Mul(hn::Add(sum_1, rest_1), hn::Set(d32, f)));
    const std::int32_t gr = hn::GetLane(hn::SumOfLanes(d32, weighted));
    const std::int16_t* R = at_.sum_r + window.right;
    at_.of_g[x] = at_.sum_g[window.left];
    at_.of_r[x] =
        kDisparitySteps * at_.sum_l[window.left] - (kDisparitySteps - f) * R[0] - f * R[1];
    at_.of_gg[x] = at_.sum_gg[window.left];
    at_.of_gr[x] = kDisparitySteps * at_.sum_gl[window.left] - gr;
  }

  // RefineSums::step() for all pixels. Every product is an integer below 2^53, so that only the
  // quotient is rounded, as in RefineSums::step().
  HWY_ATTR void move(std::int16_t* d, int width) const {
    const hn::ScalableTag<double> df;
    const hn::Rebind<std::int32_t, decltype(df)> di;
    const auto n = hn::Set(df, kRefineColumns * kRefineRows);
    const auto flat = hn::Set(df, 4.0 * kRefineColumns * kRefineRows * kFlatness);
    const auto longest = hn::Set(df, kLongestStep);
    const auto half = hn::Set(df, 0.5);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
      const auto sum = [&](const std::int32_t* row)
                           HWY_ATTR { return hn::PromoteTo(df, hn::LoadU(di, row + x)); };
      const auto g = sum(at_.of_g);
      const auto r = sum(at_.of_r);
      const auto covariance = hn::Sub(hn::Mul(n, sum(at_.of_gr)), hn::Mul(g, r));
      const auto variance = hn::Add(hn::Sub(hn::Mul(n, sum(at_.of_gg)), hn::Mul(g, g)), flat);
      const auto step = hn::Div(hn::Neg(covariance), variance);
      const auto cut = hn::Min(hn::Max(step, hn::Neg(longest)), longest);
      hn::StoreU(hn::DemoteTo(di, hn::Add(cut, hn::CopySign(half, cut))), di, at_.of_g + x);
    }
    for (int x = 0; x < width; ++x) d[x] = static_cast<std::int16_t>(d[x] + at_.of_g[x]);
  }

  const GrayImage& left_;
  const GrayImage& right_;
  RefineMemory at_;
  const std::uint8_t* right_rows_[kRefineRows] = {};
  const std::int16_t* g_rows_[kRefineRows] = {};
  int next_ = 0;
};

HWY_ATTR void median(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  median_3x3_loops(in, y_begin, y_end, out);
}
HWY_ATTR void smooth(const Disparities& in, int y_begin, int y_end, Disparities& out) {
  smooth_surfaces_loops(in, y_begin, y_end, out);
}

HWY_ATTR void refine(const GrayImage& left, const GrayImage& right, int y_begin, int y_end,
                     Disparities& d, std::uint8_t* workspace) {
  Refinement refinement(left, right, workspace);
  for (int y = y_begin; y < y_end; ++y) refinement.row(y, d.row(y), d.width());
}

#endif  // HWY_SCALAR

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace palpable {
namespace {
HWY_EXPORT(refine);
HWY_EXPORT(median);
HWY_EXPORT(smooth);
}  // namespace

RefineKernels chosen_refine_kernels() {
  return {&HWY_DYNAMIC_DISPATCH(refine), &HWY_DYNAMIC_DISPATCH(median),
          &HWY_DYNAMIC_DISPATCH(smooth)};
}

std::size_t refine_workspace_bytes(int width) { return RefineMemory::bytes(width); }

}  // namespace palpable

#endif
