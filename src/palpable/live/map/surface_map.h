/// @file
/// The surface of the static scene: a signed distance to it, fused from depth images (Curless and
/// Levoy 1996, "A volumetric method for building complex models from range images"). It is kept
/// only near the surface, in hashed blocks of 8 x 8 x 8 voxels (Niessner et al. 2013).
///
/// World frame, m. Moving things are left out by a mask. If the mask missed one and it was fused,
/// it is carved away as soon as the camera looks through the space that it occupied.
#pragma once

#include "palpable/common/base/floor_to_int.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/map/block_table.h"
#include "palpable/live/map/fuse_kernels.h"
#include "palpable/live/map/slab_store.h"
#include "palpable/live/map/voxel.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {

struct SurfaceMapSettings {
  double voxel = 0.01;    ///< m, side of a voxel
  double farthest = 3.0;  ///< m; depths beyond are not fused
  /// Distances are kept up to max(truncation, truncation_sigmas * sigma_Z) from the surface.
  double truncation = 0.04;  ///< m; at least 3 voxels
  double truncation_sigmas = 2;
  /// m; depths with a larger sigma are not fused: they do not even determine the surface's block.
  double largest_sigma = 0.05;
  double best_sigma = 0.003;  ///< m; depths with a smaller sigma have the full weight 1
  double most_weight = 64;    ///< frames; limit of a voxel's weight. Larger: smoother, slower
  double carve_weight = 4;    ///< frames; limit of the old weight when a voxel is seen free
  /// Blocks that can be kept, 4 KiB each: 64 MiB. When all are in use, surfaces in new blocks are
  /// not fused, and refused() counts them.
  int blocks = 16384;
};

/// A surface with the colours of its vertices.
struct ColoredSurface {
  SurfaceMesh surface;
  std::vector<Rgb> colors;  ///< (N)
};

class SurfaceMap {
 public:
  /// @throws ContractViolation for settings out of their range
  SurfaceMap(const DepthNoise& noise, const SurfaceMapSettings& settings = {});

  /// Fuses one depth image.
  /// @param moving  of the depth's size, or empty: 255 where the depth belongs to a moving thing
  /// @param color   empty, or the depth's size times an integer
  void fuse(const DepthImage& depth, const PinholeCamera& camera, const Rigid3& world_from_camera,
            const MaskImage& moving = {}, const ColorImage& color = {});

  /// Queries point by point; faster when consecutive points lie near each other. Valid until the
  /// next fuse().
  class Reader;

  /// Signed distance at the voxel in which a point lies, m, positive before the surface; nothing
  /// where no distance is kept.
  [[nodiscard]] std::optional<double> distance(const Eigen::Vector3d& point) const;

  /// The surface where the distance is 0, by surface nets (Gibson 1998): each cell of 2 x 2 x 2
  /// voxels with both signs has one vertex, the mean of the points where its edges cross 0.
  /// Triangles are counter-clockwise seen from the camera's side. Voxels with a weight below
  /// `least_weight` frames are left out.
  [[nodiscard]] ColoredSurface mesh(double least_weight = 1.0) const;

  /// Copies some blocks into another map, so that a thread can work on a copy while this map goes
  /// on growing. Begin with first = 0 and an empty map.
  /// @param first  slot of the table to begin with
  /// @param count  largest number of blocks to copy, >= 1
  /// @return the slot at which to continue; capacity() when all blocks have been copied
  int copy_blocks(int first, int count, SurfaceMap& to) const;
  /// Removes all blocks; keeps the memory.
  void clear();

  /// Whether a voxel's weight is at least that of `frames` depths with the standard deviation
  /// `sigma` (m).
  [[nodiscard]] bool weighs(Voxel voxel, float frames, float sigma) const {
    const auto best = static_cast<float>(settings_.best_sigma);
    // w >= frames min(1, (best / sigma)^2), without a division: the mask calls it for each tile.
    return units_.weight_of(voxel) * (sigma * sigma) >=
           frames * std::min(sigma * sigma, best * best);
  }

  /// One block of 8 x 8 x 8 voxels, x runs fastest.
  struct BlockView {
    std::uint64_t key = 0;          ///< BlockTable::key_of its position, in blocks from the origin
    const Voxel* voxels = nullptr;  ///< (512) in units()
  };
  /// The block in a slot of the map's table, [0, capacity()); nothing where the slot is empty.
  [[nodiscard]] std::optional<BlockView> block_in(int slot) const;
  [[nodiscard]] bool holds_block(std::uint64_t key) const {
    return table_.find(key) != BlockTable::kNone;
  }

