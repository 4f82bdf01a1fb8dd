// Compiled once for each set of vector instructions. Contraction of a * b + c is switched off in
// CMakeLists.txt, because its rounding would differ between them.

#include "palpable/live/map/fuse_kernels.h"

#include "palpable/common/base/simd_targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "palpable/live/map/fuse_kernels.cpp"
// Highway requires this include before the next:
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#ifndef PALPABLE_FUSE_KERNELS_ONCE
#define PALPABLE_FUSE_KERNELS_ONCE
namespace palpable {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A distance d in units is rounded as int(d + kAboveAll + 1/2) - kAboveAll: truncation of a
// positive number gives the same result on all processors.
constexpr float kAboveAll = 32768;  // more than any distance in units

float plain_fuse(const FuseFrame& f, const float* first, Voxel* voxels) {
  int lowest = std::numeric_limits<int>::max();
  const float per_distance = 1 / f.units.distance, per_weight = 1 / f.units.weight;
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    const float x = first[0] + f.offset_x[i];
    const float y = first[1] + f.offset_y[i];
    const float z = first[2] + f.offset_z[i];
    const float inverse = 1.0F / z;
    const float u = f.fx_px * x * inverse + (f.cx_px + 0.5F);
    const float v = f.fy_px * y * inverse + (f.cy_px + 0.5F);
    if (z > f.nearest && u >= 0 && v >= 0 && u < static_cast<float>(f.width) &&
        v < static_cast<float>(f.height)) {
      const float Z = f.depth[static_cast<int>(v) * f.width + static_cast<int>(u)];
      const float sigma = f.noise[0] + Z * (f.noise[1] + Z * f.noise[2]);
      const float t =
          std::min(std::max(f.truncation, f.truncation_sigmas * sigma), f.units.largest_distance());
      const float s = Z - z;
      if (Z <= f.farthest && s >= -t) {
        const bool is_free = s > t;
        const float sigma_here = f.noise[0] + z * (f.noise[1] + z * f.noise[2]);
        const float share = f.best_sigma / (is_free ? sigma_here : sigma);
        const float added = std::min(1.0F, share * share);
        const float w = f.units.weight_of(voxels[i]), d = f.units.distance_of(voxels[i]);
        const float old = is_free ? std::min(w, f.carve_weight * added) : w;
        const float sum = old + added;
        const float mean = (old * d + added * (is_free ? t : s)) / sum;
        const float weight =
            std::max(std::min(sum, f.units.most_weight()) * per_weight + 0.5F, 1.0F);
        const int distance = static_cast<int>(mean * per_distance + (kAboveAll + 0.5F)) -
                             static_cast<int>(kAboveAll);
        voxels[i] = static_cast<Voxel>(distance & 0xFFFF) | static_cast<Voxel>(weight) << 16;
      }
    }
    if (was_seen(voxels[i])) {
      lowest = std::min<int>(lowest, static_cast<std::int16_t>(voxels[i] & 0xFFFF));
    }
  }
  return lowest == std::numeric_limits<int>::max() ? kInfinity
                                                   : f.units.distance * static_cast<float>(lowest);
}

}  // namespace
}  // namespace palpable
#endif

HWY_BEFORE_NAMESPACE();
namespace palpable::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
float fuse(const FuseFrame& f, const float* first, Voxel* voxels) {
  return plain_fuse(f, first, voxels);
}
#else
using Floats = hn::ScalableTag<float>;
using Depths = std::array<float, kVoxelsOfBlock>;

// First pass: the depth at the pixel of each voxel, NaN outside the picture. In a loop of its own
// many gathers are in flight at once.
HWY_ATTR inline void gather_depths(const FuseFrame& f, const float* first, Depths& behind) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0F), nothing = hn::NaN(d);
  const auto x0 = hn::Set(d, first[0]), y0 = hn::Set(d, first[1]), z0 = hn::Set(d, first[2]);
  const auto fx = hn::Set(d, f.fx_px), fy = hn::Set(d, f.fy_px);
  const auto cx = hn::Set(d, f.cx_px + 0.5F), cy = hn::Set(d, f.cy_px + 0.5F);
  const auto width = hn::Set(d, static_cast<float>(f.width));
  const auto height = hn::Set(d, static_cast<float>(f.height));
  const auto nearest = hn::Set(d, f.nearest);
  const auto row = hn::Set(di, f.width);
  for (std::size_t i = 0; i < kVoxelsOfBlock; i += hn::Lanes(d)) {
    const auto x = hn::Add(x0, hn::LoadU(d, f.offset_x + i));
    const auto y = hn::Add(y0, hn::LoadU(d, f.offset_y + i));
    const auto z = hn::Add(z0, hn::LoadU(d, f.offset_z + i));
    const auto inverse = hn::Div(one, z);
    const auto u = hn::Add(hn::Mul(hn::Mul(fx, x), inverse), cx);
    const auto v = hn::Add(hn::Mul(hn::Mul(fy, y), inverse), cy);
    const auto inside =
        hn::And(hn::And(hn::Gt(z, nearest), hn::And(hn::Ge(u, zero), hn::Ge(v, zero))),
                hn::And(hn::Lt(u, width), hn::Lt(v, height)));
    // For voxels outside, the first pixel is read and not used.
    const auto column = hn::ConvertTo(di, hn::IfThenElseZero(inside, u));
    const auto line = hn::ConvertTo(di, hn::IfThenElseZero(inside, v));
    const auto Z = hn::GatherIndex(d, f.depth, hn::Add(hn::Mul(line, row), column));
    hn::StoreU(hn::IfThenElse(inside, Z, nothing), d, &behind[i]);
  }
}

