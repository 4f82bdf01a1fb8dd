#include "palpable/live/map/anchored_scene.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr float kTruncatedValue = 127;  // value that stands for a distance of the map's truncation

}  // namespace

AnchoredScene::AnchoredScene(const SurfaceMap& map, const AnchoredSceneSettings& settings)
    : settings_(settings),
      voxel_(map.settings().voxel),
      per_m_(static_cast<float>(kTruncatedValue / map.settings().truncation)),
      step_(static_cast<std::int8_t>(
          std::clamp(std::lround(settings.step * static_cast<double>(per_m_)), 1L, 127L))),
      units_(map.units()),
      table_(map.capacity()) {
  PALPABLE_EXPECT(settings.step > 0, "the step is positive");
  PALPABLE_EXPECT(settings.updates_per_round >= 1, "a round has at least one update");
  for (int slot = 0; slot < map.capacity(); ++slot) {
    const auto from = map.block_in(slot);
    if (!from) continue;
    Block* block = insert(from->key, 0);
    if (block != nullptr) copy_new_distances(*from, *block);
  }
}

AnchoredScene::Block* AnchoredScene::insert(std::uint64_t key, int keyframe) {
  const int slot = table_.insert(key);
  if (slot == BlockTable::kNone) return nullptr;
  Block* block = &store_.provide(slot);
  block->distance.fill(kUnknown);
  block->was_free = 0;
  block->mapped = false;
  block->keyframe = keyframe;
  return block;
}

// The free eighths of a block: bit x + 2 y + 4 z is set if the middle of that eighth was ever seen
// free.
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

// Copies the distances of voxels that are still unknown and not known to be free, and those that
// have grown by more than `step`, where a surface was taken away.
void AnchoredScene::copy_new_distances(const SurfaceMap::BlockView& from, Block& to) const {
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    if (!was_seen(from.voxels[i])) continue;
    if (to.distance[i] == kUnknown && to.has_come(i)) continue;
    const auto now = static_cast<std::int8_t>(std::lround(std::clamp(
        per_m_ * units_.distance_of(from.voxels[i]), -kTruncatedValue, kTruncatedValue)));
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
    // The table can be full although it is as large as the map's, because a block that the map has
    // removed is removed here up to one round later.
    if (block == nullptr) continue;
    block->mapped = true;
    if (there == BlockTable::kNone) {
      block->was_free = free_eighths(from->key, reader);
    } else if (slot % settings_.updates_per_round != round_) {
      continue;
    }
    copy_new_distances(*from, *block);
  }
  forget_what_has_gone(map, reader);
  round_ = (round_ + 1) % settings_.updates_per_round;
}

// Visits a part of the table and removes blocks that have disappeared. A block that the map once
// contained and no longer contains was removed there because the camera saw through it. A block
// that the map has not contained since it was cleared may merely be out of view since then; it is
// removed only if all of it was seen free.
void AnchoredScene::forget_what_has_gone(const SurfaceMap& map, FreeSpace::Reader& space) {
  constexpr std::uint8_t kAll = 255;
  for (int slot = round_; slot < table_.capacity(); slot += settings_.updates_per_round) {
    if (!table_.used(slot) || map.holds_block(table_.key(slot))) continue;
    if (store_[slot].mapped || free_eighths(table_.key(slot), space) == kAll) table_.erase(slot);
  }
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
  // Distances are moved first: the free eighths are used only for voxels without a distance.
  for (const bool moves_distances : {true, false}) {
    for (const int slot : order) {
      const Block& from = old_store[slot];
      move_block(old_table.key(slot), from, correction_at(corrections, from.keyframe),
                 moves_distances);
    }
  }
}

// Moves a block's distances, or else its free eighths, voxel by voxel.
void AnchoredScene::move_block(std::uint64_t key, const Block& from,
                               const Rigid3& world_from_drifted, bool moves_distances) {
  if (!moves_distances && from.was_free == 0) return;
  const Eigen::Vector3d first = (kVoxelsAcross * BlockTable::place_of(key)).cast<double>();
  std::uint64_t last = ~std::uint64_t{0};
  Block* to = nullptr;
  for (std::size_t i = 0; i < kVoxelsOfBlock; ++i) {
    if (moves_distances ? from.distance[i] == kUnknown : !from.has_come(i)) continue;
    // The voxel's middle, before and after the correction, in voxels.
    const Eigen::Vector3d middle =
        first + place_in_block(i).cast<double>() + Eigen::Vector3d::Constant(0.5);
    const Eigen::Vector3d moved =
        world_from_drifted.linear() * middle + world_from_drifted.translation() / voxel_;
    const Eigen::Vector3i v = moved.array().floor().cast<int>();
    const std::uint64_t new_key = BlockTable::key_of(v.x() >> 3, v.y() >> 3, v.z() >> 3);
    if (new_key != last) {
      last = new_key;
      const int there = table_.find(new_key);
      to = there != BlockTable::kNone ? &store_[there] : insert(new_key, from.keyframe);
    }
    if (to == nullptr) continue;
    const std::size_t k = voxel_index(v.x() & 7, v.y() & 7, v.z() & 7);
    if (!moves_distances) {
      to->was_free |= static_cast<std::uint8_t>(1 << eighth_of(k));
    } else if (to->distance[k] == kUnknown) {
      to->distance[k] = from.distance[i];
    }
  }
}

bool AnchoredScene::was_there(const Eigen::Vector3d& point, double tolerance,
                              const FreeSpace& space) const {
  constexpr double kFarthest = 500;  // m, range of the reader; nothing beyond was seen free
  if (!(point.cwiseAbs().maxCoeff() < kFarthest)) return true;
  return Reader(*this, space).was_there(point.cast<float>(), static_cast<float>(tolerance));
}

}  // namespace palpable
