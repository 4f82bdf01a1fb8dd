// The loops over pixels, vectorised by Google Highway: this file is compiled once for each
// instruction set, and the fastest one is chosen when the program runs. It is compiled without
// contraction of a * b + c (CMakeLists.txt), because the contracted results would differ between
// instruction sets.

#include "palpable/live/seen_object/pixel_kernels.h"

#include "palpable/common/base/simd_targets.h"

#include <algorithm>
#include <cmath>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/seen_object/pixel_kernels.cpp"
// Highway requires this header first.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_PIXEL_KERNELS_ONCE
#define PALPABLE_PIXEL_KERNELS_ONCE
namespace palpable {
namespace {

inline void plain_take_over(const OutlineRow& from, const OutlineRow& to, int dy, int count,
                            const DepthJump& jump) {
  for (int x = 0; x < count; ++x) {
    if (!(to.distance[x] > 0)) continue;
    const float z = to.depth[x];
    for (int u = x - 1; u <= x + 1; ++u) {
      const float theirs = from.distance[u];
      if (!(theirs > 0) || theirs - kOutlineStep >= to.distance[x]) continue;
      constexpr int kUnits = static_cast<int>(kOutlineUnits);
      const auto dx = static_cast<std::int16_t>(from.nearest[u].dx + kUnits * (u - x));
      const auto dv = static_cast<std::int16_t>(from.nearest[u].dy + kUnits * dy);
      const float beyond = from.beyond[u];
      const float length = length_of({dx, dv}) + beyond;
      const float nearer = std::min(z, from.depth[u]);
      const float most = std::max(jump.least, jump.at_1m * nearer * nearer);
      if (!(length < to.distance[x]) || !(std::abs(z - from.depth[u]) <= most)) continue;
      to.distance[x] = length;
      to.nearest[x] = {dx, dv};
      to.beyond[x] = beyond;
    }
  }
}

inline void plain_mean_of_nine(const float* above, const float* row, const float* below, int count,
                               const DepthJump& jump, float* mean) {
  for (int x = 0; x < count; ++x) {
    const float w = row[x], apart = std::max(jump.least * w * w, jump.at_1m);
    float sum = 0, pixels = 0;
    for (const float* of : {above, row, below}) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (!(std::abs(of[u] - w) < apart)) continue;
        sum += of[u];
        pixels += 1;
      }
    }
    mean[x] = w == 0 ? 0.0f : sum / pixels;
  }
}

constexpr float kRoot = 1.41421356f;

inline void plain_sum_window(const PixelWindow& window, const DepthJump& jump, ColumnSums& sums) {
  sums = {};
  const float z0 = window.z, w0 = 1 / z0, radius = window.radius;
  for (int v = window.top; v <= window.bottom; ++v) {
    const std::size_t row = static_cast<std::size_t>(v - window.top) * window.stride;
    const float *depth = window.depth + row, *distance = window.distance + row;
    const auto dv = static_cast<float>(v);
    for (std::size_t k = 0; k < static_cast<std::size_t>(window.columns); ++k) {
      const float nearer = std::min(depth[k], z0);
      const float most = std::max(jump.least, jump.at_1m * nearer * nearer);
      if (!(distance[k] >= window.least) || !(std::abs(depth[k] - z0) <= most)) continue;
      float z = depth[k];
      if (radius > 0) {
        const float from_middle =
            std::max(radius - (distance[k] - window.fattening) * window.m_per_px, 0.0f);
        z -= radius - std::sqrt(std::max(radius * radius - from_middle * from_middle, 0.0f));
      }
      const float w = 1 / z - w0;
      sums.n[k] += 1, sums.nv[k] += dv, sums.nvv[k] += dv * dv;
      sums.w[k] += w, sums.vw[k] += dv * w, sums.vvw[k] += dv * dv * w;
    }
  }
}

inline void plain_find_middles(const DistanceRow& above, const DistanceRow& row,
                               const DistanceRow& below, int count, const DepthJump& jump,
                               const MiddleTest& test, float* distance) {
  for (int x = 0; x < count; ++x) {
    const float mine = row.distance[x], z = row.depth[x];
    distance[x] = 0;
    if (!(mine > 0)) continue;
    distance[x] = mine;
    if (mine - test.fattening >= test.f_r / (z + test.r)) continue;
    for (const DistanceRow* of : {&above, &row, &below}) {
      for (int u = x - 1; u <= x + 1; ++u) {
        if (of == &row && u == x) continue;
        const float step = of != &row && u != x ? test.growth * kRoot : test.growth;
        const float nearer = std::min(z, of->depth[u]);
        const float most = std::max(jump.least, jump.at_1m * nearer * nearer);
        if (of->distance[u] >= mine + step && std::abs(z - of->depth[u]) <= most) distance[x] = 0;
      }
    }
  }
}

