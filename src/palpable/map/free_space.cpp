#include "palpable/map/free_space.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <hwy/cache_control.h>

namespace palpable {
namespace {

constexpr double kLargest = 30000;  // cells from the world's origin; beyond nothing is kept

// Rays are taken from rectangles of so many, one after the other.
constexpr int kTurnsX = 4, kTurnsY = 2;

}  // namespace

FreeSpace::FreeSpace(const DepthNoise& noise, const FreeSpaceSettings& settings)
    : noise_(noise), settings_(settings), table_(settings.blocks) {
  PALPABLE_EXPECT(settings.cell > 0 && settings.farthest > settings.cell,
                  "cells have a size and rays a length");
  PALPABLE_EXPECT(settings.farthest < kLargest / 4 * settings.cell, "rays end in the grid");
  PALPABLE_EXPECT(settings.margin >= 0 && settings.sigmas >= 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.frames_to_free >= 1 && settings.frames_to_free <= 255,
                  "a cell is free after 1 to 255 frames");
  PALPABLE_EXPECT(settings.frames_to_settle >= 1 && settings.frames_to_settle <= 32767,
                  "what stays is settled after 1 to 32767 frames");
  blocks_.resize(static_cast<std::size_t>(settings.blocks));
  met_.reserve(blocks_.size());
}

// Nothing is met in it yet, if it is met for the first time in this frame.
FreeSpace::Block* FreeSpace::meet(Block* block) {
  if (block == nullptr || block->frame == frame_) return block;
  block->frame = frame_;
  block->met.fill(0);
  met_.push_back(block);
  // On its way from memory until it is counted.
  for (std::size_t cell = 0; cell < kCells; cell += 64) hwy::Prefetch(&block->free[cell]);
  return block;
}

// Counts the frame in the cells that its rays met.
void FreeSpace::count(Block& block) {
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

void FreeSpace::add(const PinholeCamera& rays, const Rigid3& world_from_camera,
                    const DepthImage& surface) {
  PALPABLE_EXPECT(surface.width() == rays.width && surface.height() == rays.height,
                  "each ray has its depth");
  const double per_m = 1 / settings_.cell;
  const Eigen::Vector3d origin = world_from_camera.translation() * per_m;
  const Eigen::Matrix3d R = world_from_camera.linear();
  if (!R.allFinite() || !(origin.cwiseAbs().maxCoeff() < kLargest / 2)) return;
  const auto fixed = [](const Eigen::Vector3d& a) {
    constexpr double kOne = 1 << kFraction;
    return Place{floor_to_int(kOne * a[0] + 0.5), floor_to_int(kOne * a[1] + 0.5),
                 floor_to_int(kOne * a[2] + 0.5)};
  };
  const int turn_x = frame_ % kTurnsX, turn_y = frame_ / kTurnsX % kTurnsY;
  ++frame_;
  // Most blocks of the frame before are met again: they come from memory together.
  for (const Block* block : met_) {
    hwy::Prefetch(block->met.data());
    hwy::Prefetch(&block->frame);
  }
  met_.clear();
  RecentBlocks<Block> recent;

  const Place start = fixed(origin);
  // A ray's direction, with 1 along the camera's axis.
  const Eigen::Vector3d across = R.col(0) / rays.fx_px, down = R.col(1) / rays.fy_px;
  const Eigen::Vector3d first = R.col(2) - rays.cx_px * across - rays.cy_px * down;
  for (int y = turn_y; y < rays.height; y += kTurnsY) {
    for (int x = turn_x; x < rays.width; x += kTurnsX) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0)) continue;
      const double margin = std::max(settings_.margin, settings_.sigmas * noise_.sigma(Z));
      const double end = std::min(Z - margin, settings_.farthest);
      const int steps = floor_to_int(end * per_m);
      const Place step = fixed(first + x * across + y * down);  // one cell of depth on
      Place at = start, in_block{};
      Block* block = nullptr;
      for (int i = 1; i <= steps; ++i) {
        for (std::size_t k = 0; k < 3; ++k) at[k] += step[k];
        if (block == nullptr || !same_block(at, in_block)) {
          in_block = at;
          const std::uint64_t key = block_of(at);
          block = recent.of(key, [&] {
            Block* there = block_in(table_.find(key));
            return meet(there != nullptr ? there : block_in(table_.insert(key)));
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
  for (Block* block : met_) count(*block);
  // Only now, so that a cell through which any ray passed counts as free.
  for (int y = turn_y; y < rays.height; y += kTurnsY) {
    for (int x = turn_x; x < rays.width; x += kTurnsX) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0) || Z > settings_.farthest) continue;
      const Place at = fixed(origin + Z * per_m * (first + x * across + y * down));
      const std::uint64_t key = block_of(at);
      Block* block = recent.of(key, [&] { return meet(block_in(table_.find(key))); });
      if (block == nullptr) continue;
      const std::size_t here = cell_of(at);
      std::uint64_t& met = block->met[here / 64];
      const std::uint64_t bit = std::uint64_t{1} << (here % 64);
      if ((met & bit) != 0 || block->free[here] < settings_.frames_to_free) continue;
      met |= bit;
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
  if (!(point.cwiseAbs().maxCoeff() < kLargest * settings_.cell)) return false;
  return Reader(*this).is_free(point.cast<float>());
}

bool FreeSpace::was_free(const Eigen::Vector3d& point) const {
  if (!(point.cwiseAbs().maxCoeff() < kLargest * settings_.cell)) return false;
  return Reader(*this).was_free(point.cast<float>());
}

}  // namespace palpable
