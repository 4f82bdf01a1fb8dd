#include "palpable/map/pressing_mask.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace palpable {
namespace {

constexpr int kTile = 4;

// Pixels of a tile that are asked; most of those that have a depth must have come.
constexpr std::array<std::array<int, 2>, 5> kSampled{{{2, 2}, {1, 1}, {3, 3}, {0, 3}, {3, 0}}};

constexpr int kBeside = 2;  // tiles

enum State : std::uint8_t { kRests, kMoves, kHasCome, kGrouped };

// A filled pixel says what its neighbours say, not more (disparity_filters.h).
constexpr std::uint8_t kLeastConfidence = 64;

bool is_sure(const SeenFrame& seen, int x, int y) {
  return seen.confidence.empty() || seen.confidence(x, y) >= kLeastConfidence;
}

}  // namespace

// Whether a pixel shows what has come since the body was anchored.
class PressingMask::Asker {
 public:
  Asker(const PressingMask& mask, const SeenFrame& seen, const Rigid3& world_from_camera,
        const AnchoredScene& scene, const FreeSpace& space)
      : seen_(seen),
        reader_(scene, space),
        noise_(mask.noise_),
        step_(static_cast<float>(mask.settings_.step)),
        sigmas_(static_cast<float>(mask.settings_.sigmas)),
        farthest_(static_cast<float>(space.settings().farthest)),
        origin_(world_from_camera.translation().cast<float>()) {
    const PinholeCamera& camera = seen.depth_camera;
    const Eigen::Matrix3f R = world_from_camera.linear().cast<float>();
    across_ = R.col(0) / static_cast<float>(camera.fx_px);
    down_ = R.col(1) / static_cast<float>(camera.fy_px);
    first_ = R.col(2) - static_cast<float>(camera.cx_px) * across_ -
             static_cast<float>(camera.cy_px) * down_;
  }

  // Of a pixel with a depth.
  [[nodiscard]] bool has_come(int x, int y) {
    const float Z = seen_.depth(x, y);
    if (!(Z > 0) || Z > farthest_) return false;
    const Eigen::Vector3f p =
        origin_ + Z * (first_ + static_cast<float>(x) * across_ + static_cast<float>(y) * down_);
    return !reader_.was_there(p, std::max(step_, sigmas_ * noise_.sigma_in_float(Z)));
  }

 private:
  const SeenFrame& seen_;
  AnchoredScene::Reader reader_;
  DepthNoise noise_;
  float step_, sigmas_, farthest_;
  Eigen::Vector3f origin_, across_, down_, first_;  // the ray of (x, y): first + x across + y down
};

PressingMask::PressingMask(const DepthNoise& noise, const PressingMaskSettings& settings)
    : noise_(noise), settings_(settings) {
  PALPABLE_EXPECT(settings.step > 0 && settings.sigmas >= 0, "a tolerance is not negative");
}

const MaskImage& PressingMask::find_all(const SeenFrame& seen, const PixelBox& box) {
  shows_.resize(seen.depth.width(), seen.depth.height());
  std::fill(shows_.begin(), shows_.end(), kShowsUnknown);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (seen.depth(x, y) > 0) shows_(x, y) = kShowsPresser;
    }
  }
  return shows_;
}

const MaskImage& PressingMask::find(const SeenFrame& seen, const Rigid3& world_from_camera,
                                    const MaskImage* moving, bool looked,
                                    const AnchoredScene& scene, const FreeSpace& space,
                                    const PixelBox& box) {
  const DepthImage& depth = seen.depth;
  shows_.resize(depth.width(), depth.height());
  std::fill(shows_.begin(), shows_.end(), kShowsUnknown);
  if (moving == nullptr || !world_from_camera.matrix().allFinite()) return shows_;
  PALPABLE_EXPECT(moving->width() == depth.width() && moving->height() == depth.height(),
                  "the mask is of the depth's size");
  mark_moving(seen, *moving, looked, box);
  Asker asker(*this, seen, world_from_camera, scene, space);
  find_come_tiles(seen, *moving, box, asker);
  keep_large_groups();
  mark_come_pixels(seen, box, asker);
  return shows_;
}