// The length (m) of a chord of n steps to each side at depth z. @param step  px per step
inline float across(const ChordTest& test, int n, float step, float z) {
  return 2 * static_cast<float>(n) * step * z / test.fx_px;
}

// Whether chords of n px to each side of pixel x lie within the image, in all directions.
inline bool has_room(const ChordTest& test, int x, int count, int n) {
  return n <= test.before + x && n < test.after + count - x && n <= test.above && n <= test.below;
}

inline void plain_find_hollow(const float* mean, const float* distance, std::ptrdiff_t width,
                              int count, const ChordTest& test, float* hollow) {
  for (int x = 0; x < count; ++x) {
    hollow[x] = 0;
    const float w = mean[x];
    if (!(w > 0) || !(distance[x] >= test.nearest_at_1m * w)) continue;
    const float z = 1 / w, half = test.half_px_at_1m * w;
    for (const bool slanted : {false, true}) {
      const float step = slanted ? kRoot : 1.0f;
      const int n = std::max(test.least_half_px, static_cast<int>(half / step + 0.5f));
      if (!has_room(test, x, count, n)) {
        hollow[x] = 1;  // not decided here: Creases::measure_sag() tests each direction
        continue;
      }
      const float length = across(test, n, step, z);
      const float shallow = z - length * length / test.eight_radii;
      for (const std::ptrdiff_t way : {slanted ? 1 + width : 1, slanted ? 1 - width : width}) {
        const float w1 = mean[x - n * way], w2 = mean[x + n * way];
        if (shallow * (w1 + w2) > 2 && w1 != 0 && w2 != 0) hollow[x] = 1;
      }
    }
  }
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

using Floats = hn::CappedTag<float, kReadBeyond>;

HWY_ATTR void take_over(const OutlineRow& from, const OutlineRow& to, int dy, int count,
                        const DepthJump& jump) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const hn::Repartition<std::int16_t, Floats> d16;
  const auto zero = hn::Zero(d), step = hn::Set(d, kOutlineStep);
  const auto px = hn::Set(d, 1 / kOutlineUnits);
  constexpr int kUnits = static_cast<int>(kOutlineUnits);
  const auto least = hn::Set(d, jump.least), at_1m = hn::Set(d, jump.at_1m);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < count; x += lanes) {
    auto distance = hn::LoadU(d, to.distance + x);
    const auto is_thing =
        hn::And(hn::Gt(distance, zero), hn::FirstN(d, static_cast<std::size_t>(count - x)));
    if (hn::AllFalse(d, is_thing)) continue;
    auto nearest = hn::BitCast(di, hn::LoadU(d16, &to.nearest[x].dx));
    auto beyond = hn::LoadU(d, to.beyond + x);
    const auto z = hn::LoadU(d, to.depth + x);
    auto changed = hn::MaskFromVec(zero);
    for (int k = -1; k <= 1; ++k) {
      const auto theirs = hn::LoadU(d, from.distance + x + k);
      auto takes =
          hn::And(hn::And(is_thing, hn::Gt(theirs, zero)), hn::Lt(hn::Sub(theirs, step), distance));
      if (hn::AllFalse(d, takes)) continue;
      // A pair of 16-bit numbers in one 32-bit lane, dx in the lower half.
      const auto way =
          hn::BitCast(d16, hn::Set(di, static_cast<std::int32_t>(
                                           static_cast<std::uint32_t>(kUnits * dy) << 16 |
                                           (static_cast<std::uint32_t>(kUnits * k) & 0xFFFF))));
      const auto offer = hn::BitCast(di, hn::Add(hn::LoadU(d16, &from.nearest[x + k].dx), way));
      const auto dx = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(offer)));
      const auto dv = hn::ConvertTo(d, hn::ShiftRight<16>(offer));
      const auto theirs_beyond = hn::LoadU(d, from.beyond + x + k);
      const auto length =
          hn::Add(hn::Mul(hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dv, dv))), px), theirs_beyond);
      const auto z_other = hn::LoadU(d, from.depth + x + k);
      const auto nearer = hn::Min(z, z_other);
      const auto most = hn::Max(least, hn::Mul(hn::Mul(at_1m, nearer), nearer));
      takes = hn::And(
          takes, hn::And(hn::Lt(length, distance), hn::Le(hn::Abs(hn::Sub(z, z_other)), most)));
      distance = hn::IfThenElse(takes, length, distance);
      nearest = hn::IfThenElse(hn::RebindMask(di, takes), offer, nearest);
      beyond = hn::IfThenElse(takes, theirs_beyond, beyond);
      changed = hn::Or(changed, takes);
    }
    if (hn::AllFalse(d, changed)) continue;
    hn::StoreU(distance, d, to.distance + x);
    hn::StoreU(hn::BitCast(d16, nearest), d16, &to.nearest[x].dx);
    hn::StoreU(beyond, d, to.beyond + x);
  }
}

