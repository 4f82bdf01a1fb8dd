#include "palpable/map/anchored_scene.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr float kCounts = 127;  // of the map's truncation

}  // namespace

AnchoredScene::AnchoredScene(const SurfaceMap& map, const AnchoredSceneSettings& settings)
    : settings_(settings),
      voxel_(map.settings().voxel),
      per_m_(static_cast<float>(kCounts / map.settings().truncation)),
      step_(static_cast<std::int8_t>(
          std::clamp(std::lround(settings.step * static_cast<double>(per_m_)), 1L, 127L))),
      units_(map.units()),
      table_(map.capacity()) {
  PALPABLE_EXPECT(settings.step > 0, "a surface that is measured again has not gone back");
  PALPABLE_EXPECT(settings.updates_per_round >= 1, "every block has its turn");
  for (int slot = 0; slot < map.capacity(); ++slot) {
    const auto from = map.block_in(slot);
    if (!from) continue;
    Block* block = insert(from->key);
    if (block != nullptr) take(*from, *block);
  }
}

AnchoredScene::Block* AnchoredScene::insert(std::uint64_t key) {
  const int slot = table_.insert(key);
  if (slot == BlockTable::kNone) return nullptr;
  Block* block = &store_.take(slot);
  block->distance.fill(kUnknown);
  block->came = 0;
  return block;
}

// Distances that are not known yet, and those of surfaces that were taken away.
void AnchoredScene::take(const SurfaceMap::BlockView& from, Block& to) const {
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    if (!was_seen(from.voxels[i])) continue;
    const std::size_t eighth = (i >> 2 & 1) | (i >> 5 & 1) << 1 | (i >> 8 & 1) << 2;
    if ((to.came >> eighth & 1) != 0) continue;
    const auto now = static_cast<std::int8_t>(
        std::lround(std::clamp(per_m_ * units_.distance_of(from.voxels[i]), -kCounts, kCounts)));
    if (to.distance[i] == kUnknown || now - to.distance[i] > step_) to.distance[i] = now;
  }
}

void AnchoredScene::update(const SurfaceMap& map, const FreeSpace& space) {
  FreeSpace::Reader reader(space);
  const double block_side = kVoxelsAcross * voxel_;
  for (int slot = 0; slot < map.capacity(); ++slot) {
    const auto from = map.block_in(slot);
    if (!from) continue;
    const int there = table_.find(from->key);
    Block* block = there != BlockTable::kNone ? &store_[there] : insert(from->key);
    if (block == nullptr) continue;  // it has as many blocks as the map: some wait to be given back
    if (there == BlockTable::kNone) {
      const Eigen::Vector3d corner = block_side * BlockTable::place_of(from->key).cast<double>();
      for (int eighth = 0; eighth < 8; ++eighth) {
        const Eigen::Vector3d middle(eighth & 1, eighth >> 1 & 1, eighth >> 2);
        const Eigen::Vector3d p =
            corner + block_side * (0.5 * middle + Eigen::Vector3d::Constant(0.25));
        if (reader.was_free(p.cast<float>())) {
          block->came |= static_cast<std::uint8_t>(1 << eighth);
        }
      }
    } else if (slot % settings_.updates_per_round != round_) {
      continue;
    }
    take(*from, *block);
  }
  // What the map has given back was seen through.
  for (int slot = round_; slot < table_.capacity(); slot += settings_.updates_per_round) {
    if (table_.used(slot) && !map.holds_block(table_.key(slot))) table_.erase(slot);
  }
  round_ = (round_ + 1) % settings_.updates_per_round;
}

bool AnchoredScene::was_there(const Eigen::Vector3d& point, double tolerance,
                              const FreeSpace& space) const {
  constexpr double kLargest = 500;  // m, the reader's
  if (!(point.cwiseAbs().maxCoeff() < kLargest)) return true;
  return Reader(*this, space).was_there(point.cast<float>(), static_cast<float>(tolerance));
}

}  // namespace palpable