void PressingMask::mark_moving(const SeenFrame& seen, const MaskImage& moving, bool looked,
                               const PixelBox& box) {
  const std::uint8_t without = looked ? kShowsRoom : kShowsUnknown;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const bool moves = moving(x, y) != 0;
      const bool close = !seen.too_close.empty() && seen.too_close(x, y) != 0;
      if (seen.depth(x, y) > 0) {
        shows_(x, y) = moves ? kShowsPresser : kShowsRoom;
      } else {
        shows_(x, y) = moves || close ? kShowsUnknown : without;
      }
    }
  }
}

void PressingMask::find_come_tiles(const SeenFrame& seen, const MaskImage& moving,
                                   const PixelBox& box, Asker& asker) {
  const DepthImage& depth = seen.depth;
  tiles_.resize((box.width + kTile - 1) / kTile, (box.height + kTile - 1) / kTile);
  for (int j = 0; j < tiles_.height(); ++j) {
    for (int i = 0; i < tiles_.width(); ++i) {
      int known = 0, moves = 0, come = 0;
      for (const auto& [dx, dy] : kSampled) {
        const int x = box.x + kTile * i + dx, y = box.y + kTile * j + dy;
        if (!box.contains(x, y)) continue;
        if (moving(x, y) != 0) {
          ++moves;
        } else if (depth(x, y) > 0 && is_sure(seen, x, y)) {
          ++known;
          come += asker.has_come(x, y) ? 1 : 0;
          if (known == 2 && come == 0) break;  // most tiles
        }
      }
      tiles_(i, j) = moves > 2 ? kMoves : known >= 2 && 2 * come > known ? kHasCome : kRests;
    }
  }
}

// Beside what moves a matcher gives the room that thing's depth, and the moving mask knows better.
// So only tiles away from there make a group; those beside follow.
void PressingMask::keep_large_groups() {
  for (int j = 0; j < tiles_.height(); ++j) {
    for (int i = 0; i < tiles_.width(); ++i) {
      if (tiles_(i, j) != kHasCome) continue;
      group_.assign(1, {i, j});
      tiles_(i, j) = kGrouped;
      int away = 0;
      bool beside_moving = false;
      for (std::size_t k = 0; k < group_.size(); ++k) {
        const auto [a, b] = group_[k];
        bool here_moves = false;
        for (int v = std::max(b - kBeside, 0); v <= std::min(b + kBeside, tiles_.height() - 1);
             ++v) {
          for (int u = std::max(a - kBeside, 0); u <= std::min(a + kBeside, tiles_.width() - 1);
               ++u) {
            here_moves |= tiles_(u, v) == kMoves;
            if (tiles_(u, v) != kHasCome || std::abs(u - a) > 1 || std::abs(v - b) > 1) continue;
            tiles_(u, v) = kGrouped;
            group_.emplace_back(u, v);
          }
        }
        away += here_moves ? 0 : 1;
        beside_moving |= here_moves;
      }
      if (away >= (beside_moving ? settings_.fewest_tiles_beside : settings_.fewest_tiles)) {
        continue;
      }
      for (const auto& [a, b] : group_) tiles_(a, b) = kRests;
    }
  }
}

// A tile amid its group is marked whole; at the border each pixel is asked.
void PressingMask::mark_come_pixels(const SeenFrame& seen, const PixelBox& box, Asker& asker) {
  for (int j = 0; j < tiles_.height(); ++j) {
    for (int i = 0; i < tiles_.width(); ++i) {
      int beside = 0, there = 0;
      for (int v = std::max(j - 1, 0); v <= std::min(j + 1, tiles_.height() - 1); ++v) {
        for (int u = std::max(i - 1, 0); u <= std::min(i + 1, tiles_.width() - 1); ++u) {
          ++there;
          beside += tiles_(u, v) == kGrouped ? 1 : 0;
        }
      }
      if (beside == 0) continue;
      const bool whole = beside == there;
      for (int y = box.y + kTile * j; y < box.y + kTile * (j + 1); ++y) {
        for (int x = box.x + kTile * i; x < box.x + kTile * (i + 1); ++x) {
          if (!box.contains(x, y) || shows_(x, y) != kShowsRoom || !(seen.depth(x, y) > 0)) {
            continue;
          }
          if (whole || asker.has_come(x, y)) shows_(x, y) = kShowsPresser;
        }
      }
    }
  }
}

}  // namespace palpable