  [[nodiscard]] int blocks() const { return table_.count(); }
  [[nodiscard]] int capacity() const { return table_.capacity(); }
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] const VoxelUnits& units() const { return units_; }
  /// How often a block was needed while all were in use.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] const SurfaceMapSettings& settings() const { return settings_; }

 private:
  struct Block {
    std::array<Voxel, kVoxelsOfBlock> voxels;
    std::array<std::uint8_t, 4 * kVoxelsOfBlock> color;  // r g b, and the number of frames
    int colored = 0;                                     // frames that have coloured any voxel
  };
  struct InView {
    int slot;
    Eigen::Vector3f first;  // the middle of its first voxel, camera frame, m
  };
  class Mesher;
  // For each step along a ray, the block in which the previous ray was at that step. Most often the
  // present ray is in the same block, which then need not be looked up.
  using BlocksOfLastRay = std::array<std::uint64_t, 16>;
  void allocate(const PinholeCamera& camera, const Rigid3& world_from_camera);
  void allocate_along(const Eigen::Vector3d& first, const Eigen::Vector3d& step, int steps,
                      BlocksOfLastRay& last);
  void set_offsets(const Rigid3& camera_from_world);
  [[nodiscard]] FuseFrame fuse_frame(const PinholeCamera& camera) const;
  void find_blocks_in_view(const PinholeCamera& camera, const Rigid3& camera_from_world);
  // A new block with undefined content; null when all are in use.
  Block* insert(std::uint64_t key);
  // Upper bound of the slots in use.
  [[nodiscard]] int used_slots() const { return std::min(store_.slots(), table_.capacity()); }
  [[nodiscard]] bool may_show(const PinholeCamera& camera, const Eigen::Vector3d& centre) const;
  void paint(Block& block, const Eigen::Vector3f& first, const PinholeCamera& camera,
             const ColorImage& color);

  DepthNoise noise_;
  SurfaceMapSettings settings_;
  double farthest_ = 0;  // m: settings_.farthest, or the depth at which sigma is largest_sigma
  VoxelUnits units_;
  const FuseKernel* kernel_;
  BlockTable table_;
  SlabStore<Block> store_;
  std::vector<InView> in_view_;
  RecentBlocks<const Block> last_fused_;  // initial cache of readers, which mostly need these
  DepthImage static_depth_;               // the last depth image without moving things
  // From a block's first voxel to each voxel of it, x y z, camera frame, m.
  std::array<std::array<float, kVoxelsOfBlock>, 3> offsets_{};
  std::int64_t refused_ = 0;
  int fused_ = 0;  // depth images so far
};

class SurfaceMap::Reader {
 public:
  explicit Reader(const SurfaceMap& map)
      : map_(map),
        recent_(map.last_fused_),
        voxels_per_m_(static_cast<float>(1 / map.settings_.voxel)) {}

  /// The voxel in which a point lies; null where none is kept.
  /// @param point  world, m; within 5 km of its origin
  [[nodiscard]] const Voxel* voxel(const Eigen::Vector3f& point) {
    const Eigen::Vector3f p = point * voxels_per_m_;
    return voxel(floor_to_int(p.x()), floor_to_int(p.y()), floor_to_int(p.z()));
  }

 private:
  friend class SurfaceMap;
  // The block of voxel (x, y, z), counted from the world's origin; or null.
  [[nodiscard]] const Block* block(int x, int y, int z) {
    const std::uint64_t key = BlockTable::key_of(x >> 3, y >> 3, z >> 3);
    if (key != last_) {
      last_ = key;
      block_ = recent_.of(key, [&]() -> const Block* {
        const int slot = map_.table_.find(key);
        return slot == BlockTable::kNone ? nullptr : &map_.store_[slot];
      });
    }
    return block_;
  }
  // Voxel (x, y, z), counted from the world's origin; or null.
  [[nodiscard]] const Voxel* voxel(int x, int y, int z) {
    const Block* b = block(x, y, z);
    return b == nullptr ? nullptr : &b->voxels[voxel_index(x & 7, y & 7, z & 7)];
  }
  // Sets `distance` if the voxel weighs enough; false otherwise.
  bool read(int x, int y, int z, float least_weight, float& distance) {
    const Voxel* v = voxel(x, y, z);
    if (v == nullptr || !(map_.units_.weight_of(*v) >= least_weight)) return false;
    distance = map_.units_.distance_of(*v);
    return true;
  }

  const SurfaceMap& map_;
  RecentBlocks<const Block> recent_;
  float voxels_per_m_;
  std::uint64_t last_ = ~std::uint64_t{0};
  const Block* block_ = nullptr;
};

}  // namespace palpable
