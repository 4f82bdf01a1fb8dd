/// @file
/// One voxel of the map in 32 bits: a look-up touches one cache line, and fusing a depth image
/// moves half the bytes that two floats would need.
///
///   bits  0 .. 15  signed distance, in units of 1/32767 of the largest distance
///   bits 16 .. 31  weight, in units of 1/65535 of the largest weight; 0: never seen
///
/// With a largest distance of 100 mm and a largest weight of 64 frames the units are 3 um and 0.001
/// frames.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>

namespace palpable {

/// A block has 8 x 8 x 8 voxels, x runs fastest.
inline constexpr int kVoxelsAcross = 8;
inline constexpr std::size_t kVoxelsOfBlock = 512;

/// Index in its block of the voxel at (x, y, z), each in [0, 8); place_in_block() is the inverse.
[[nodiscard]] inline std::size_t voxel_index(int x, int y, int z) {
  const int index = x + kVoxelsAcross * (y + kVoxelsAcross * z);
  return static_cast<std::size_t>(index);
}
[[nodiscard]] inline Eigen::Vector3i place_in_block(std::size_t voxel) {
  const auto i = static_cast<int>(voxel);
  return {i & 7, i >> 3 & 7, i >> 6};
}

using Voxel = std::uint32_t;

/// The units in which a map's voxels hold distance and weight.
struct VoxelUnits {
  static constexpr float kLargestDistance = 32767, kMostWeight = 65535;  ///< in units
  float distance = 1;                                                    ///< m
  float weight = 1;                                                      ///< frames

  /// @param largest_distance  m
  /// @param most_weight       frames
  [[nodiscard]] static constexpr VoxelUnits of(double largest_distance, double most_weight) {
    return {static_cast<float>(largest_distance / kLargestDistance),
            static_cast<float>(most_weight / kMostWeight)};
  }
  [[nodiscard]] constexpr float largest_distance() const { return kLargestDistance * distance; }
  [[nodiscard]] constexpr float most_weight() const { return kMostWeight * weight; }

  /// m, positive on the camera's side of the surface; meaningful where was_seen().
  [[nodiscard]] constexpr float distance_of(Voxel voxel) const {
    return distance * static_cast<float>(static_cast<std::int16_t>(voxel & 0xFFFF));
  }
  [[nodiscard]] constexpr float weight_of(Voxel voxel) const {
    return weight * static_cast<float>(voxel >> 16);
  }
};

[[nodiscard]] constexpr bool was_seen(Voxel voxel) { return voxel >> 16 != 0; }

}  // namespace palpable
