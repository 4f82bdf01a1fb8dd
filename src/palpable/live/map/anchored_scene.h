/// @file
/// Does a point belong to the room in which the body was anchored, or has it come since? This is
/// the one object that answers that question (was_there()). docs/map.md compares it with the three
/// that answer questions near it: FreeSpace, MovingMask's StaticPicture and SceneCanvas. Contact
/// asks it through PressingMask. Session brings it up to date after every fused depth image, which
/// costs 0.2 to 0.9 ms each (docs/map.md).
///
/// World frame, m.
///
/// **Of the room** is
///   1. the surface that the map held when this was made;
///   2. a surface that is found later in space that was never seen free: a wall behind the camera.
/// **Come since** is
///   3. what stands before the room's surface, or where the camera once looked through; also after
///      it has settled there (FreeSpaceSettings::frames_to_settle) and the map holds it. The map
///      itself could not tell: in it, what is put down and left looks like the room.
/// A surface that is taken away no longer belongs to the room.
///
/// What is put down where nobody has looked yet cannot be told apart: it counts as of the room.
///
/// When a loop is closed (track/tracker.h), map and free space begin anew. What is remembered here
/// is moved with the keyframes by which it was placed. That the camera looked through some place is
/// forgotten, except near surfaces.
#pragma once

#include "palpable/common/geometry/correction.h"
#include "palpable/live/map/block_table.h"
#include "palpable/live/map/free_space.h"
#include "palpable/live/map/slab_store.h"
#include "palpable/live/map/surface_map.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

struct AnchoredSceneSettings {
  /// m: a surface of the room that lies farther back than it did by more than this was taken away.
  double step = 0.015;
  /// Updates in which every block's distances are compared with the map's once.
  int updates_per_round = 20;
};

/// Keeps a copy of the room's signed distance, one byte per voxel (0.5 KiB per block; the map has
/// 4), and per block which of its eighths had been seen free before the block came into the map.
class AnchoredScene {
 public:
  /// Anchors the body: all surface that `map` holds now is the room's.
  /// @throws ContractViolation for settings out of their range
  AnchoredScene(const SurfaceMap& map, const AnchoredSceneSettings& settings = {});

  /// Learns what has changed in map and free space. Call it after each depth image that was fused:
  /// a new block must be seen here before the camera has looked through its surroundings so often
  /// that they count as free, or the room's own surface would count as come since. Pass the same
  /// two objects each time; after follow() both may have begun anew.
  /// @param keyframe  frame number of the newest keyframe: new blocks were placed by its pose
  void update(const SurfaceMap& map, const FreeSpace& space, int keyframe = 0);

  /// A loop was closed: moves each block with the keyframe by which it was placed. Voxels are moved
  /// to the nearest ones, which is off by half a voxel's diagonal at most (9 mm for voxels of 10).
  /// Where two blocks come to lie at one place the older one counts: it had drifted less. What the
  /// map held when this was made moves with the first keyframe. Doubles the memory for a moment.
  /// @param corrections  at least one, their numbers rising
  void follow(std::span<const Correction> corrections);

  /// Answers for one point after the other, faster where they lie near each other. Valid until the
  /// next change of scene or space.
  class Reader;

  /// Whether what is seen at a point of the world belongs to the room in which the body was
  /// anchored.
  /// @param tolerance  m, >= 0: how far before the room's surface a measured point of that surface
  ///                   may lie
  [[nodiscard]] bool was_there(const Eigen::Vector3d& point, double tolerance,
                               const FreeSpace& space) const;

  [[nodiscard]] int blocks() const { return table_.count(); }
  [[nodiscard]] const AnchoredSceneSettings& settings() const { return settings_; }

 private:
  static constexpr std::int8_t kUnknown = -128;
  struct Block {
    std::array<std::int8_t, kVoxelsOfBlock> distance;  // 127: the truncation; kUnknown
    std::uint8_t was_free = 0;  // bit x + 2 y + 4 z: that eighth was seen free before the block
                                // came into the map, so what is there has come since
    bool mapped = false;        // the map has held it since the map began
    int keyframe = 0;           // frame number of the keyframe by which it was placed
    [[nodiscard]] bool has_come(std::size_t voxel) const {
      return (was_free >> eighth_of(voxel) & 1) != 0;
    }
  };
  [[nodiscard]] static int eighth_of(std::size_t voxel) {
    return static_cast<int>((voxel >> 2 & 1) | (voxel >> 5 & 1) << 1 | (voxel >> 8 & 1) << 2);
  }
  Block* insert(std::uint64_t key, int keyframe);
  [[nodiscard]] std::uint8_t free_eighths(std::uint64_t key, FreeSpace::Reader& space) const;
  void copy_new_distances(const SurfaceMap::BlockView& from, Block& to) const;
  void forget_what_has_gone(const SurfaceMap& map, FreeSpace::Reader& space);
  void move_block(std::uint64_t key, const Block& from, const Rigid3& world_from_drifted,
                  bool moves_distances);

  AnchoredSceneSettings settings_;
  double voxel_;      // m
  float per_m_;       // Block::distance has this many units per m
  std::int8_t step_;  // settings_.step in these units
  VoxelUnits units_;  // of the map
  BlockTable table_;
  SlabStore<Block> store_;
  int round_ = 0;  // updates so far, modulo updates_per_round
};

class AnchoredScene::Reader {
 public:
  Reader(const AnchoredScene& scene, const FreeSpace& space)
      : scene_(scene), space_(space), voxels_per_m_(static_cast<float>(1 / scene.voxel_)) {}

  /// As AnchoredScene::was_there.
  /// @param point  within 500 m of the world's origin
  [[nodiscard]] bool was_there(const Eigen::Vector3f& point, float tolerance) {
    const Eigen::Vector3f p = point * voxels_per_m_;
    const int x = floor_to_int(p.x()), y = floor_to_int(p.y()), z = floor_to_int(p.z());
    const std::uint64_t key = BlockTable::key_of(x >> 3, y >> 3, z >> 3);
    if (key != last_) {
      last_ = key;
      const int slot = scene_.table_.find(key);
      block_ = slot == BlockTable::kNone ? nullptr : &scene_.store_[slot];
    }
    if (block_ != nullptr) {
      // The surface is asked before the free space: on its way to a slanted surface a ray passes
      // through cells in which that surface lies a little later.
      const std::size_t i = voxel_index(x & 7, y & 7, z & 7);
      const std::int8_t count = block_->distance[i];
      if (count != kUnknown) {
        const float d = static_cast<float>(count) / scene_.per_m_;
        if (d > tolerance) return false;
        if (d >= -tolerance) return true;
      } else if (block_->has_come(i)) {
        return false;
      }
    }
    return !space_.was_free(point);
  }

 private:
  const AnchoredScene& scene_;
  FreeSpace::Reader space_;
  float voxels_per_m_;
  std::uint64_t last_ = ~std::uint64_t{0};
  const Block* block_ = nullptr;
};

}  // namespace palpable
