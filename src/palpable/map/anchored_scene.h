/// @file
/// What belongs to the room in which a body was anchored, and what has come since. The map itself
/// does not say it: what is put down and left takes its place there.
///
/// World frame, m.
///
/// **Of the room** is
///   1. the surface that the map held when this was made;
///   2. what is found later in space that was never seen free: a wall behind the camera's back.
/// **Come since** is
///   3. what stands before the room's surface, or where the camera once looked through, also when
///      it has settled there (FreeSpaceSettings::frames_to_settle) and the map has taken it in.
/// What is taken away from the room belongs to it no more.
///
/// It cannot know what is put down where nobody has looked yet: that is of the room.
///
/// When a loop is closed (track/tracker.h) map and free space begin anew. What is remembered here
/// moves with the keyframes by which it was placed; where the camera has looked through, beyond the
/// surfaces' own surroundings, is forgotten.
#pragma once

#include "palpable/geometry/correction.h"
#include "palpable/map/block_table.h"
#include "palpable/map/free_space.h"
#include "palpable/map/slab_store.h"
#include "palpable/map/surface_map.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

struct AnchoredSceneSettings {
  /// A surface of the room that has gone back by more than this was taken away, m.
  double step = 0.015;
  /// Every block's distances are looked at once in so many updates.
  int updates_per_round = 20;
};

/// Keeps the room's signed distance apart from the map's, a byte per voxel (0.5 KiB per block
/// against the map's 6), and which cells were free when a block first came into the map.
class AnchoredScene {
 public:
  /// The body is anchored now: all surface that `map` holds is the room's.
  /// @throws ContractViolation for settings out of their range
  AnchoredScene(const SurfaceMap& map, const AnchoredSceneSettings& settings = {});

  /// Takes in what has become of map and free space. Call it after each depth image that went into
  /// the map: a block must be seen before the camera has looked through its surroundings so often
  /// that they count as free. Always the same two; both may have begun anew after follow().
  /// @param keyframe  frame number of the newest keyframe: what is new was placed by it
  void update(const SurfaceMap& map, const FreeSpace& space, int keyframe = 0);

  /// A loop was closed: moves what is remembered, each block with the keyframe by which it was
  /// placed, to the nearest voxels (off by half a voxel's diagonal, 9 mm of 10, at most). Where two
  /// blocks come to lie at one place the older one counts: it drifted less. What the map held when
  /// this was made goes with the first keyframe. Takes memory: as much again, for a moment.
  /// @param corrections  at least one, their numbers rising
  void follow(std::span<const Correction> corrections);

  /// Answers for one point after the other; quick where they lie near each other. Valid until the
  /// next change of scene or space.
  class Reader;

  /// Whether what is seen at a point of the world was there when the body was anchored.
  /// @param tolerance  m, >= 0: how far before the room's surface a measured point of it may lie
  [[nodiscard]] bool was_there(const Eigen::Vector3d& point, double tolerance,
                               const FreeSpace& space) const;

  [[nodiscard]] int blocks() const { return table_.count(); }
  [[nodiscard]] const AnchoredSceneSettings& settings() const { return settings_; }

 private:
  static constexpr std::int8_t kUnknown = -128;
  struct Block {
    std::array<std::int8_t, kVoxelsOfBlock> distance;  // 127 is the truncation
    std::uint8_t came = 0;  // bit x + 2 y + 4 z: that eighth was free before it came into the map
    bool mapped = false;    // the map has held it since it began
    int keyframe = 0;       // by which it was placed
    [[nodiscard]] bool has_come(std::size_t voxel) const {
      return (came >> eighth_of(voxel) & 1) != 0;
    }
  };
  [[nodiscard]] static int eighth_of(std::size_t voxel) {
    return static_cast<int>((voxel >> 2 & 1) | (voxel >> 5 & 1) << 1 | (voxel >> 8 & 1) << 2);
  }
  Block* insert(std::uint64_t key, int keyframe);
  [[nodiscard]] std::uint8_t free_eighths(std::uint64_t key, FreeSpace::Reader& space) const;
  void take(const SurfaceMap::BlockView& from, Block& to) const;

  AnchoredSceneSettings settings_;
  double voxel_;      // m
  float per_m_;       // counts of a distance
  std::int8_t step_;  // counts
  VoxelUnits units_;  // of the map
  BlockTable table_;
  SlabStore<Block> store_;
  int round_ = 0;
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
      // The surface first: at a slanted one rays pass through the very cells in which it lies.
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