HWY_ATTR void mean_of_nine(const float* above, const float* row, const float* below, int count,
                           const DepthJump& jump, float* mean) {
  const Floats d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto least = hn::Set(d, jump.least), at_1m = hn::Set(d, jump.at_1m);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto w = hn::LoadU(d, row + x);
    const auto apart = hn::Max(hn::Mul(hn::Mul(least, w), w), at_1m);
    auto sum = zero, pixels = zero;
    for (const float* of : {above, row, below}) {
      for (int k = -1; k <= 1; ++k) {
        const auto other = hn::LoadU(d, of + x + k);
        const auto same = hn::Lt(hn::Abs(hn::Sub(other, w)), apart);
        sum = hn::Add(sum, hn::IfThenElseZero(same, other));
        pixels = hn::Add(pixels, hn::IfThenElseZero(same, one));
      }
    }
    // Where there is a thing, the middle pixel itself counts, so that `pixels` is not 0.
    const auto is_thing = hn::Ne(w, zero);
    const auto value =
        hn::Div(hn::IfThenElseZero(is_thing, sum), hn::IfThenElse(is_thing, pixels, one));
    hn::StoreU(value, d, mean + x);
  }
  plain_mean_of_nine(above + x, row + x, below + x, count - x, jump, mean + x);
}

// Sums the columns from `first` on, as many as a vector D holds.
template <class D>
HWY_ATTR inline void sum_columns(const PixelWindow& window, const DepthJump& jump,
                                 std::size_t first, ColumnSums& sums) {
  const D d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto z0 = hn::Set(d, window.z), w0 = hn::Set(d, 1 / window.z);
  const auto least = hn::Set(d, window.least), radius = hn::Set(d, window.radius);
  const auto fattening = hn::Set(d, window.fattening), m_per_px = hn::Set(d, window.m_per_px);
  const auto radius2 = hn::Set(d, window.radius * window.radius);
  const auto jump_least = hn::Set(d, jump.least), at_1m = hn::Set(d, jump.at_1m);
  const auto columns = static_cast<std::size_t>(window.columns);
  const auto is_inside = hn::FirstN(d, columns > first ? columns - first : 0);
  const bool is_round = window.radius > 0;
  auto n = zero, nv = zero, nvv = zero, sw = zero, vw = zero, vvw = zero;
  const float *depths = window.depth + first, *distances = window.distance + first;
  for (int v = window.top; v <= window.bottom; ++v) {
    const auto depth = hn::LoadU(d, depths), distance = hn::LoadU(d, distances);
    depths += window.stride, distances += window.stride;
    const auto nearer = hn::Min(depth, z0);
    const auto most = hn::Max(jump_least, hn::Mul(hn::Mul(at_1m, nearer), nearer));
    const auto counts = hn::And(
        is_inside, hn::And(hn::Ge(distance, least), hn::Le(hn::Abs(hn::Sub(depth, z0)), most)));
    auto z = hn::IfThenElse(counts, depth, z0);
    if (is_round) {
      const auto inside = hn::IfThenElse(counts, distance, least);
      const auto from_middle =
          hn::Max(hn::Sub(radius, hn::Mul(hn::Sub(inside, fattening), m_per_px)), zero);
      z = hn::Sub(
          z, hn::Sub(radius,
                     hn::Sqrt(hn::Max(hn::Sub(radius2, hn::Mul(from_middle, from_middle)), zero))));
    }
    const auto w = hn::IfThenElseZero(counts, hn::Sub(hn::Div(one, z), w0));
    const auto dv = hn::Set(d, static_cast<float>(v)), dv2 = hn::Mul(dv, dv);
    n = hn::Add(n, hn::IfThenElseZero(counts, one));
    nv = hn::Add(nv, hn::IfThenElseZero(counts, dv));
    nvv = hn::Add(nvv, hn::IfThenElseZero(counts, dv2));
    sw = hn::Add(sw, w);
    vw = hn::Add(vw, hn::Mul(dv, w));
    vvw = hn::Add(vvw, hn::Mul(dv2, w));
  }
  hn::StoreU(n, d, sums.n.data() + first);
  hn::StoreU(nv, d, sums.nv.data() + first);
  hn::StoreU(nvv, d, sums.nvv.data() + first);
  hn::StoreU(sw, d, sums.w.data() + first);
  hn::StoreU(vw, d, sums.vw.data() + first);
  hn::StoreU(vvw, d, sums.vvw.data() + first);
}

