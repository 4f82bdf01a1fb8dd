/// @file
/// The space that has been seen free: a grid of cells, each with the number of frames in which the
/// camera looked through it. Anything that occupies such a cell later must have moved there, for
/// example a hand.
///
///     camera --- free --- free --- free --| margin |--- surface
///
/// World frame, m. Hornung et al. 2013 (OctoMap) keep the probability that a cell is occupied now.
/// The question here is whether it was ever free, which a count of frames answers.
#pragma once

#include "palpable/common/base/floor_to_int.h"
#include "palpable/common/base/huge_pages.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/map/block_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct FreeSpaceSettings {
  double cell = 0.04;      ///< m, side of a cell
  double farthest = 2.56;  ///< m of depth up to which rays are followed
  /// A ray counts as free up to max(margin, sigmas * sigma_Z) before its surface. If this is too
  /// small, depth noise marks the cells of the surface itself as free.
  double margin = 0.08;  ///< m
  double sigmas = 4;
  int frames_to_free = 4;  ///< frames that must look through a cell before it is free, 1 .. 255
  /// A free cell becomes occupied after this many successive frames in which rays ended in it and
  /// none passed through it: what was put there has become part of the scene. 1 .. 32767; near the
  /// camera 600 frames are 20 s at 30 frames per second. Frames without a ray in the cell are not
  /// counted; at 2 m those are about seven in eight.
  int frames_to_settle = 600;
  /// Blocks of 8 x 8 x 8 cells (0.32 m wide, 1.6 KiB each) that can be kept: 6.5 MiB.
  int blocks = 4096;
};

/// Allocates in its constructor only. When all blocks are in use, space that has no block yet stays
/// unknown, and blocked() counts the rays that needed one.
class FreeSpace {
 public:
  /// @throws ContractViolation for settings out of their range
  FreeSpace(const DepthNoise& noise, const FreeSpaceSettings& settings = {});

  /// Adds one frame: follows rays in steps of one cell. Each frame follows an eighth of the rays,
  /// and the next seven frames follow the others; neighbouring rays pass through the same cells, so
  /// little is lost.
  /// @param rays     one ray per pixel, e.g. the depth's camera scaled_down(8)
  /// @param surface  of the rays' size: depth at which each ray ends, m; rays with NaN (unknown)
  ///                 are skipped
  void add(const PinholeCamera& rays, const Rigid3& world_from_camera, const DepthImage& surface);

  /// Queries point by point; faster when consecutive points lie near each other. Valid until the
  /// next add().
  class Reader;

  /// Whether a point (world frame, m) lies in a cell that was seen free and in which nothing has
  /// settled since.
  [[nodiscard]] bool is_free(const Eigen::Vector3d& point) const;
  /// Whether a point (world frame, m) lies in a cell that was ever seen free.
  [[nodiscard]] bool was_free(const Eigen::Vector3d& point) const;

  [[nodiscard]] int blocks() const { return table_.count(); }
  /// Rays that were cut short because all blocks are in use.
  [[nodiscard]] std::int64_t blocked() const { return blocked_; }
  [[nodiscard]] const FreeSpaceSettings& settings() const { return settings_; }

