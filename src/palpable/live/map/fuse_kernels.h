/// @file
/// The map's inner loop: one depth image into one block of voxels. There is a plain version and one
/// for each set of vector instructions; all make the same operations in the same order, none of
/// them contracted (a * b + c is two roundings), and so give the same bytes.
#pragma once

#include "palpable/live/map/voxel.h"

#include <cstddef>
#include <span>

namespace palpable {

/// What all blocks of one depth image share. Lengths in m, camera frame.
struct FuseFrame {
  const float* depth = nullptr;  ///< (width x height) Z; NaN: unknown, or of something that moves
  int width = 0;
  int height = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  float nearest = 0;   ///< voxels nearer to the camera than this stay as they are
  float farthest = 0;  ///< depths beyond are ignored
  /// sigma_Z(Z) = noise[0] + Z (noise[1] + Z noise[2])
  float noise[3] = {0, 0, 0};
  /// Distances are kept up to t = max(truncation, truncation_sigmas * sigma_Z).
  float truncation = 0;
  float truncation_sigmas = 0;
  float best_sigma = 0;    ///< up to it a depth has weight 1, beyond (best_sigma / sigma)^2
  float carve_weight = 0;  ///< a voxel that is seen free forgets what it weighs beyond this many
                           ///< such measurements
  VoxelUnits units;        ///< of (most_distance, most_weight)
  /// (512) each: from a block's first voxel to voxel i, camera frame, m.
  const float* offset_x = nullptr;
  const float* offset_y = nullptr;
  const float* offset_z = nullptr;
};

struct FuseKernel {
  const char* name = "";
  /// Fuses one depth image into one block (Curless and Levoy 1996). Per voxel, with distance d and
  /// weight w so far:
  ///
  ///     s = Z(pixel of the voxel) - z(voxel)             > 0 before the measured surface
  ///     t = min(max(truncation, truncation_sigmas * sigma_Z(Z)), largest distance)
  ///     s < -t           hidden behind the surface: nothing is learnt
  ///     |s| <= t         d <- (w d + v s) / (w + v),  w <- min(w + v, most weight)
  ///     s > t            seen free: first w <- min(w, carve_weight v), then the same with s = t
  ///
  /// The new weight is v = min(1, (best_sigma / sigma)^2). At a surface sigma is sigma_Z(Z). Where
  /// the voxel is seen free it is sigma_Z(z): the voxel is as surely free as a measurement there
  /// would be sure, however far the surface behind it lies.
  /// d and w are rounded to their units, w to at least one.
  /// @param first   (3) the block's first voxel, camera frame, m
  /// @param voxels  (512)
  /// @return the smallest d of the voxels that were seen; infinity if none was
  float (*fuse)(const FuseFrame& frame, const float* first, Voxel* voxels);
};

/// All kernels that this processor can run, the fastest first and the plain one last.
[[nodiscard]] std::span<const FuseKernel> fuse_kernels();

}  // namespace palpable