HWY_ATTR void sum_window(const PixelWindow& window, const DepthJump& jump, ColumnSums& sums) {
  static_assert(kWindowColumns == 12);
#if HWY_MAX_BYTES >= 32
  sum_columns<hn::FixedTag<float, 8>>(window, jump, 0, sums);
  sum_columns<hn::FixedTag<float, 4>>(window, jump, 8, sums);
#else
  for (std::size_t first : {0U, 4U, 8U}) {
    sum_columns<hn::FixedTag<float, 4>>(window, jump, first, sums);
  }
#endif
}

HWY_ATTR void find_middles(const DistanceRow& above, const DistanceRow& row,
                           const DistanceRow& below, int count, const DepthJump& jump,
                           const MiddleTest& test, float* distance) {
  const Floats d;
  const auto zero = hn::Zero(d), growth = hn::Set(d, test.growth);
  const auto slanted = hn::Set(d, test.growth * kRoot);
  const auto fattening = hn::Set(d, test.fattening);
  const auto f_r = hn::Set(d, test.f_r), r = hn::Set(d, test.r);
  const auto least = hn::Set(d, jump.least), at_1m = hn::Set(d, jump.at_1m);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto mine = hn::LoadU(d, row.distance + x), z = hn::LoadU(d, row.depth + x);
    const auto is_thing = hn::Gt(mine, zero);
    if (hn::AllFalse(d, is_thing)) {
      hn::StoreU(zero, d, distance + x);
      continue;
    }
    const auto straight_step = hn::Add(mine, growth), slanted_step = hn::Add(mine, slanted);
    auto held = hn::MaskFromVec(zero);
    for (const DistanceRow* of : {&above, &row, &below}) {
      for (int k = -1; k <= 1; ++k) {
        if (of == &row && k == 0) continue;
        const auto step = of != &row && k != 0 ? slanted_step : straight_step;
        const auto other = hn::LoadU(d, of->depth + x + k);
        const auto nearer = hn::Min(z, other);
        const auto most = hn::Max(least, hn::Mul(hn::Mul(at_1m, nearer), nearer));
        held = hn::Or(held, hn::And(hn::Ge(hn::LoadU(d, of->distance + x + k), step),
                                    hn::Le(hn::Abs(hn::Sub(z, other)), most)));
      }
    }
    const auto wide = hn::Ge(hn::Sub(mine, fattening), hn::Div(f_r, hn::Add(z, r)));
    const auto stands = hn::And(is_thing, hn::Or(wide, hn::Not(held)));
    hn::StoreU(hn::IfThenElseZero(stands, mine), d, distance + x);
  }
  const auto at = [x](const DistanceRow& of) { return DistanceRow{of.distance + x, of.depth + x}; };
  plain_find_middles(at(above), at(row), at(below), count - x, jump, test, distance + x);
}

