#include "palpable/map/anchored_scene.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

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
    Block* block = insert(from->key, 0);
    if (block != nullptr) take(*from, *block);
  }
}

AnchoredScene::Block* AnchoredScene::insert(std::uint64_t key, int keyframe) {
  const int slot = table_.insert(key);
  if (slot == BlockTable::kNone) return nullptr;
  Block* block = &store_.take(slot);
  block->distance.fill(kUnknown);
  block->came = 0;
  block->mapped = false;
  block->keyframe = keyframe;
  return block;
}

// Bit x + 2 y + 4 z: the middle of that eighth of a block was seen free.
std::uint8_t AnchoredScene::free_eighths(std::uint64_t key, FreeSpace::Reader& space) const {
  const double side = kVoxelsAcross * voxel_;
  const Eigen::Vector3d corner = side * BlockTable::place_of(key).cast<double>();
  std::uint8_t bits = 0;
  for (int eighth = 0; eighth < 8; ++eighth) {
    const Eigen::Vector3d at(eighth & 1, eighth >> 1 & 1, eighth >> 2);
    const Eigen::Vector3d p = corner + side * (0.5 * at + Eigen::Vector3d::Constant(0.25));
    if (space.was_free(p.cast<float>())) bits |= static_cast<std::uint8_t>(1 << eighth);
  }
  return bits;
}

// Distances that are not known yet, and those of surfaces that were taken away.
void AnchoredScene::take(const SurfaceMap::BlockView& from, Block& to) const {
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    if (!was_seen(from.voxels[i])) continue;
    if (to.distance[i] == kUnknown && to.has_come(i)) continue;
    const auto now = static_cast<std::int8_t>(
        std::lround(std::clamp(per_m_ * units_.distance_of(from.voxels[i]), -kCounts, kCounts)));
    if (to.distance[i] == kUnknown || now - to.distance[i] > step_) to.distance[i] = now;
  }
}

void AnchoredScene::update(const SurfaceMap& map, const FreeSpace& space, int keyframe) {
  FreeSpace::Reader reader(space);
  for (int slot = 0; slot < map.capacity(); ++slot) {
    const auto from = map.block_in(slot);
    if (!from) continue;
    const int there = table_.find(from->key);
    Block* block = there != BlockTable::kNone ? &store_[there] : insert(from->key, keyframe);
    if (block == nullptr) continue;  // it has as many blocks as the map: some wait to be given back
    block->mapped = true;
    if (there == BlockTable::kNone) {
      block->came = free_eighths(from->key, reader);
    } else if (slot % settings_.updates_per_round != round_) {
      continue;
    }
    take(*from, *block);
  }
  // What the map has given back was seen through. A map that began anew does not hold what the
  // camera has not seen since, nor what has gone: that is free by now.
  for (int slot = round_; slot < table_.capacity(); slot += settings_.updates_per_round) {
    if (!table_.used(slot) || map.holds_block(table_.key(slot))) continue;
    constexpr std::uint8_t kAll = 255;
    if (store_[slot].mapped || free_eighths(table_.key(slot), reader) == kAll) table_.erase(slot);
  }
  round_ = (round_ + 1) % settings_.updates_per_round;
}

void AnchoredScene::follow(std::span<const Correction> corrections) {
  const BlockTable old_table = std::exchange(table_, BlockTable(table_.capacity()));
  const SlabStore<Block> old_store = std::exchange(store_, SlabStore<Block>());
  std::vector<int> order;
  for (int slot = 0; slot < old_table.capacity(); ++slot) {
    if (old_table.used(slot)) order.push_back(slot);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return old_store[a].keyframe < old_store[b].keyframe; });
  // Distances first: where none is known, what came tells.
  for (const bool came : {false, true}) {
    for (const int slot : order) {
      const Block& from = old_store[slot];
      if (came && from.came == 0) continue;
      const Rigid3& step = correction_at(corrections, from.keyframe);
      const Eigen::Vector3d first =
          (kVoxelsAcross * BlockTable::place_of(old_table.key(slot))).cast<double>();
      std::uint64_t last = ~std::uint64_t{0};
      Block* to = nullptr;
      for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
        if (came ? !from.has_come(i) : from.distance[i] == kUnknown) continue;
        // In voxels; from the middle of one into another.
        const Eigen::Vector3d middle =
            first + place_in_block(i).cast<double>() + Eigen::Vector3d::Constant(0.5);
        const Eigen::Vector3d moved = step.linear() * middle + step.translation() / voxel_;
        const Eigen::Vector3i v = moved.array().floor().cast<int>();
        const std::uint64_t key = BlockTable::key_of(v.x() >> 3, v.y() >> 3, v.z() >> 3);
        if (key != last) {
          last = key;
          const int there = table_.find(key);
          to = there != BlockTable::kNone ? &store_[there] : insert(key, from.keyframe);
        }
        if (to == nullptr) continue;
        const std::size_t k = voxel_index(v.x() & 7, v.y() & 7, v.z() & 7);
        if (came) {
          to->came |= static_cast<std::uint8_t>(1 << eighth_of(k));
        } else if (to->distance[k] == kUnknown) {
          to->distance[k] = from.distance[i];
        }
      }
    }
  }
}

bool AnchoredScene::was_there(const Eigen::Vector3d& point, double tolerance,
                              const FreeSpace& space) const {
  constexpr double kLargest = 500;  // m, the reader's
  if (!(point.cwiseAbs().maxCoeff() < kLargest)) return true;
  return Reader(*this, space).was_there(point.cast<float>(), static_cast<float>(tolerance));
}

}  // namespace palpable
