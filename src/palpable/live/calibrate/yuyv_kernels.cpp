// Compiled once for each set of vector instructions. All numbers are integers, so that every
// version gives the same result.
//
// Eight pixels of a row, a step, lie on a straight line in the raw picture, nearly along its rows.
// All pixels that they need are among 16 pixels of two or three rows, which are loaded as whole
// vectors and selected by a shuffle. (Gather instructions take three times as long on processors
// with a mitigation against leaks of gathered data.) Steps that need more are computed by the
// scalar version.

#include "palpable/live/calibrate/yuyv_kernels.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/simd_targets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/calibrate/yuyv_kernels.cpp"
// Highway requires this include before the next:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_YUYV_KERNELS_ONCE
#define PALPABLE_YUYV_KERNELS_ONCE
namespace palpable {
namespace {

constexpr int kStep = WarpGrid::kStep;
constexpr int kPairs = kStep / 2;  // pairs of pixels in a step
constexpr int kOne = WarpGrid::kOne;
constexpr int kShift = 16;   // kOne = 1 << kShift
constexpr int kLoaded = 16;  // pixels of a row that are loaded for a step
constexpr int kLoadedPairs = kLoaded / 2;
constexpr int kMostRows = 5;  // largest number of rows of a step, which slopes in the corners

// Luma is interpolated with weights in 1/32 along x and y, so the sum is 1024 times the luma. The
// factor 255 / 219 is kStretch / 1024.
constexpr int kFine = 5;
constexpr int kBlack = 16 << (2 * kFine);
constexpr int kStretch = 1192;
constexpr int kLumaShift = 2 * kFine + 10;
constexpr int kLumaHalf = 1 << (kLumaShift - 1);

// U and V are interpolated with weights in 1/64, so the sum is 64 times their value. The constants
// are BT.601's coefficients times 2048: the upper half of (2 x sum x constant) is then 4 times the
// contribution of U or V.
constexpr int kPairFine = 6;
constexpr int kGrey = 128 << kPairFine;
constexpr int kRedOfV = 3269;     // 1.596
constexpr int kGreenOfU = -803;   // -0.392
constexpr int kGreenOfV = -1665;  // -0.813
constexpr int kBlueOfU = 4131;    // 2.017

// The positions of a step's pixels in the raw picture.
struct Line {
  const std::int32_t* x;  // two entries of the grid
  const std::int32_t* y;
  const WarpGrid::Step* step;
};
Line line_of(const WarpGrid& grid, int row, int step) {
  const std::size_t at = static_cast<std::size_t>(row) * grid.columns + step;
  return {grid.x.data() + at, grid.y.data() + at, grid.steps.data() + at};
}
int on_line(const std::int32_t* ends, int i) { return ends[0] + (((ends[1] - ends[0]) * i) >> 3); }
// The position of pair i; the middle of a pair is half a pixel to the right of its first pixel.
int pair_on_line(const std::int32_t* ends, int i) {
  return ends[0] + (((ends[1] - ends[0]) * (4 * i + 1)) >> 4);
}
int pair_position(const std::int32_t* ends, int i) {
  return (pair_on_line(ends, i) - kOne / 2) >> 1;
}

// The pixel before a coordinate, and the share of the next one: 0 .. 1 << bits.
struct Between {
  int first;
  int share;
};
Between between(int at, int count, int bits) {
  const int inside = std::clamp(at, 0, (count - 1) * kOne);
  const int first = std::min(inside >> kShift, count - 2);
  return {first, (inside - first * kOne) >> (kShift - bits)};
}

const Yuyv* row_of(const YuyvEye& eye, int y) {
  return eye.first + static_cast<std::size_t>(y) * eye.row_pairs;
}

// The row from which a step's colours are taken.
int color_row(const Line& line, int height) {
  return std::clamp((on_line(line.y, kPairs) + kOne / 2) >> kShift, 0, height - 1);
}

int luma_of(const Yuyv* row, int x) { return (x & 1) != 0 ? row[x / 2].y1 : row[x / 2].y0; }

std::uint8_t to_byte(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

void plain_luma_step(const Line& line, const YuyvEye& eye, std::uint8_t* to, int count) {
  for (int i = 0; i < count; ++i) {
    const Between x = between(on_line(line.x, i), eye.width, kFine);
    const Between y = between(on_line(line.y, i), eye.height, kFine);
    const auto along = [&](const Yuyv* row) {
      const int a = luma_of(row, x.first), b = luma_of(row, x.first + 1);
      return (a << kFine) + (b - a) * x.share;
    };
    const int upper = along(row_of(eye, y.first)), lower = along(row_of(eye, y.first + 1));
    const int sum = (upper << kFine) + (lower - upper) * y.share;
    to[i] = to_byte(((sum - kBlack) * kStretch + kLumaHalf) >> kLumaShift);
  }
}

void plain_color_step(const Line& line, const YuyvEye& eye, const std::uint8_t* luma, Rgb* to,
                      int count) {
  const Yuyv* row = row_of(eye, color_row(line, eye.height));
  const auto product = [](int a, int b) { return (2 * a * b) >> 16; };
  for (int i = 0; i < count; ++i) {
    const Between x = between(pair_position(line.x, i / 2), eye.width / 2, kPairFine);
    const Yuyv &a = row[x.first], &b = row[x.first + 1];
    const int U = (a.u << kPairFine) + (b.u - a.u) * x.share - kGrey;
    const int V = (a.v << kPairFine) + (b.v - a.v) * x.share - kGrey;
    const int red = (product(V, kRedOfV) + 2) >> 2;
    const int green = (product(U, kGreenOfU) + product(V, kGreenOfV) + 2) >> 2;
    const int blue = (product(U, kBlueOfU) + 2) >> 2;
    to[i] = {to_byte(luma[i] + red), to_byte(luma[i] + green), to_byte(luma[i] + blue)};
  }
}

void plain_luma(const WarpGrid& grid, const YuyvEye& eye, GrayImage& warped) {
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; u += kStep) {
      plain_luma_step(line_of(grid, v, u / kStep), eye, warped.row(v) + u,
                      std::min(kStep, grid.width - u));
    }
  }
}

void plain_color(const WarpGrid& grid, const YuyvEye& eye, const GrayImage& luma,
                 ColorImage& warped) {
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; u += kStep) {
      plain_color_step(line_of(grid, v, u / kStep), eye, luma.row(v) + u, warped.row(v) + u,
                       std::min(kStep, grid.width - u));
    }
  }
}

