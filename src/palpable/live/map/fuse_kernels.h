/// @file
/// The map's inner loop: fuses one depth image into one block of voxels. There is a scalar version
/// and one for each set of vector instructions. All perform the same operations in the same order,
/// without contraction (a * b + c is rounded twice), and so give the same bytes.
#pragma once

#include "palpable/live/map/voxel.h"

#include <cstddef>
#include <span>

namespace palpable {

/// The inputs that all blocks of one depth image share. Lengths in m, camera frame.
struct FuseFrame {
  const float* depth = nullptr;  ///< (width x height) Z; NaN: unknown, or masked as moving
  int width = 0;
  int height = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  float nearest = 0;   ///< voxels nearer to the camera than this are not changed
  float farthest = 0;  ///< depths beyond are ignored
  /// sigma_Z(Z) = noise[0] + Z (noise[1] + Z noise[2])
  float noise[3] = {0, 0, 0};
  /// Distances are kept up to t = max(truncation, truncation_sigmas * sigma_Z).
  float truncation = 0;
  float truncation_sigmas = 0;
  float best_sigma = 0;    ///< a depth has weight 1 up to it, beyond (best_sigma / sigma)^2
  float carve_weight = 0;  ///< the weight of a voxel that is seen free is first limited to that of
                           ///< this many such measurements
  VoxelUnits units;        ///< of the voxels' distance and weight
  /// (512) each: vector from a block's first voxel to voxel i, camera frame, m.
  const float* offset_x = nullptr;
  const float* offset_y = nullptr;
  const float* offset_z = nullptr;
};

struct FuseKernel {
  const char* name = "";
  /// Fuses one depth image into one block (Curless and Levoy 1996). For a voxel with distance d and
  /// weight w before:
  ///
  ///     s = Z(pixel of the voxel) - z(voxel)             > 0 before the measured surface
  ///     t = min(max(truncation, truncation_sigmas * sigma_Z(Z)), largest distance)
  ///     s < -t           hidden behind the surface: not changed
  ///     |s| <= t         d <- (w d + v s) / (w + v),  w <- min(w + v, most weight)
  ///     s > t            seen free: first w <- min(w, carve_weight v), then the same with s = t
  ///
  /// The weight of the measurement is v = min(1, (best_sigma / sigma)^2). At a surface sigma is
  /// sigma_Z(Z). Where the voxel is seen free it is sigma_Z(z): the certainty that the voxel is
  /// free depends on the voxel's own depth, not on that of the surface behind it.
  /// d and w are rounded to their units, w to at least one unit.
  /// @param first   (3) the block's first voxel, camera frame, m
  /// @param voxels  (512)
  /// @return the smallest d of the voxels that were seen; infinity if none was
  float (*fuse)(const FuseFrame& frame, const float* first, Voxel* voxels);
};

/// All kernels that this processor can run, the fastest first and the scalar one last.
[[nodiscard]] std::span<const FuseKernel> fuse_kernels();

}  // namespace palpable
