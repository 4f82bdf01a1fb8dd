#include "palpable/map/free_space.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <hwy/cache_control.h>

namespace palpable {
namespace {

constexpr double kLargest = 30000;  // cells from the world's origin; beyond nothing is kept

// Rays are taken from squares of this many, one after the other.
constexpr int kTurns = 2;

}  // namespace

FreeSpace::FreeSpace(const DepthNoise& noise, const FreeSpaceSettings& settings)
    : noise_(noise), settings_(settings), table_(settings.blocks) {
  static_assert(each_cell_has_its_own_place());
  PALPABLE_EXPECT(settings.cell > 0 && settings.farthest > settings.cell,
                  "cells have a size and rays a length");
  PALPABLE_EXPECT(settings.farthest < kLargest / 4 * settings.cell, "rays end in the grid");
  PALPABLE_EXPECT(settings.margin >= 0 && settings.sigmas >= 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.frames_to_free >= 1 && settings.frames_to_free <= 255,
                  "a cell is free after 1 to 255 frames");
  PALPABLE_EXPECT(settings.frames_to_settle >= 1 && settings.frames_to_settle <= 32767,
                  "what stays is settled after 1 to 32767 frames");
  blocks_.resize(static_cast<std::size_t>(settings.blocks));
  path_.resize(static_cast<std::size_t>(settings.farthest / settings.cell) + 1);
}

void FreeSpace::add(const PinholeCamera& rays, const Rigid3& world_from_camera,
                    const DepthImage& surface) {
  PALPABLE_EXPECT(surface.width() == rays.width && surface.height() == rays.height,
                  "each ray has its depth");
  const double cell = settings_.cell;
  const Eigen::Vector3d origin = world_from_camera.translation() / cell;
  const Eigen::Matrix3d R = world_from_camera.linear();
  if (!R.allFinite() || !(origin.cwiseAbs().maxCoeff() < kLargest / 2)) return;
  const auto fixed = [](const Eigen::Vector3d& a) {
    constexpr double kOne = 1 << kFraction;
    return Place{static_cast<std::int32_t>(std::lround(kOne * a[0])),
                 static_cast<std::int32_t>(std::lround(kOne * a[1])),
                 static_cast<std::int32_t>(std::lround(kOne * a[2]))};
  };
  // 0 marks what was never changed.
  stamp_ = stamp_ == 255 ? 1 : stamp_ + 1;
  const int turn_x = frame_ % kTurns, turn_y = frame_ / kTurns % kTurns;
  ++frame_;

  const Place start = fixed(origin);
  for (int y = turn_y; y < rays.height; y += kTurns) {
    for (int x = turn_x; x < rays.width; x += kTurns) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0)) continue;
      const double margin = std::max(settings_.margin, settings_.sigmas * noise_.sigma(Z));
      const double end = std::min(Z - margin, settings_.farthest);
      const int steps = static_cast<int>(std::floor(end / cell));
      const Place step = fixed(R * rays.unproject(x, y, 1.0));  // one cell of depth on
      // Where it passes first, what is there then: the cells are on their way from memory together.
      Place at = start, in_block{};
      Block* block = nullptr;
      std::size_t passed = 0;
      for (int i = 1; i <= steps; ++i) {
        for (std::size_t k = 0; k < 3; ++k) at[k] += step[k];
        if (block == nullptr || !same_block(at, in_block)) {
          in_block = at;
          const std::uint64_t key = block_of(at);
          int slot = table_.find(key);
          if (slot == BlockTable::kNone) {
            slot = table_.insert(key);
            if (slot == BlockTable::kNone) {
              ++blocked_;
              break;
            }
          }
          block = &blocks_[static_cast<std::size_t>(slot)];
        }
        path_[passed] = &(*block)[cell_of(at)];
        hwy::Prefetch(path_[passed++]);
      }
      for (std::size_t i = 0; i < passed; ++i) {
        const std::uint32_t was = path_[i]->bits;
        const std::uint32_t seen_through =
            (was & Cell::kSettled) | stamp_ << 8 | std::min((was & 0xFF) + 1, 255U);
        // Without a branch: whether another ray of this frame was here is anybody's guess.
        path_[i]->bits = path_[i]->stamp() == stamp_ ? was : seen_through;
      }
    }
  }
  // Only now, so that a cell through which any ray passed counts as free.
  for (int y = turn_y; y < rays.height; y += kTurns) {
    for (int x = turn_x; x < rays.width; x += kTurns) {
      const auto Z = static_cast<double>(surface(x, y));
      if (!(Z > 0) || Z > settings_.farthest) continue;
      const Place at = fixed(origin + R * rays.unproject(x, y, Z / cell));
      const int slot = table_.find(block_of(at));
      if (slot == BlockTable::kNone) continue;
      Cell& c = blocks_[static_cast<std::size_t>(slot)][cell_of(at)];
      if (c.stamp() == stamp_ || c.free() < settings_.frames_to_free) continue;
      c.bits = (c.bits & ~(0xFFU << 8)) | stamp_ << 8;
      c.bits += Cell::kOneTaken;
      if (c.taken() >= settings_.frames_to_settle) c.bits = Cell::kSettled | stamp_ << 8;
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
