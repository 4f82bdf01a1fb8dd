/// @file
/// The second half of stereo_kernels.h's vectorised loops: refinement and filters.
#pragma once

#include "palpable/live/stereo/stereo_kernels.h"

#include <cstddef>

namespace palpable {

/// Those functions of StereoKernels that refine_kernels.cpp implements.
struct RefineKernels {
  decltype(StereoKernels::refine) refine;
  decltype(StereoKernels::median) median;
  decltype(StereoKernels::smooth) smooth;
};

/// The functions for the instruction set that Highway or, during its calls,
/// for_each_simd_target() has chosen.
[[nodiscard]] RefineKernels chosen_refine_kernels();

/// Memory that `refine` needs for full images of this width.
[[nodiscard]] std::size_t refine_workspace_bytes(int width);

}  // namespace palpable
