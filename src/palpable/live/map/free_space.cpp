#include "palpable/live/map/free_space.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/cache_control.h>

namespace palpable {
namespace {

constexpr double kLargestCell = 30000;  // cells from the world's origin; nothing is kept beyond

}  // namespace

FreeSpace::FreeSpace(const DepthNoise& noise, const FreeSpaceSettings& settings)
    : noise_(noise), settings_(settings), table_(settings.blocks) {
  PALPABLE_EXPECT(settings.cell > 0 && settings.farthest > settings.cell,
                  "cells have a size and rays a length");
  PALPABLE_EXPECT(settings.farthest < kLargestCell / 4 * settings.cell, "rays end in the grid");
  PALPABLE_EXPECT(settings.margin >= 0 && settings.sigmas >= 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.frames_to_free >= 1 && settings.frames_to_free <= 255,
                  "a cell is free after 1 to 255 frames");
  PALPABLE_EXPECT(settings.frames_to_settle >= 1 && settings.frames_to_settle <= 32767,
                  "what stays is settled after 1 to 32767 frames");
  blocks_.resize(settings.blocks);
  met_.reserve(blocks_.size());
}

// Clears the marks of an earlier frame when this frame looks into the block for the first time.
// Returns its argument, also null.
FreeSpace::Block* FreeSpace::begin_block(Block* block) {
  if (block == nullptr || block->frame == frame_) return block;
  block->frame = frame_;
  block->met.fill(0);
  met_.push_back(block);
  // Prefetched now, because the counts are needed after the walk.
  for (std::size_t cell = 0; cell < kCells; cell += 64) hwy::Prefetch(&block->free[cell]);
  return block;
}

// Increments the counts of the cells through which this frame looked.
void FreeSpace::count_met_cells(Block& block) {
  for (std::size_t z = 0; z < kSide; ++z) {
    for (std::uint64_t left = block.met[z]; left != 0; left &= left - 1) {
      const std::size_t cell = 64 * z + static_cast<std::size_t>(std::countr_zero(left));
      std::uint8_t& free = block.free[cell];
      free = static_cast<std::uint8_t>(free + (free < 255 ? 1 : 0));
      if (block.any_taken) block.taken[cell] &= kSettled;
    }
  }
  if (!block.any_taken) return;
  std::uint16_t any = 0;
  for (const std::uint16_t taken : block.taken) any |= taken;
  block.any_taken = (any & ~kSettled) != 0;
}

// The rays of one frame, in units of cells.
class FreeSpace::Rays {
 public:
  Rays(const PinholeCamera& rays, const Rigid3& world_from_camera, double cell)
      : per_m_(1 / cell),
        origin_(world_from_camera.translation() * per_m_),
        across_(world_from_camera.linear().col(0) / rays.fx_px),
        down_(world_from_camera.linear().col(1) / rays.fy_px),
        first_(world_from_camera.linear().col(2) - rays.cx_px * across_ - rays.cy_px * down_) {}

  // False if the camera's pose is not finite or too far from the origin.
  [[nodiscard]] bool are_in_grid(const Rigid3& world_from_camera) const {
    return world_from_camera.linear().allFinite() &&
           origin_.cwiseAbs().maxCoeff() < kLargestCell / 2;
  }
  [[nodiscard]] Place origin() const { return place(origin_); }
  // The step along the ray of pixel (x, y) that advances the depth by one cell.
  [[nodiscard]] Place step(int x, int y) const { return place(first_ + x * across_ + y * down_); }
  // The position on that ray at depth Z, m.
  [[nodiscard]] Place at_depth(int x, int y, double Z) const {
    return place(origin_ + Z * per_m_ * (first_ + x * across_ + y * down_));
  }
  // The number of whole steps up to depth Z, m.
  [[nodiscard]] int steps_to(double Z) const { return floor_to_int(Z * per_m_); }

 private:
  [[nodiscard]] static Place place(const Eigen::Vector3d& a) {
    constexpr double kOne = 1 << kFraction;
    return Place{floor_to_int(kOne * a[0] + 0.5), floor_to_int(kOne * a[1] + 0.5),
                 floor_to_int(kOne * a[2] + 0.5)};
  }

