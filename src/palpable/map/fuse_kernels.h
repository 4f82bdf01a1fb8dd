/// @file
/// The inner loop of the map, once plain and once for each set of vector instructions; all give
/// the same bytes: the same operations in the same order, none fused.
#pragma once

#include "palpable/map/voxel.h"

#include <cstddef>
#include <span>

namespace palpable {

/// What all blocks of one depth image share. Lengths in m, camera frame.
struct FuseFrame {
  const float* depth = nullptr;  ///< (width x height) Z, NaN: unknown or not to be taken
  int width = 0;
  int height = 0;
  float fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  float nearest = 0;   ///< voxels nearer to the camera than this are not looked at
  float farthest = 0;  ///< depths beyond are not taken
  /// sigma_Z(Z) = noise[0] + Z (noise[1] + Z noise[2])
  float noise[3] = {0, 0, 0};
  float truncation = 0;         ///< at least
  float truncation_sigmas = 0;  ///< and so many sigma
  float best_sigma = 0;         ///< up to it a depth has weight 1, beyond (best_sigma / sigma)^2
  float carve_weight = 0;       ///< how many such frames a voxel may weigh against being seen free
  VoxelUnits units;             ///< of (most_distance, most_weight)
  /// (512) each: from a block's first voxel to voxel i.
  const float* offset_x = nullptr;
  const float* offset_y = nullptr;
  const float* offset_z = nullptr;
};

struct FuseKernel {
  const char* name = "";
  /// Takes one depth image into one block:
  ///
  ///     s = Z(pixel of the voxel) - z(voxel)
  ///     t = min(max(truncation, sigmas * sigma_Z(Z)), largest distance)
  ///     s < -t           hidden behind the surface: nothing is learnt
  ///     |s| <= t         d <- (w d + v s) / (w + v),  w <- min(w + v, most weight)
  ///     s > t            seen free: the same with s = t and w <- min(w, carve_weight v) before
  ///
  /// with v = min(1, (best_sigma / sigma)^2): Curless and Levoy 1996, weights by the variance,
  /// which is sigma_Z(Z) at a surface; what is seen free is as sure as a measurement there would
  /// be, however far the surface behind it: sigma_Z(z).
  /// d and w are rounded to their units; w to one at least.
  /// @param first   (3) the block's first voxel, camera frame, m
  /// @param voxels  (512)
  /// @return the smallest d of the voxels that were seen; infinity if none was
  float (*fuse)(const FuseFrame& frame, const float* first, Voxel* voxels);
};

/// All that this processor can run, the best first and the plain one last.
[[nodiscard]] std::span<const FuseKernel> fuse_kernels();

}  // namespace palpable