 private:
  static constexpr int kSide = 8;
  static constexpr std::size_t kCells = kSide * kSide * kSide;
  static constexpr std::uint16_t kSettled = 1U << 15;
  // The cells through which one frame looked are marked with one bit each; the bits of a block fit
  // into one cache line. So neighbouring rays count a cell once, and the counts are written once
  // per frame.
  struct alignas(64) Block {
    std::array<std::uint64_t, kSide> met{};     // cells met by frame `frame`, one word for each z
    int frame = -1;                             // the last frame that looked into the block
    bool any_taken = false;                     // false: all counts in `taken` are 0
    std::array<std::uint8_t, kCells> free{};    // frames that looked through a cell, <= 255
    std::array<std::uint16_t, kCells> taken{};  // frames in a row in which a ray ended in it; bit
                                                // kSettled: it was free until something settled
  };
  // Positions in units of 1/65536 of a cell's side: 32 bits reach 1.3 km with cells of 4 cm.
  static constexpr int kFraction = 16;
  using Place = std::array<std::int32_t, 3>;
  [[nodiscard]] static std::uint64_t block_of(const Place& p) {
    constexpr int kShift = kFraction + 3;
    return BlockTable::key_of(p[0] >> kShift, p[1] >> kShift, p[2] >> kShift);
  }
  [[nodiscard]] static std::size_t part_of(std::int32_t a) {
    return static_cast<std::size_t>(a >> kFraction & 7);
  }
  // Index of the cell in its block: x runs fastest.
  [[nodiscard]] static std::size_t cell_of(const Place& p) {
    return part_of(p[0]) | part_of(p[1]) << 3 | part_of(p[2]) << 6;
  }
  // Whether two positions lie in the same block.
  [[nodiscard]] static bool same_block(const Place& a, const Place& b) {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) >> (kFraction + 3) == 0;
  }
  // Null for BlockTable::kNone.
  [[nodiscard]] const Block* block_in(int slot) const {
    return slot == BlockTable::kNone ? nullptr : &blocks_[slot];
  }
  [[nodiscard]] Block* block_in(int slot) {
    return slot == BlockTable::kNone ? nullptr : &blocks_[slot];
  }
  // Each frame follows one ray of every 4 x 2.
  static constexpr int kTurnsX = 4, kTurnsY = 2;
  [[nodiscard]] int turn_x() const { return (frame_ - 1) % kTurnsX; }
  [[nodiscard]] int turn_y() const { return (frame_ - 1) / kTurnsX % kTurnsY; }
  class Rays;
  Block* begin_block(Block* block);
  void walk(const Rays& rays, const DepthImage& surface, RecentBlocks<Block>& recent);
  void count_ends(const Rays& rays, const DepthImage& surface, RecentBlocks<Block>& recent);
  static void count_met_cells(Block& block);

  DepthNoise noise_;
  FreeSpaceSettings settings_;
  BlockTable table_;
  std::vector<Block, HugePageAllocator<Block>> blocks_;
  std::vector<Block*> met_;  // blocks into which the last frame looked
  int frame_ = 0;            // frames so far
  std::int64_t blocked_ = 0;
};

class FreeSpace::Reader {
 public:
  explicit Reader(const FreeSpace& space)
      : space_(space), scale_(static_cast<float>((1 << kFraction) / space.settings_.cell)) {}

  /// @param point  world, m; within 500 m of its origin
  [[nodiscard]] bool is_free(const Eigen::Vector3f& point) {
    const std::size_t cell = cell_at(point);
    return block_ != nullptr && block_->free[cell] >= space_.settings_.frames_to_free;
  }
  [[nodiscard]] bool was_free(const Eigen::Vector3f& point) {
    const std::size_t cell = cell_at(point);
    return block_ != nullptr && (block_->free[cell] >= space_.settings_.frames_to_free ||
                                 (block_->taken[cell] & kSettled) != 0);
  }

 private:
  // Finds the block of a point, which is null where nothing was seen, and the cell in it.
  [[nodiscard]] std::size_t cell_at(const Eigen::Vector3f& point) {
    const Place p{floor_to_int(point.x() * scale_), floor_to_int(point.y() * scale_),
                  floor_to_int(point.z() * scale_)};
    if (const std::uint64_t key = block_of(p); key != last_) {
      last_ = key;
      block_ = recent_.of(key, [&] { return space_.block_in(space_.table_.find(key)); });
    }
    return cell_of(p);
  }

  const FreeSpace& space_;
  RecentBlocks<const Block> recent_;
  float scale_;
  std::uint64_t last_ = ~std::uint64_t{0};
  const Block* block_ = nullptr;
};

}  // namespace palpable
