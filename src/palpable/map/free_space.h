/// @file
/// Where the scene has been seen free: a grid of cells that remembers through which of them the
/// camera looked. What later stands in such a cell has come there, whatever it is: a hand.
///
/// World frame, m. Hornung et al. 2013 (OctoMap) keep the probability that a cell is taken; here
/// it is a count of frames, since the question is not whether a cell is free now but whether it
/// ever was.
#pragma once

#include "palpable/base/floor_to_int.h"
#include "palpable/base/huge_pages.h"
#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/block_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct FreeSpaceSettings {
  double cell = 0.04;      ///< m, side of a cell
  double farthest = 2.56;  ///< m of depth up to which rays are followed
  /// A ray is free up to this far before the surface, m, and at least so many sigma of the depth:
  /// less, and a surface's own noise would free the cells that it lies in.
  double margin = 0.08;
  double sigmas = 4;
  int frames_to_free = 4;  ///< in which a cell was looked through until it counts as free, 1 .. 255
  /// After so many frames in a row in which something ended in a free cell and nothing was seen
  /// through it, it is free no more: what was put there is part of the scene (20 s at 30 fps near
  /// the camera; frames without a ray through the cell do not count, about seven in eight at 2 m).
  /// 1 .. 32767.
  int frames_to_settle = 600;
  int blocks = 4096;  ///< of 8 x 8 x 8 cells (0.32 m, 1.6 KiB) that are kept at most: 6.5 MiB
};

/// Takes all its memory when it is made. When the blocks are used up, space that was never seen
/// stays unknown, and blocked() counts.
class FreeSpace {
 public:
  /// @throws ContractViolation for settings out of their range
  FreeSpace(const DepthNoise& noise, const FreeSpaceSettings& settings = {});

  /// Takes in what one frame shows: walks each ray in steps of one cell. Looks at an eighth of the
  /// rays, in the next frames at the others: neighbours pass through the same cells.
  /// @param rays     a ray per pixel, e.g. the depth's camera scaled_down(8)
  /// @param surface  of the rays' size: depth at which each ray ends, m; NaN: unknown, and nothing
  ///                 is learnt from it
  void add(const PinholeCamera& rays, const Rigid3& world_from_camera, const DepthImage& surface);

  /// Answers for one point after the other; quick where they lie near each other. Valid until the
  /// next add().
  class Reader;

  /// Whether a point of the world lies in a cell that was seen free.
  [[nodiscard]] bool is_free(const Eigen::Vector3d& point) const;
  /// Whether it lies in one that ever was, even if something has settled there since.
  [[nodiscard]] bool was_free(const Eigen::Vector3d& point) const;

  [[nodiscard]] int blocks() const { return table_.count(); }
  /// Rays that were cut short because all blocks are in use.
  [[nodiscard]] std::int64_t blocked() const { return blocked_; }
  [[nodiscard]] const FreeSpaceSettings& settings() const { return settings_; }

 private:
  static constexpr int kSide = 8;
  static constexpr std::size_t kCells = kSide * kSide * kSide;
  static constexpr std::uint16_t kSettled = 1U << 15;
  // Which cells a frame looked through is a bit each, a line of the cache for all: rays that pass
  // close by each other are counted once, and the counts are met once a frame.
  struct alignas(64) Block {
    std::array<std::uint64_t, kSide> met{};  // by frame `frame`; a word for each z
    int frame = -1;
    bool any_taken = false;                     // if not, all of `taken` is 0 but for kSettled
    std::array<std::uint8_t, kCells> free{};    // in how many frames it was looked through, <= 255
    std::array<std::uint16_t, kCells> taken{};  // in how many in a row something ended in it, and
                                                // kSettled: it was free until something settled
  };
  // Cells are counted in 1/65536 of their side: 32 bits reach 1.3 km at 4 cm.
  static constexpr int kFraction = 16;
  using Place = std::array<std::int32_t, 3>;
  [[nodiscard]] static std::uint64_t block_of(const Place& p) {
    constexpr int kShift = kFraction + 3;
    return BlockTable::key_of(p[0] >> kShift, p[1] >> kShift, p[2] >> kShift);
  }
  [[nodiscard]] static std::size_t part_of(std::int32_t a) {
    return static_cast<std::size_t>(a >> kFraction & 7);
  }
  // In a block: x runs fastest.
  [[nodiscard]] static std::size_t cell_of(const Place& p) {
    return part_of(p[0]) | part_of(p[1]) << 3 | part_of(p[2]) << 6;
  }
  // Whether two places lie in one block.
  [[nodiscard]] static bool same_block(const Place& a, const Place& b) {
    return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) >> (kFraction + 3) == 0;
  }
  // Null for BlockTable::kNone.
  [[nodiscard]] const Block* block_in(int slot) const {
    return slot == BlockTable::kNone ? nullptr : &blocks_[static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] Block* block_in(int slot) {
    return slot == BlockTable::kNone ? nullptr : &blocks_[static_cast<std::size_t>(slot)];
  }
  Block* meet(Block* block);
  static void count(Block& block);

  DepthNoise noise_;
  FreeSpaceSettings settings_;
  BlockTable table_;
  std::vector<Block, HugePageAllocator<Block>> blocks_;
  std::vector<Block*> met_;  // in this frame
  int frame_ = 0;
  std::int64_t blocked_ = 0;
};

class FreeSpace::Reader {
 public:
  explicit Reader(const FreeSpace& space)
      : space_(space), scale_(static_cast<float>((1 << kFraction) / space.settings_.cell)) {}

  /// @param point  world, m; within 500 m of its origin
  [[nodiscard]] bool is_free(const Eigen::Vector3f& point) {
    const std::size_t cell = at(point);
    return block_ != nullptr && block_->free[cell] >= space_.settings_.frames_to_free;
  }
  [[nodiscard]] bool was_free(const Eigen::Vector3f& point) {
    const std::size_t cell = at(point);
    return block_ != nullptr && (block_->free[cell] >= space_.settings_.frames_to_free ||
                                 (block_->taken[cell] & kSettled) != 0);
  }

 private:
  // The cell of a point in block_, which is null where nothing was seen.
  [[nodiscard]] std::size_t at(const Eigen::Vector3f& point) {
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
