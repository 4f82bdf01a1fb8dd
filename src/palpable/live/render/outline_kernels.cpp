// This file is compiled once for each set of vector instructions, without contraction of a * b + c
// (CMakeLists.txt), because the contracted results would differ between them.

#include "palpable/live/render/outline_kernels.h"

#include "palpable/common/base/simd_targets.h"

#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/render/outline_kernels.cpp"
// Highway requires this header first.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_OUTLINE_KERNELS_ONCE
#define PALPABLE_OUTLINE_KERNELS_ONCE
namespace palpable {
namespace {

constexpr float kSpatialReach = 40;  // R_s, px
constexpr float kColorReach = 40;    // R_c, of colours
constexpr int kLanes = OutlineWindow::kLanes;
constexpr int kColumns = OutlineWindow::kColumns;

float bump(float squared, float reach) {
  const float share = std::max(1.0f - squared / (reach * reach), 0.0f);
  return share * share;
}

OutlineSums plain_sums(const OutlineWindow& w, float split) {
  OutlineSums s{};
  for (int v = 0; v < w.rows; ++v) {
    const float dy = w.dy + static_cast<float>(v) * w.step;
    for (int k = 0; k < kColumns; ++k) {
      const std::size_t at = static_cast<std::size_t>(v) * w.stride + k;
      const int i = k % kLanes;
      const float dx = w.dx + static_cast<float>(k) * w.step;
      const float light = w.light[at] - w.own_light, warm = w.warm[at] - w.own_warm;
      const float pink = w.pink[at] - w.own_pink;
      const float weight = w.sure[at] * bump(dx * dx + dy * dy, kSpatialReach);
      const float fit = weight * bump(light * light + warm * warm + pink * pink, kColorReach);
      const float is_near = w.inverse[at] > split ? 1.0f : 0.0f;
      s.near_weight[i] += is_near * weight;
      s.near_fit[i] += is_near * fit;
      s.near_inverse[i] += is_near * weight * w.inverse[at];
      s.all_weight[i] += weight;
      s.all_fit[i] += fit;
      s.all_inverse[i] += weight * w.inverse[at];
      s.near_moving[i] += is_near * weight * w.moving[at];
      s.all_moving[i] += weight * w.moving[at];
    }
  }
  return s;
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
#if HWY_TARGET == HWY_SCALAR
OutlineSums sums(const OutlineWindow& window, float split) { return plain_sums(window, split); }
#else
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLanes>;

HWY_INLINE hn::Vec<Floats> bump_of(hn::Vec<Floats> squared, float reach) {
  const Floats d;
  const auto share =
      hn::Max(hn::Sub(hn::Set(d, 1.0f), hn::Div(squared, hn::Set(d, reach * reach))), hn::Zero(d));
  return hn::Mul(share, share);
}

// If the lanes do not fit into one vector, they are summed in several passes. Each lane has its own
// sums, so that the result does not depend on the vector's width.
HWY_ATTR OutlineSums sums(const OutlineWindow& w, float split_at) {
  const Floats d;
  OutlineSums result;
  const auto split = hn::Set(d, split_at), step = hn::Set(d, w.step), dx0 = hn::Set(d, w.dx);
  const auto own_light = hn::Set(d, w.own_light), own_warm = hn::Set(d, w.own_warm);
  const auto own_pink = hn::Set(d, w.own_pink);
  for (int part = 0; part < kLanes; part += static_cast<int>(hn::Lanes(d))) {
    auto near_fit = hn::Zero(d), near_weight = near_fit, near_inverse = near_fit;
    auto all_fit = near_fit, all_weight = near_fit, all_inverse = near_fit;
    auto near_moving = near_fit, all_moving = near_fit;
    for (int v = 0; v < w.rows; ++v) {
      const auto dy = hn::Set(d, w.dy + static_cast<float>(v) * w.step);
      const auto dy_squared = hn::Mul(dy, dy);
      for (int k = part; k < kColumns; k += kLanes) {
        const std::size_t at = static_cast<std::size_t>(v) * w.stride + k;
        const auto dx = hn::Add(dx0, hn::Mul(hn::Iota(d, static_cast<float>(k)), step));
        const auto light = hn::Sub(hn::LoadU(d, w.light + at), own_light);
        const auto warm = hn::Sub(hn::LoadU(d, w.warm + at), own_warm);
        const auto pink = hn::Sub(hn::LoadU(d, w.pink + at), own_pink);
        const auto away = hn::Add(hn::Mul(dx, dx), dy_squared);
        const auto weight = hn::Mul(hn::LoadU(d, w.sure + at), bump_of(away, kSpatialReach));
        const auto unlike =
            hn::Add(hn::Add(hn::Mul(light, light), hn::Mul(warm, warm)), hn::Mul(pink, pink));
        const auto fit = hn::Mul(weight, bump_of(unlike, kColorReach));
        const auto inverse = hn::LoadU(d, w.inverse + at);
        const auto is_near = hn::Gt(inverse, split);
        const auto weighted = hn::Mul(weight, inverse);
        near_weight = hn::Add(near_weight, hn::IfThenElseZero(is_near, weight));
        near_fit = hn::Add(near_fit, hn::IfThenElseZero(is_near, fit));
        near_inverse = hn::Add(near_inverse, hn::IfThenElseZero(is_near, weighted));
        all_weight = hn::Add(all_weight, weight);
        all_fit = hn::Add(all_fit, fit);
        all_inverse = hn::Add(all_inverse, weighted);
        const auto moving = hn::Mul(weight, hn::LoadU(d, w.moving + at));
        near_moving = hn::Add(near_moving, hn::IfThenElseZero(is_near, moving));
        all_moving = hn::Add(all_moving, moving);
      }
    }
    hn::StoreU(near_fit, d, result.near_fit.data() + part);
    hn::StoreU(near_weight, d, result.near_weight.data() + part);
    hn::StoreU(near_inverse, d, result.near_inverse.data() + part);
    hn::StoreU(all_fit, d, result.all_fit.data() + part);
    hn::StoreU(all_weight, d, result.all_weight.data() + part);
    hn::StoreU(all_inverse, d, result.all_inverse.data() + part);
    hn::StoreU(near_moving, d, result.near_moving.data() + part);
    hn::StoreU(all_moving, d, result.all_moving.data() + part);
  }
  return result;
}
#endif

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpable {
namespace {

HWY_EXPORT(sums);

std::vector<OutlineKernels> all_kernels() {
  std::vector<OutlineKernels> all;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    all.push_back({name, &HWY_DYNAMIC_DISPATCH(sums)});
  });
  all.push_back({"scalar", plain_sums});
  return all;
}

const std::vector<OutlineKernels> kKernels = all_kernels();

}  // namespace

std::span<const OutlineKernels> outline_kernels() { return kKernels; }

}  // namespace palpable
#endif
