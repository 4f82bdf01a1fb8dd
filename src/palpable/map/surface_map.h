/// @file
/// The static scene as a signed distance to its surface, fused from depth images (Curless and Levoy
/// 1996, "A volumetric method for building complex models from range images"), kept only near the
/// surface in hashed blocks of 8 x 8 x 8 voxels (Niessner et al. 2013).
///
/// World frame, m. What moves is left out by its mask, and what was left behind all the same is
/// carved away once the camera sees through it.
#pragma once

#include "palpable/base/floor_to_int.h"
#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/geometry/surface_mesh.h"
#include "palpable/map/block_table.h"
#include "palpable/map/fuse_kernels.h"
#include "palpable/map/slab_store.h"
#include "palpable/map/voxel.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {

struct SurfaceMapSettings {
  double voxel = 0.01;           ///< m
  double farthest = 3.0;         ///< m; depths beyond are not taken
  double truncation = 0.04;      ///< m; distances are kept up to this, at least 3 voxels
  double truncation_sigmas = 2;  ///< and up to so many sigma of the depth
  /// Depths that scatter more are not taken, m: they would say less than a block is wide.
  double largest_sigma = 0.05;
  double best_sigma = 0.003;  ///< m; up to it a depth has the full weight 1
  double most_weight = 64;    ///< of a voxel: how many frames it remembers
  double carve_weight = 4;    ///< frames that a voxel remembers once the camera sees through it
  /// Blocks that are kept at most, 4 KiB each: 64 MiB. When they are used up, what is new is not
  /// taken, and refused() counts.
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

  /// Takes in one depth image.
  /// @param moving  of the depth's size, or empty: 255 where a depth is not to be taken
  /// @param color   empty, or of the depth's size times a whole number
  void fuse(const DepthImage& depth, const PinholeCamera& camera, const Rigid3& world_from_camera,
            const MaskImage& moving = {}, const ColorImage& color = {});

  /// Answers for one point after the other; quick where they lie near each other. Valid until the
  /// next fuse().
  class Reader;

  /// Signed distance at the voxel nearest to a point, m, positive before the surface; nothing where
  /// none is kept.
  [[nodiscard]] std::optional<double> distance(const Eigen::Vector3d& point) const;

  /// The surface where the distance is 0, by surface nets (Gibson 1998): one vertex in each cell of
  /// eight voxels with both signs, the mean of the crossings of its edges. Counter-clockwise seen
  /// from the camera's side. Only between voxels that weigh `least_weight` or more.
  [[nodiscard]] ColoredSurface mesh(double least_weight = 1.0) const;

  /// Copies some blocks into another map, a few at a time, so that a thread can look at a map that
  /// goes on growing. Begin with first = 0 and an empty map.
  /// @param first  slot of the table to begin with
  /// @param count  blocks to copy at most, >= 1
  /// @return the slot to go on from; capacity() when nothing is left
  int copy_blocks(int first, int count, SurfaceMap& to) const;
  /// Forgets everything; keeps the memory.
  void clear();

  /// Whether a voxel weighs as much as so many frames with a depth that scatters by `sigma` (m)
  /// give it.
  [[nodiscard]] bool weighs(Voxel voxel, float frames, float sigma) const {
    const auto best = static_cast<float>(settings_.best_sigma);
    // w >= frames min(1, (best / sigma)^2), without a division: it is asked for each tile.
    return units_.weight_of(voxel) * (sigma * sigma) >=
           frames * std::min(sigma * sigma, best * best);
  }

  /// One block of 8 x 8 x 8 voxels, x running fastest, in slot [0, capacity) of the map's table.
  struct BlockView {
    std::uint64_t key = 0;          ///< BlockTable::key_of its place, in blocks from the origin
    const Voxel* voxels = nullptr;  ///< (512) in units()
  };
  /// Nothing where the slot is empty.
  [[nodiscard]] std::optional<BlockView> block_in(int slot) const;
  [[nodiscard]] bool holds_block(std::uint64_t key) const {
    return table_.find(key) != BlockTable::kNone;
  }

  [[nodiscard]] int blocks() const { return table_.count(); }
  [[nodiscard]] int capacity() const { return table_.capacity(); }
  [[nodiscard]] const DepthNoise& noise() const { return noise_; }
  [[nodiscard]] const VoxelUnits& units() const { return units_; }
  /// Blocks that were wanted and not to be had.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] const SurfaceMapSettings& settings() const { return settings_; }

 private:
  struct Block {
    std::array<Voxel, kVoxelsOfBlock> voxels;
    std::array<std::uint8_t, 4 * kVoxelsOfBlock> color;  // r g b and how many were averaged
    int colored = 0;                                     // frames that have given colour
  };
  struct InView {
    int slot;
    Eigen::Vector3f first;  // voxel, camera frame, m
  };
  void allocate(const PinholeCamera& camera, const Rigid3& world_from_camera);
  // A block that is not there yet, its content undefined; null when all are in use.
  Block* insert(std::uint64_t key);
  // All blocks that are in use lie before this slot.
  [[nodiscard]] int used_slots() const { return std::min(store_.slots(), table_.capacity()); }
  [[nodiscard]] bool may_show(const PinholeCamera& camera, const Eigen::Vector3d& centre) const;
  void paint(Block& block, const Eigen::Vector3f& first, const PinholeCamera& camera,
             const ColorImage& color);

  DepthNoise noise_;
  SurfaceMapSettings settings_;
  double farthest_ = 0;  // settings_.farthest, or where sigma reaches its largest
  VoxelUnits units_;
  const FuseKernel* kernel_;
  BlockTable table_;
  SlabStore<Block> store_;
  std::vector<InView> in_view_;
  RecentBlocks<const Block> last_fused_;  // most of what is asked for next
  DepthImage taken_;                      // the depth that is fused: without what moves
  std::array<std::array<float, kVoxelsOfBlock>, 3> offsets_{};
  std::int64_t refused_ = 0;
  int fused_ = 0;  // depth images
};

class SurfaceMap::Reader {
 public:
  explicit Reader(const SurfaceMap& map)
      : map_(map),
        recent_(map.last_fused_),
        voxels_per_m_(static_cast<float>(1 / map.settings_.voxel)) {}

  /// The voxel nearest to a point; null where none is kept.
  /// @param point  world, m; within 5 km of its origin
  [[nodiscard]] const Voxel* voxel(const Eigen::Vector3f& point) {
    const Eigen::Vector3f p = point * voxels_per_m_;
    return voxel(floor_to_int(p.x()), floor_to_int(p.y()), floor_to_int(p.z()));
  }

 private:
  friend class SurfaceMap;
  // The block of voxel (x, y, z) of the whole grid, or null.
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
  // Voxel (x, y, z) of the whole grid, or null.
  [[nodiscard]] const Voxel* voxel(int x, int y, int z) {
    const Block* b = block(x, y, z);
    return b == nullptr ? nullptr : &b->voxels[voxel_index(x & 7, y & 7, z & 7)];
  }
  // Sets `distance` if the voxel weighs enough; otherwise says false.
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