HWY_ATTR float fuse(const FuseFrame& f, const float* first, Voxel* voxels) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const hn::RebindToUnsigned<Floats> du;
  const std::size_t lanes = hn::Lanes(d);
  const auto one = hn::Set(d, 1.0F);
  const auto z0 = hn::Set(d, first[2]), farthest = hn::Set(d, f.farthest);
  const auto n0 = hn::Set(d, f.noise[0]), n1 = hn::Set(d, f.noise[1]), n2 = hn::Set(d, f.noise[2]);
  const auto truncation = hn::Set(d, f.truncation), sigmas = hn::Set(d, f.truncation_sigmas);
  const auto best = hn::Set(d, f.best_sigma), most = hn::Set(d, f.units.most_weight());
  const auto largest = hn::Set(d, f.units.largest_distance()), carve = hn::Set(d, f.carve_weight);
  const auto d_unit = hn::Set(d, f.units.distance), w_unit = hn::Set(d, f.units.weight);
  const auto per_d = hn::Set(d, 1 / f.units.distance), per_w = hn::Set(d, 1 / f.units.weight);
  const auto half = hn::Set(d, 0.5F), above_all = hn::Set(d, kAboveAll + 0.5F);
  const auto whole = hn::Set(di, static_cast<int>(kAboveAll)), low_half = hn::Set(di, 0xFFFF);
  const auto none = hn::Set(di, std::numeric_limits<int>::max());
  alignas(64) Depths behind;
  gather_depths(f, first, behind);
  auto lowest = none;
  for (std::size_t i = 0; i < kVoxelsOfBlock; i += lanes) {
    const auto z = hn::Add(z0, hn::LoadU(d, f.offset_z + i));
    const auto Z = hn::LoadU(d, &behind[i]);
    const auto sigma = hn::Add(n0, hn::Mul(Z, hn::Add(n1, hn::Mul(Z, n2))));
    const auto t = hn::Min(hn::Max(truncation, hn::Mul(sigmas, sigma)), largest);
    const auto s = hn::Sub(Z, z);
    // NaN compares false.
    const auto taken = hn::And(hn::Le(Z, farthest), hn::Ge(s, hn::Neg(t)));
    auto voxel = hn::LoadU(du, voxels + i);
    if (!hn::AllFalse(d, taken)) {
      const auto w = hn::Mul(w_unit, hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(voxel))));
      const auto signed_d = hn::ShiftRight<16>(hn::BitCast(di, hn::ShiftLeft<16>(voxel)));
      const auto old_d = hn::Mul(d_unit, hn::ConvertTo(d, signed_d));
      const auto is_free = hn::Gt(s, t);
      const auto sigma_here = hn::Add(n0, hn::Mul(z, hn::Add(n1, hn::Mul(z, n2))));
      const auto share = hn::Div(best, hn::IfThenElse(is_free, sigma_here, sigma));
      const auto added = hn::Min(one, hn::Mul(share, share));
      const auto old = hn::IfThenElse(is_free, hn::Min(w, hn::Mul(carve, added)), w);
      const auto sum = hn::Add(old, added);
      const auto mean =
          hn::Div(hn::Add(hn::Mul(old, old_d), hn::Mul(added, hn::IfThenElse(is_free, t, s))), sum);
      const auto weight = hn::Max(hn::Add(hn::Mul(hn::Min(sum, most), per_w), half), one);
      const auto new_d =
          hn::Sub(hn::ConvertTo(di, hn::Add(hn::Mul(mean, per_d), above_all)), whole);
      const auto both =
          hn::Or(hn::And(new_d, low_half), hn::ShiftLeft<16>(hn::ConvertTo(di, weight)));
      voxel = hn::IfThenElse(hn::RebindMask(du, taken), hn::BitCast(du, both), voxel);
      hn::StoreU(voxel, du, voxels + i);
    }
    const auto signed_d = hn::ShiftRight<16>(hn::BitCast(di, hn::ShiftLeft<16>(voxel)));
    const auto seen = hn::Ne(hn::BitCast(di, hn::ShiftRight<16>(voxel)), hn::Zero(di));
    lowest = hn::Min(lowest, hn::IfThenElse(seen, signed_d, none));
  }
  const int least = hn::GetLane(hn::MinOfLanes(di, lowest));
  return least == std::numeric_limits<int>::max() ? kInfinity
                                                  : f.units.distance * static_cast<float>(least);
}
#endif

}  // namespace palpable::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpable {
namespace {

HWY_EXPORT(fuse);

std::vector<FuseKernel> all_kernels() {
  std::vector<FuseKernel> all;
  for_each_simd_target(hwy::SupportedAndGeneratedTargets(), [&](const char* name) {
    all.push_back({name, &HWY_DYNAMIC_DISPATCH(fuse)});
  });
  all.push_back({"scalar", plain_fuse});
  return all;
}

const std::vector<FuseKernel> kKernels = all_kernels();

}  // namespace

std::span<const FuseKernel> fuse_kernels() { return kKernels; }

}  // namespace palpable
#endif
