/// @file
/// Decides whether a point belongs to the room in which the body was anchored or to something that
/// arrived later (was_there()). docs/map.md compares this class with the three that answer similar
/// questions: FreeSpace, MovingMask's StaticPicture and SceneCanvas. Contact queries it through
/// PressingMask. Session updates it after every fused depth image, which costs 0.2 to 0.9 ms each
/// (docs/map.md).
///
/// World frame, m.
///
/// **Part of the room** is
///   1. the surface that the map held when this object was constructed;
///   2. a surface that is found later in space that was never seen free: a wall behind the camera.
/// **Arrived later** is
///   3. what stands in front of the room's surface, or in space through which the camera once
///      looked. This still holds after it has settled there (FreeSpaceSettings::frames_to_settle)
///      and the map contains it; the map alone could not distinguish it from the room.
/// A surface that is taken away no longer belongs to the room.
///
/// Limit: what is put down in space that was never in view counts as part of the room.
///
/// When a loop is closed (track/tracker.h), map and free space are rebuilt from nothing. The
/// distances stored here are moved together with the keyframes by which they were placed. The
/// record of which space was seen free is lost, except near surfaces.
#pragma once

#include "palpable/common/geometry/rigid.h"
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
  /// Where the mapped surface has receded by more than this, m, the room's old surface counts as
  /// removed. Smaller: measurement noise removes it. Larger: thin things stay after their removal.
  double step = 0.015;
  /// Updates in which the distances of every block are compared with the map's once.
  int updates_per_round = 20;
};

/// Keeps a copy of the room's signed distance, one byte per voxel (0.5 KiB per block; the map needs
/// 4 KiB), and for each block which of its eighths were seen free before the map contained it.
class AnchoredScene {
 public:
  /// Anchors the body: all surfaces that `map` holds now are part of the room.
  /// @throws ContractViolation for settings out of their range
  AnchoredScene(const SurfaceMap& map, const AnchoredSceneSettings& settings = {});

  /// Takes over what has changed in map and free space. Call it after each fused depth image: a new
  /// block must be registered here before the camera has looked through its surroundings often
  /// enough for them to count as free; otherwise the room's own surface would count as arrived
  /// later. Pass the same two objects each time; after follow() both may have been cleared.
  /// @param keyframe  frame number of the newest keyframe, by whose pose new blocks were placed
  void update(const SurfaceMap& map, const FreeSpace& space, int keyframe = 0);

  /// Call it after a loop was closed: moves each block with the keyframe by which it was placed.
  /// Each voxel moves to the nearest voxel of the new grid, an error of at most half a voxel's
  /// diagonal (9 mm for voxels of 10 mm). Where two blocks come to lie at the same position the
  /// older one is kept, because it had drifted less. Blocks from the constructor move with the
  /// first keyframe. Memory use doubles during the call.
  /// @param corrections  at least one, in rising order of their frame numbers
  void follow(std::span<const Correction> corrections);

  /// Queries point by point; faster when consecutive points lie near each other. Valid until scene
  /// or space changes.
  class Reader;

  /// Whether a surface that is measured at this point (world frame, m) belongs to the room in which
  /// the body was anchored.
  /// @param tolerance  m, >= 0: a measured point of the room's surface may lie this far in front of
  ///                   that surface
  [[nodiscard]] bool was_there(const Eigen::Vector3d& point, double tolerance,
                               const FreeSpace& space) const;

  [[nodiscard]] int blocks() const { return table_.count(); }
  [[nodiscard]] const AnchoredSceneSettings& settings() const { return settings_; }

 private:
  static constexpr std::int8_t kUnknown = -128;
  struct Block {
    std::array<std::int8_t, kVoxelsOfBlock> distance;  // 127: the truncation; or kUnknown
    std::uint8_t was_free = 0;  // bit x + 2 y + 4 z: that eighth was seen free before the map
                                // contained the block, so what is there arrived later
    bool mapped = false;        // the map has contained it since the map was last cleared
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
  std::int8_t step_;  // settings_.step in the units of Block::distance
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
      // The stored surface has priority over the free space: on its way to a slanted surface a ray
      // passes through cells that also contain a part of that surface.
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