HWY_ATTR void find_hollow(const float* mean, const float* distance, std::ptrdiff_t width, int count,
                          const ChordTest& test, float* hollow) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto w = hn::LoadU(d, mean + x);
    const auto tested =
        hn::And(hn::Gt(w, zero),
                hn::Ge(hn::LoadU(d, distance + x), hn::Mul(hn::Set(d, test.nearest_at_1m), w)));
    if (hn::AllFalse(d, tested)) {
      hn::StoreU(zero, d, hollow + x);
      continue;
    }
    const auto z = hn::Div(one, hn::IfThenElse(tested, w, one));
    const auto half = hn::Mul(hn::Set(d, test.half_px_at_1m), w);
    auto may_be = hn::MaskFromVec(zero);
    for (const bool slanted : {false, true}) {
      const float step = slanted ? kRoot : 1.0f;
      const auto ns =
          hn::Max(hn::Set(di, test.least_half_px),
                  hn::ConvertTo(di, hn::Add(hn::Div(half, hn::Set(d, step)), hn::Set(d, 0.5f))));
      const auto tested_ns = hn::IfThenElseZero(hn::RebindMask(di, tested), ns);
      const int n = hn::GetLane(hn::MaxOfLanes(di, tested_ns));
      const auto same = hn::Or(hn::Not(tested), hn::RebindMask(d, hn::Eq(ns, hn::Set(di, n))));
      // The vectors hold chords of one length only. Where the pixels' lengths differ, all of them
      // are passed on.
      if (!hn::AllTrue(d, same) || !has_room(test, x, count, n) ||
          !has_room(test, x + lanes - 1, count, n)) {
        may_be = tested;
        break;
      }
      const auto length =
          hn::Div(hn::Mul(hn::Set(d, 2 * static_cast<float>(n) * step), z), hn::Set(d, test.fx_px));
      const auto shallow =
          hn::Sub(z, hn::Div(hn::Mul(length, length), hn::Set(d, test.eight_radii)));
      for (const std::ptrdiff_t way : {slanted ? 1 + width : 1, slanted ? 1 - width : width}) {
        const auto w1 = hn::LoadU(d, mean + x - n * way), w2 = hn::LoadU(d, mean + x + n * way);
        may_be = hn::Or(may_be, hn::And(hn::Gt(hn::Mul(shallow, hn::Add(w1, w2)), two),
                                        hn::And(hn::Ne(w1, zero), hn::Ne(w2, zero))));
      }
    }
    hn::StoreU(hn::IfThenElseZero(hn::And(tested, may_be), one), d, hollow + x);
  }
  ChordTest rest = test;
  rest.before += x;
  plain_find_hollow(mean + x, distance + x, width, count - x, rest, hollow + x);
}

#else

void find_hollow(const float* mean, const float* distance, std::ptrdiff_t width, int count,
                 const ChordTest& test, float* hollow) {
  plain_find_hollow(mean, distance, width, count, test, hollow);
}
void sum_window(const PixelWindow& window, const DepthJump& jump, ColumnSums& sums) {
  plain_sum_window(window, jump, sums);
}
void find_middles(const DistanceRow& above, const DistanceRow& row, const DistanceRow& below,
                  int count, const DepthJump& jump, const MiddleTest& test, float* distance) {
  plain_find_middles(above, row, below, count, jump, test, distance);
}
void take_over(const OutlineRow& from, const OutlineRow& to, int dy, int count,
               const DepthJump& jump) {
  plain_take_over(from, to, dy, count, jump);
}
void mean_of_nine(const float* above, const float* row, const float* below, int count,
                  const DepthJump& jump, float* mean) {
  plain_mean_of_nine(above, row, below, count, jump, mean);
}

#endif  // HWY_SCALAR

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace palpable {
namespace {
HWY_EXPORT(take_over);
HWY_EXPORT(mean_of_nine);
HWY_EXPORT(sum_window);
HWY_EXPORT(find_middles);
HWY_EXPORT(find_hollow);

std::vector<PixelKernels> find_kernels() {
  std::vector<PixelKernels> kernels;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    kernels.push_back({name, &HWY_DYNAMIC_DISPATCH(take_over), &HWY_DYNAMIC_DISPATCH(mean_of_nine),
                       &HWY_DYNAMIC_DISPATCH(sum_window), &HWY_DYNAMIC_DISPATCH(find_middles),
                       &HWY_DYNAMIC_DISPATCH(find_hollow)});
  });
  kernels.push_back({"plain", plain_take_over, plain_mean_of_nine, plain_sum_window,
                     plain_find_middles, plain_find_hollow});
  return kernels;
}

// Initialised before main(), so that the first frame allocates nothing and threads need no lock.
const std::vector<PixelKernels> kKernels = find_kernels();

}  // namespace

std::span<const PixelKernels> pixel_kernels() { return kKernels; }

}  // namespace palpable
#endif