// The range of a coordinate along a line, which is between the values at its ends.
struct Reach {
  int least;
  int most;
  [[nodiscard]] bool within(int count) const { return least >= 0 && most < (count - 1) * kOne; }
  [[nodiscard]] int first() const { return least >> kShift; }
  [[nodiscard]] int last() const { return (most >> kShift) + 1; }
};
Reach reach(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

WarpGrid::Step step_of(const Line& line, int width, int height) {
  WarpGrid::Step step;
  const Reach x = reach(on_line(line.x, 0), on_line(line.x, kStep - 1));
  const Reach y = reach(on_line(line.y, 0), on_line(line.y, kStep - 1));
  const int begin = std::min(x.first(), width - kLoaded);
  const int rows = y.last() - y.first() + 1;
  if (begin >= 0 && x.within(width) && x.last() < begin + kLoaded && y.within(height) &&
      rows <= kMostRows) {
    step.luma_begin = static_cast<std::int16_t>(begin);
    step.luma_row = static_cast<std::int16_t>(y.first());
    step.luma_rows = static_cast<std::int8_t>(rows);
  }
  const Reach pairs = reach(pair_position(line.x, 0), pair_position(line.x, kPairs - 1));
  const int pair_begin = std::min(pairs.first(), width / 2 - kLoadedPairs);
  if (pair_begin >= 0 && pairs.within(width / 2) && pairs.last() < pair_begin + kLoadedPairs) {
    step.color_begin = static_cast<std::int16_t>(pair_begin);
    step.color_row = static_cast<std::int16_t>(color_row(line, height));
    step.color_rows = 1;
  }
  return step;
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR
void luma(const WarpGrid& grid, const YuyvEye& eye, GrayImage& warped) {
  plain_luma(grid, eye, warped);
}
void color(const WarpGrid& grid, const YuyvEye& eye, const GrayImage& luma_of_eye,
           ColorImage& warped) {
  plain_color(grid, eye, luma_of_eye, warped);
}
#else
namespace hn = hwy::HWY_NAMESPACE;

using Ints = hn::CappedTag<std::int32_t, kStep>;
using Bytes = hn::FixedTag<std::uint8_t, 16>;
using HalfBytes = hn::FixedTag<std::uint8_t, 8>;
using Shorts = hn::FixedTag<std::int16_t, 8>;
using FourInts = hn::FixedTag<std::int32_t, 4>;

// As Between, for several coordinates that lie within the picture.
template <class D>
struct BetweenVector {
  hn::Vec<D> first;
  hn::Vec<D> share;
};
template <int kBits, class D>
HWY_INLINE BetweenVector<D> between_all(D d, hn::Vec<D> at) {
  return {hn::ShiftRight<kShift>(at),
          hn::And(hn::ShiftRight<kShift - kBits>(at), hn::Set(d, (1 << kBits) - 1))};
}

// The bytes with even index (0, 2, 4, ...) of 32 bytes.
HWY_INLINE hn::Vec<Bytes> even_bytes(const void* from) {
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  const auto half = [&](const std::uint8_t* at) HWY_ATTR {
    const auto pairs = hn::BitCast(Shorts(), hn::LoadU(Bytes(), at));
    return hn::DemoteTo(HalfBytes(), hn::And(pairs, hn::Set(Shorts(), 0xFF)));
  };
  return hn::Combine(Bytes(), half(bytes + 16), half(bytes));
}
// The bytes with odd index (1, 3, 5, ...) of 32 bytes.
HWY_INLINE hn::Vec<Bytes> odd_bytes(const void* from) {
  const hn::RebindToUnsigned<Shorts> d;
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  const auto half = [&](const std::uint8_t* at) HWY_ATTR {
    const auto pairs = hn::ShiftRight<8>(hn::BitCast(d, hn::LoadU(Bytes(), at)));
    return hn::DemoteTo(HalfBytes(), hn::BitCast(Shorts(), pairs));
  };
  return hn::Combine(Bytes(), half(bytes + 16), half(bytes));
}

HWY_INLINE void luma_step(const Line& line, const YuyvEye& eye, std::uint8_t* to) {
  const Ints d;
  const hn::Rebind<std::int16_t, Ints> shorts;
  const hn::Rebind<std::uint8_t, Ints> bytes;
  const int rows = line.step->luma_rows;
  const int begin = line.step->luma_begin;
  const int y0 = line.step->luma_row;
  const std::uint8_t* at =
      reinterpret_cast<const std::uint8_t*>(row_of(eye, y0)) + 2 * begin;  // NOLINT
  const auto row_bytes = static_cast<std::ptrdiff_t>(eye.row_pairs * sizeof(Yuyv));
  const auto row0 = even_bytes(at);
  const auto row1 = even_bytes(at + row_bytes);
  for (int i = 0; i < kStep; i += static_cast<int>(hn::Lanes(d))) {
    const auto lane = hn::Iota(d, i);
    const auto along_line = [&](const std::int32_t* ends) HWY_ATTR {
      return hn::Add(hn::Set(d, ends[0]),
                     hn::ShiftRight<3>(hn::Mul(hn::Set(d, ends[1] - ends[0]), lane)));
    };
    const auto x = between_all<kFine>(d, along_line(line.x));
    const auto y = between_all<kFine>(d, along_line(line.y));
    const auto pick = hn::DemoteTo(bytes, hn::Sub(x.first, hn::Set(d, begin)));
    const auto pick_next = hn::Add(pick, hn::Set(bytes, 1));
    const auto share = hn::DemoteTo(shorts, x.share);
    const auto along_row = [&](hn::Vec<Bytes> row) HWY_ATTR {
      const auto a = hn::PromoteTo(shorts, hn::TableLookupBytes(row, pick));
      const auto b = hn::PromoteTo(shorts, hn::TableLookupBytes(row, pick_next));
      return hn::PromoteTo(d, hn::Add(hn::ShiftLeft<kFine>(a), hn::Mul(hn::Sub(b, a), share)));
    };
    auto upper = along_row(row0);
    auto lower = along_row(row1);
    auto last = lower;
    for (int k = 2; k < rows; ++k) {
      const auto next = along_row(even_bytes(at + k * row_bytes));
      const auto is_here = hn::Eq(y.first, hn::Set(d, y0 + k - 1));
      upper = hn::IfThenElse(is_here, last, upper);
      lower = hn::IfThenElse(is_here, next, lower);
      last = next;
    }
    const auto sum = hn::Add(hn::ShiftLeft<kFine>(upper), hn::Mul(hn::Sub(lower, upper), y.share));
    const auto stretched = hn::Mul(hn::Sub(sum, hn::Set(d, kBlack)), hn::Set(d, kStretch));
    const auto shown = hn::ShiftRight<kLumaShift>(hn::Add(stretched, hn::Set(d, kLumaHalf)));
    hn::StoreU(hn::DemoteTo(bytes, shown), bytes, to + i);
  }
}

HWY_ATTR void luma(const WarpGrid& grid, const YuyvEye& eye, GrayImage& warped) {
  for (int v = 0; v < grid.height; ++v) {
    std::uint8_t* to = warped.row(v);
    for (int u = 0; u < grid.width; u += kStep) {
      const Line line = line_of(grid, v, u / kStep);
      const int count = std::min(kStep, grid.width - u);
      if (count == kStep && line.step->luma_rows > 0) {
        luma_step(line, eye, to + u);
      } else {
        plain_luma_step(line, eye, to + u, count);
      }
    }
  }
}

// The four U and V of a step are in the lanes U V U V ...; both pixels of a pair share them.
HWY_INLINE void color_step(const Line& line, const YuyvEye& eye, const std::uint8_t* luma_of_step,
                           Rgb* to) {
  const FourInts d;
  const Shorts shorts;
  const Bytes bytes;
  const HalfBytes half_bytes;
  const int begin = line.step->color_begin;
  const auto colors = odd_bytes(row_of(eye, line.step->color_row) + begin);

  alignas(16) static constexpr std::uint8_t kLowByte[16] = {0, 0, 0, 0, 4,  4,  4,  4,
                                                            8, 8, 8, 8, 12, 12, 12, 12};
  alignas(16) static constexpr std::uint8_t kLowShort[16] = {0, 1, 0, 1, 4,  5,  4,  5,
                                                             8, 9, 8, 9, 12, 13, 12, 13};
  alignas(16) static constexpr std::uint8_t kOfU[16] = {0, 1, 0, 1, 4,  5,  4,  5,
                                                        8, 9, 8, 9, 12, 13, 12, 13};
  alignas(16) static constexpr std::uint8_t kOfV[16] = {2,  3,  2,  3,  6,  7,  6,  7,
                                                        10, 11, 10, 11, 14, 15, 14, 15};
  // An index with its highest bit set selects 0, which extends the bytes to shorts.
  const auto u_then_v = hn::BitCast(bytes, hn::Set(d, static_cast<std::int32_t>(0x80018000U)));
  const auto part = hn::Add(hn::ShiftLeft<2>(hn::Iota(d, 0)), hn::Set(d, 1));
  const auto middle = hn::Add(hn::Set(d, line.x[0]),
                              hn::ShiftRight<4>(hn::Mul(hn::Set(d, line.x[1] - line.x[0]), part)));
  const auto x =
      between_all<kPairFine>(d, hn::ShiftRight<1>(hn::Sub(middle, hn::Set(d, kOne / 2))));
  const auto twice = hn::ShiftLeft<1>(hn::Sub(x.first, hn::Set(d, begin)));
  const auto pick = hn::TableLookupBytes(hn::BitCast(bytes, twice), hn::Load(bytes, kLowByte));
  const auto picked = [&](hn::Vec<Bytes> at) HWY_ATTR {
    return hn::BitCast(shorts, hn::TableLookupBytesOr0(colors, hn::Or(at, u_then_v)));
  };
  const auto a = picked(pick);
  const auto b = picked(hn::Add(pick, hn::Set(bytes, 2)));
  const auto share = hn::BitCast(
      shorts, hn::TableLookupBytes(hn::BitCast(bytes, x.share), hn::Load(bytes, kLowShort)));
  const auto mixed = hn::Add(hn::ShiftLeft<kPairFine>(a), hn::Mul(hn::Sub(b, a), share));
  const auto doubled = hn::ShiftLeft<1>(hn::Sub(mixed, hn::Set(shorts, kGrey)));
  const auto alternating = [&](int of_u, int of_v) HWY_ATTR {
    const std::uint32_t both = static_cast<std::uint32_t>(of_v) << 16 | (of_u & 0xFFFF);
    return hn::BitCast(shorts, hn::Set(d, static_cast<std::int32_t>(both)));
  };
  const auto blue_red = hn::MulHigh(doubled, alternating(kBlueOfU, kRedOfV));
  const auto green_parts = hn::MulHigh(doubled, alternating(kGreenOfU, kGreenOfV));
  const auto of = [&](hn::Vec<Shorts> values, const std::uint8_t* where) HWY_ATTR {
    return hn::BitCast(shorts,
                       hn::TableLookupBytes(hn::BitCast(bytes, values), hn::Load(bytes, where)));
  };
  const auto green = hn::Add(of(green_parts, kOfU), of(green_parts, kOfV));
  const auto luma_here = hn::PromoteTo(shorts, hn::LoadU(half_bytes, luma_of_step));
  const auto channel = [&](hn::Vec<Shorts> quarters) HWY_ATTR {
    const auto added = hn::ShiftRight<2>(hn::Add(quarters, hn::Set(shorts, 2)));
    return hn::DemoteTo(half_bytes, hn::Add(luma_here, added));
  };
  hn::StoreInterleaved3(channel(of(blue_red, kOfV)), channel(green), channel(of(blue_red, kOfU)),
                        half_bytes, reinterpret_cast<std::uint8_t*>(to));  // NOLINT
}

HWY_ATTR void color(const WarpGrid& grid, const YuyvEye& eye, const GrayImage& luma_of_eye,
                    ColorImage& warped) {
  for (int v = 0; v < grid.height; ++v) {
    const std::uint8_t* from = luma_of_eye.row(v);
    Rgb* to = warped.row(v);
    for (int u = 0; u < grid.width; u += kStep) {
      const Line line = line_of(grid, v, u / kStep);
      const int count = std::min(kStep, grid.width - u);
      if (count == kStep && line.step->color_rows > 0) {
        color_step(line, eye, from + u, to + u);
      } else {
        plain_color_step(line, eye, from + u, to + u, count);
      }
    }
  }
}
#endif

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpable {
namespace {

HWY_EXPORT(luma);
HWY_EXPORT(color);

std::vector<YuyvKernels> all_kernels() {
  std::vector<YuyvKernels> all;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    all.push_back({name, &HWY_DYNAMIC_DISPATCH(luma), &HWY_DYNAMIC_DISPATCH(color)});
  });
  all.push_back({"scalar", plain_luma, plain_color});
  return all;
}

const std::vector<YuyvKernels> kKernels = all_kernels();

}  // namespace

std::span<const YuyvKernels> yuyv_kernels() { return kKernels; }

void WarpGrid::resize(int width_px, int height_px) {
  PALPABLE_EXPECT(width_px >= 2 && height_px >= 2, "a picture has at least 2 x 2 pixels");
  width = width_px;
  height = height_px;
  columns = (width + kStep - 1) / kStep + 1;
  x.resize(static_cast<std::size_t>(columns) * height);
  y.resize(x.size());
  steps.resize(x.size());
}

void WarpGrid::prepare(int raw_width, int raw_height) {
  for (int v = 0; v < height; ++v) {
    for (int i = 0; i + 1 < columns; ++i) {
      steps[static_cast<std::size_t>(v) * columns + i] =
          step_of(line_of(*this, v, i), raw_width, raw_height);
    }
  }
}

void WarpGrid::set(int row, int at_column, double x_px, double y_px) {
  // Positions far outside are clamped: all of them show the border. Half a unit is added so that
  // truncation to 1/32 px rounds.
  constexpr double kFarthest = 8192;  // px
  const auto fixed = [&](double px) {
    return static_cast<std::int32_t>(std::lround(std::clamp(px, -kFarthest, kFarthest) * kOne)) +
           (kOne >> (kFine + 1));
  };
  const std::size_t i = static_cast<std::size_t>(row) * columns + at_column / kStep;
  x[i] = fixed(x_px);
  y[i] = fixed(y_px);
}

}  // namespace palpable
#endif