  double per_m_;  // cells
  Eigen::Vector3d origin_;
  Eigen::Vector3d across_, down_, first_;  // the ray of (x, y) is first + x across + y down
};

void FreeSpace::add(const PinholeCamera& rays, const Rigid3& world_from_camera,
                    const DepthImage& surface) {
  PALPABLE_EXPECT(surface.width() == rays.width && surface.height() == rays.height,
                  "each ray has its depth");
  const Rays in_cells(rays, world_from_camera, settings_.cell);
  if (!in_cells.are_in_grid(world_from_camera)) return;
  ++frame_;
  // This frame looks into most blocks of the frame before, so these are prefetched.
  for (const Block* block : met_) {
    hwy::Prefetch(block->met.data());
    hwy::Prefetch(&block->frame);
  }
  met_.clear();
  RecentBlocks<Block> recent;
  walk(in_cells, surface, recent);
  for (Block* block : met_) count_met_cells(*block);
  // After the walk, so that a cell through which any ray passed counts as free.
  count_ends(in_cells, surface, recent);
}

// Marks the cells through which the frame's rays pass.
void FreeSpace::walk(const Rays& rays, const DepthImage& surface, RecentBlocks<Block>& recent) {
  const Place start = rays.origin();
  for (int y = turn_y(); y < surface.height(); y += kTurnsY) {
    for (int x = turn_x(); x < surface.width(); x += kTurnsX) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0)) continue;
      const double margin = std::max(settings_.margin, settings_.sigmas * noise_.sigma(Z));
      const int steps = rays.steps_to(std::min(Z - margin, settings_.farthest));
      const Place step = rays.step(x, y);
      Place at = start, in_block{};
      Block* block = nullptr;
      for (int i = 1; i <= steps; ++i) {
        for (std::size_t k = 0; k < 3; ++k) at[k] += step[k];
        if (block == nullptr || !same_block(at, in_block)) {
          in_block = at;
          const std::uint64_t key = block_of(at);
          block = recent.of(key, [&] {
            Block* there = block_in(table_.find(key));
            return begin_block(there != nullptr ? there : block_in(table_.insert(key)));
          });
          if (block == nullptr) {
            ++blocked_;
            break;
          }
        }
        const std::size_t passed = cell_of(at);
        block->met[passed / 64] |= std::uint64_t{1} << (passed % 64);
      }
    }
  }
}

// Increments the count of the free cells in which a ray ends and through which none has passed.
void FreeSpace::count_ends(const Rays& rays, const DepthImage& surface,
                           RecentBlocks<Block>& recent) {
  for (int y = turn_y(); y < surface.height(); y += kTurnsY) {
    for (int x = turn_x(); x < surface.width(); x += kTurnsX) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0) || Z > settings_.farthest) continue;
      const Place at = rays.at_depth(x, y, Z);
      const std::uint64_t key = block_of(at);
      Block* block = recent.of(key, [&] { return begin_block(block_in(table_.find(key))); });
      if (block == nullptr) continue;
      const std::size_t here = cell_of(at);
      std::uint64_t& met = block->met[here / 64];
      const std::uint64_t bit = std::uint64_t{1} << (here % 64);
      if ((met & bit) != 0 || block->free[here] < settings_.frames_to_free) continue;
      met |= bit;  // counted once per frame
      block->any_taken = true;
      std::uint16_t& taken = block->taken[here];
      ++taken;
      if ((taken & ~kSettled) >= settings_.frames_to_settle) {
        taken = kSettled;
        block->free[here] = 0;
      }
    }
  }
}

bool FreeSpace::is_free(const Eigen::Vector3d& point) const {
  if (!(point.cwiseAbs().maxCoeff() < kLargestCell * settings_.cell)) return false;
  return Reader(*this).is_free(point.cast<float>());
}

bool FreeSpace::was_free(const Eigen::Vector3d& point) const {
  if (!(point.cwiseAbs().maxCoeff() < kLargestCell * settings_.cell)) return false;
  return Reader(*this).was_free(point.cast<float>());
}

}  // namespace palpable
