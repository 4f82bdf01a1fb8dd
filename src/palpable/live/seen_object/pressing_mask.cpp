#include "palpable/live/seen_object/pressing_mask.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/map/static_picture.h"
#include "palpable/live/map/tile_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

// Most of a tile's five samples: a tile moves when at least this many of them do.
constexpr int kMost = 3;

// Two depths that differ by less than this share of the nearer one belong to one surface.
constexpr float kSameShare = 0.06F;

// Ratio to Z. A sensor without confidences mixes near and far depths where two surfaces meet, so a
// pixel is uncertain when a neighbour's depth differs by more than this.
constexpr float kJumpShare = 0.04F;

// The largest difference in depth of two neighbouring pixels of one surface:
// max(kLeastJump, kJumpAt1m * Z^2), in m and 1/m.
constexpr float kLeastJump = 0.008F;
constexpr float kJumpAt1m = 0.04F;

// A resting tile counts as beside something that moves up to this distance, in tiles.
constexpr int kBeside = 2;

// The verdict on the group that a tile belongs to.
enum Group : std::uint8_t {
  kNotGathered,  // no verdict yet
  kDropped,      // not a presser
  kMovesAlone,   // its moving pixels are a presser; the resting ones beside them are the room
  kRestsToo      // its resting pixels are a presser, too
};

bool is_same_surface(float a, float b) { return std::abs(a - b) < kSameShare * std::min(a, b); }

}  // namespace

// Tests whether a pixel shows something that arrived since the body was anchored: something nearer
// to the camera than the room's surface.
class PressingMask::RoomTest {
 public:
  RoomTest(const PressingMask& mask, const SeenFrame& seen, const Rigid3& world_from_camera,
           const AnchoredScene& scene, const FreeSpace& space)
      : seen_(seen),
        reader_(scene, space),
        noise_(mask.noise_),
        step_(static_cast<float>(mask.settings_.step)),
        sigmas_(static_cast<float>(mask.settings_.sigmas)),
        walking_step_(static_cast<float>(mask.settings_.walking_step)),
        walking_share_(static_cast<float>(mask.settings_.walking_share)),
        farthest_(static_cast<float>(space.settings().farthest)),
        origin_(world_from_camera.translation().cast<float>()) {
    const PinholeCamera& camera = seen.depth_camera;
    const Eigen::Matrix3f R = world_from_camera.linear().cast<float>();
    across_ = R.col(0) / static_cast<float>(camera.fx_px);
    down_ = R.col(1) / static_cast<float>(camera.fy_px);
    first_ = R.col(2) - static_cast<float>(camera.cx_px) * across_ -
             static_cast<float>(camera.cy_px) * down_;
  }

  // @pre the pixel has a depth
  [[nodiscard]] bool has_come(int x, int y) { return is_before_room(x, y, step_, 0); }
  // The same with the larger tolerance of a camera that walks.
  [[nodiscard]] bool has_come_for_sure(int x, int y) {
    return is_before_room(x, y, walking_step_, walking_share_);
  }

 private:
  bool is_before_room(int x, int y, float step, float share) {
    const float Z = seen_.depth(x, y);
    if (!(Z > 0) || Z > farthest_) return false;
    const Eigen::Vector3f p =
        origin_ + Z * (first_ + static_cast<float>(x) * across_ + static_cast<float>(y) * down_);
    return !reader_.was_there(p, std::max({step, share * Z, sigmas_ * noise_.sigma_in_float(Z)}));
  }

  const SeenFrame& seen_;
  AnchoredScene::Reader reader_;
  DepthNoise noise_;
  float step_, sigmas_, walking_step_, walking_share_, farthest_;
  Eigen::Vector3f origin_, across_, down_, first_;  // the ray of (x, y): first + x across + y down
};

PressingMask::PressingMask(const DepthNoise& noise, const PressingMaskSettings& settings)
    : noise_(noise), settings_(settings), outline_(settings.outline), search_(settings.search) {
  PALPABLE_EXPECT(settings.step > 0 && settings.sigmas >= 0 && settings.walking_step >= 0 &&
                      settings.walking_share >= 0,
                  "a tolerance is not negative");
  PALPABLE_EXPECT(settings.fewest_frames >= 1 && settings.fewest_frames < 255,
                  "a group has been there for 1 to 254 frames");
}

const MaskImage& PressingMask::find_all(const SeenFrame& seen, const PixelBox& box) {
  is_searched_ = false;
  shows_.resize(seen.depth.width(), seen.depth.height());
  std::fill(shows_.begin(), shows_.end(), kShowsUnknown);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (seen.depth(x, y) > 0) shows_(x, y) = kShowsPresser;
    }
  }
  return shows_;
}

const MaskImage& PressingMask::find_nothing(const SeenFrame& seen, const PixelBox& box) {
  resize(seen.depth, box);
  return shows_;
}

const MaskImage& PressingMask::find(const SeenFrame& seen, const Rigid3& world_from_camera,
                                    const MaskImage& moving, LookedAt looked_at,
                                    const AnchoredScene& scene, const FreeSpace& space,
                                    const PixelBox& box, const StaticPicture* picture) {
  const DepthImage& depth = seen.depth;
  resize(depth, box);
  if (!world_from_camera.matrix().allFinite()) return shows_;
  PALPABLE_EXPECT(moving.width() == depth.width() && moving.height() == depth.height(),
                  "the mask is of the depth's size");
  mark_moving(seen, moving, looked_at != LookedAt::kNothing);
  const bool stands = looked_at == LookedAt::kPicture;
  RoomTest room(*this, seen, world_from_camera, scene, space);
  for (int j = j0_; j < j0_ + down_; ++j) {
    for (int i = i0_; i < i0_ + across_; ++i) find_tile(seen, moving, stands, picture, i, j, room);
  }
  keep_groups();
  mark_pixels(seen, moving, room);
  go_on(seen);
  outline_.trim(seen, box, shows_);
  search_.find(seen, box, shows_);
  is_searched_ = true;
  remember(seen, moving);
  remember_moved(seen);
  return shows_;
}

void PressingMask::resize(const DepthImage& depth, const PixelBox& box) {
  is_searched_ = false;
  shows_.resize(depth.width(), depth.height());
  std::fill(shows_.begin(), shows_.end(), kShowsUnknown);
  box_ = box;
  i0_ = box.x / kTile, j0_ = box.y / kTile;
  across_ = box.width > 0 ? (box.x + box.width - 1) / kTile - i0_ + 1 : 0;
  down_ = box.height > 0 ? (box.y + box.height - 1) / kTile - j0_ + 1 : 0;
  tiles_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_), {});
  const int width = (depth.width() + kTile - 1) / kTile;
  const int height = (depth.height() + kTile - 1) / kTile;
  if (frames_.width() != width || frames_.height() != height) {
    frames_ = frames_before_ = Image<std::uint8_t>(width, height);
    pressed_ = hidden_ = moved_ = DepthImage(width, height);
  }
  std::swap(frames_, frames_before_);
  std::fill(frames_.begin(), frames_.end(), std::uint8_t{0});
}

// Sets what each pixel shows before groups are found: measured pixels show the room, all others the
// room or nothing known. @param looked  whether the frame was compared with a picture of the room
void PressingMask::mark_moving(const SeenFrame& seen, const MaskImage& moving, bool looked) {
  const std::uint8_t without = looked ? kShowsRoom : kShowsUnknown;
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      const bool close = !seen.too_close.empty() && seen.too_close(x, y) != 0;
      shows_(x, y) = seen.depth(x, y) > 0         ? kShowsRoom
                     : moving(x, y) != 0 || close ? kShowsUnknown
                                                  : without;
    }
  }
}

bool PressingMask::is_sure(const SeenFrame& seen, int x, int y) const {
  if (!seen.confidence.empty()) return seen.confidence(x, y) >= settings_.least_confidence;
  const float z = seen.depth(x, y);
  const auto jumps = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= seen.depth.width() || v >= seen.depth.height()) return false;
    return std::abs(seen.depth(u, v) - z) > kJumpShare * z;  // false for NaN
  };
  return !jumps(x - 1, y) && !jumps(x + 1, y) && !jumps(x, y - 1) && !jumps(x, y + 1);
}

void PressingMask::find_tile(const SeenFrame& seen, const MaskImage& moving, bool stands,
                             const StaticPicture* picture, int i, int j, RoomTest& room) {
  int known = 0, moves = 0, come = 0, sure = 0;
  float moving_depth = 0, come_depth = 0;
  int x_sure = 0, y_sure = 0;
  for (const auto& [dx, dy] : kTileSamples) {
    const int x = kTile * i + dx, y = kTile * j + dy;
    if (!box_.contains(x, y) || !(seen.depth(x, y) > 0)) continue;
    ++known;
    const bool certain = is_sure(seen, x, y);
    if (moving(x, y) != 0) {
      ++moves;
      if (moving_depth == 0) moving_depth = seen.depth(x, y);
    } else if (certain && room.has_come(x, y)) {
      ++come;
      if (come_depth == 0) come_depth = seen.depth(x, y);
    } else {
      if (known == 2 && moves + come == 0) return;  // the room, as in most tiles: saves time
      continue;
    }
    if (certain) ++sure, x_sure = x, y_sure = y;
  }
  Tile& found = tile(i, j);
  if (moves >= come && moves > 0) {
    found.depth = moving_depth;
    found.moves = moves >= kMost;
    if (sure > 0 && (stands || room.has_come_for_sure(x_sure, y_sure))) {
      found.signs = static_cast<std::uint8_t>(std::min(sure, kMost));
    }
    found.is_sign = found.moves && found.signs == kMost;
  } else if (2 * come > known && come >= 2) {
    found.is_sign = stands ? was_there_before(i, j, come_depth) &&
                                 !(picture != nullptr && picture->looks_as_ever(i, j))
                           : room.has_come_for_sure(x_sure, y_sure);
    found.goes_on =
        stands && is_same_surface(come_depth, moved_(i, j)) &&
        room.has_come_for_sure(x_sure, y_sure) &&
        !(picture != nullptr && picture->looks_as_ever(i, j) && picture->is_plain(i, j));
    if (found.is_sign || found.goes_on) found.depth = come_depth;
  }
}

bool PressingMask::was_there_before(int i, int j, float depth) const {
  return is_same_surface(depth, pressed_(i, j)) || is_same_surface(depth, hidden_(i, j));
}

bool PressingMask::beside_moving(int i, int j) const {
  for (int b = std::max(j - kBeside, j0_); b <= std::min(j + kBeside, j0_ + down_ - 1); ++b) {
    for (int a = std::max(i - kBeside, i0_); a <= std::min(i + kBeside, i0_ + across_ - 1); ++a) {
      if (tile(a, b).moves) return true;
    }
  }
  return false;
}

// The largest count of frames in a row that the last frame had within near_px of a tile.
int PressingMask::frames_near(int i, int j) const {
  const int reach = settings_.near_px / kTile;
  int most = 0;
  for (int b = std::max(j - reach, 0); b <= std::min(j + reach, frames_before_.height() - 1); ++b) {
    for (int a = std::max(i - reach, 0); a <= std::min(i + reach, frames_before_.width() - 1);
         ++a) {
      most = std::max<int>(most, frames_before_(a, b));
    }
  }
  return most;
}

// Fills group_ with the tiles that are connected with tile (i, j) and belong to one surface.
void PressingMask::gather(int i, int j) {
  group_.assign(1, {static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
  tile(i, j).group = kDropped;
  for (std::size_t k = 0; k < group_.size(); ++k) {
    const Place at = group_[k];
    for (int b = std::max(at.j - 1, j0_); b <= std::min(at.j + 1, j0_ + down_ - 1); ++b) {
      for (int a = std::max(at.i - 1, i0_); a <= std::min(at.i + 1, i0_ + across_ - 1); ++a) {
        Tile& other = tile(a, b);
        if (other.group != kNotGathered || other.depth == 0) continue;
        if (!is_same_surface(other.depth, tile(at.i, at.j).depth)) continue;
        other.group = kDropped;
        group_.push_back({static_cast<std::int16_t>(a), static_cast<std::int16_t>(b)});
      }
    }
  }
}

// Decides whether the group's signs are enough. Resting tiles beside moving ones do not count.
// @param frames  in a row in which the group was seen
std::uint8_t PressingMask::verdict(int frames) const {
  if (frames < settings_.fewest_frames) return kDropped;
  int moving = 0, resting = 0;
  bool any_beside = false;
  for (const Place& at : group_) {
    const Tile& here = tile(at.i, at.j);
    moving += here.signs;
    if (here.moves) {
      any_beside = true;
    } else if (beside_moving(at.i, at.j)) {
      any_beside = true;
    } else {
      resting += here.is_sign ? 1 : 0;
    }
  }
  if (resting >= (any_beside ? settings_.fewest_tiles_beside : settings_.fewest_tiles)) {
    return kRestsToo;
  }
  return moving >= kMost * settings_.fewest_tiles ? kMovesAlone : kDropped;
}

void PressingMask::keep_groups() {
  for (int j = j0_; j < j0_ + down_; ++j) {
    for (int i = i0_; i < i0_ + across_; ++i) {
      if (tile(i, j).depth == 0 || tile(i, j).group != kNotGathered) continue;
      gather(i, j);
      int before = 0;
      if (std::ssize(group_) >= settings_.fewest_tiles_beside) {
        // The first tiles usually suffice; of a large group about 16 tiles are looked up.
        const std::size_t stride = 1 + group_.size() / 16;
        for (std::size_t k = 0; k < group_.size(); k += stride) {
          before = std::max(before, frames_near(group_[k].i, group_[k].j));
          if (before >= settings_.fewest_frames) break;
        }
      }
      const int frames = std::min(before + 1, 254);
      const std::uint8_t result = verdict(frames);
      for (const Place& at : group_) {
        frames_(at.i, at.j) = static_cast<std::uint8_t>(frames);
        tile(at.i, at.j).group = result;
      }
    }
  }
}

// Marks the pixels of the groups that are pressers. A pixel belongs to such a group if one of the
// nine tiles around it does and has the pixel's depth: along the border of a moving thing, some
// pixels of a nearer thing before it seem to move, too. In resting tiles each pixel is compared
// with the room, except in the interior of a group.
void PressingMask::mark_pixels(const SeenFrame& seen, const MaskImage& moving, RoomTest& room) {
  for (int j = j0_; j < j0_ + down_; ++j) {
    for (int i = i0_; i < i0_ + across_; ++i) {
      int there = 0, kept = 0, resting = 0;
      std::array<float, 9> depths{};
      for (int b = std::max(j - 1, j0_); b <= std::min(j + 1, j0_ + down_ - 1); ++b) {
        for (int a = std::max(i - 1, i0_); a <= std::min(i + 1, i0_ + across_ - 1); ++a) {
          ++there;
          if (tile(a, b).group < kMovesAlone) continue;
          depths[static_cast<std::size_t>(kept++)] = tile(a, b).depth;
          const bool rests = tile(a, b).group == kRestsToo && !tile(a, b).moves;
          resting += rests || tile(a, b).goes_on ? 1 : 0;
        }
      }
      if (kept == 0) continue;
      for (int y = std::max(kTile * j, box_.y); y < std::min(kTile * (j + 1), box_.y + box_.height);
           ++y) {
        for (int x = std::max(kTile * i, box_.x);
             x < std::min(kTile * (i + 1), box_.x + box_.width); ++x) {
          const float z = seen.depth(x, y);
          if (!(z > 0)) continue;
          if (std::none_of(depths.begin(), depths.begin() + kept,
                           [z](float other) { return is_same_surface(z, other); })) {
            continue;
          }
          if (moving(x, y) != 0 || (resting > 0 && (resting == there || room.has_come(x, y)))) {
            shows_(x, y) = kShowsPresser;
          }
        }
      }
    }
  }
}

// Whether a pixel and the eight around it belong to one surface.
bool PressingMask::is_amid_surface(const DepthImage& depth, int x, int y) {
  const float z = depth(x, y);
  if (!(z > 0) || x == 0 || y == 0 || x + 1 == depth.width() || y + 1 == depth.height()) {
    return false;
  }
  const float jump = std::max(kLeastJump, kJumpAt1m * z * z);
  for (int v = y - 1; v <= y + 1; ++v) {
    for (int u = x - 1; u <= x + 1; ++u) {
      if (!(std::abs(depth(u, v) - z) < jump)) return false;
    }
  }
  return true;
}

// Extends the pressers by go_on_px pixels into room pixels of the same surface.
void PressingMask::go_on(const SeenFrame& seen) {
  edge_.clear();
  const int right = box_.x + box_.width, bottom = box_.y + box_.height;
  constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
  for (int y = box_.y + 1; y + 1 < bottom; ++y) {
    const std::uint8_t *row = shows_.row(y), *above = shows_.row(y - 1), *below = shows_.row(y + 1);
    for (int x = box_.x + 1; x + 1 < right; ++x) {
      if (row[x] != kShowsPresser) continue;
      const int beside = row[x - 1] & row[x + 1] & above[x] & below[x];
      if (beside != kShowsPresser) {
        edge_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
      }
    }
  }
  for (int step = 0; step < settings_.go_on_px; ++step) {
    next_edge_.clear();
    for (const Place& from : edge_) {
      for (const auto& [dx, dy] : kNeighbours) {
        const int x = from.i + dx, y = from.j + dy;
        if (!box_.contains(x, y) || shows_(x, y) != kShowsRoom) continue;
        if (!seen.confidence.empty() && seen.confidence(x, y) < settings_.least_confidence) {
          continue;
        }
        if (!is_amid_surface(seen.depth, x, y)) continue;  // then it joins (from.i, from.j), too
        shows_(x, y) = kShowsPresser;
        next_edge_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
      }
    }
    std::swap(edge_, next_edge_);
  }
}

// Stores the depth of what moves or rests since; forgets it once the tile's middle has another one.
void PressingMask::remember_moved(const SeenFrame& seen) {
  for (int j = j0_; j < j0_ + down_; ++j) {
    for (int i = i0_; i < i0_ + across_; ++i) {
      const Tile& now = tile(i, j);
      if (now.group >= kMovesAlone && (now.moves || now.goes_on)) {
        moved_(i, j) = now.depth;
      } else if (moved_(i, j) > 0) {
        const int x = std::min(kTile * i + 2, seen.depth.width() - 1);
        const int y = std::min(kTile * j + 2, seen.depth.height() - 1);
        if (seen.depth(x, y) > 0) moved_(i, j) = 0;
      }
    }
  }
}

// Stores the depth of what pressed; it is kept until something farther is measured there.
void PressingMask::remember(const SeenFrame& seen, const MaskImage& moving) {
  for (int j = j0_; j < j0_ + down_; ++j) {
    for (int i = i0_; i < i0_ + across_; ++i) {
      float &pressed = pressed_(i, j), &hidden = hidden_(i, j);
      const Tile& now = tile(i, j);
      if (now.group >= kMovesAlone) {
        if (pressed > 0 && now.depth < pressed && !is_same_surface(now.depth, pressed)) {
          hidden = pressed;
        } else if (hidden > 0 && now.depth > hidden * (1 - kSameShare)) {
          hidden = 0;
        }
        pressed = now.depth;
        continue;
      }
      if (pressed == 0 && hidden == 0) continue;
      // The tile's middle pixel. Without a depth, or moving, it does not show what is behind.
      const int x = std::min(kTile * i + 2, seen.depth.width() - 1);
      const int y = std::min(kTile * j + 2, seen.depth.height() - 1);
      const float z = seen.depth(x, y);
      if (!(z > 0) || moving(x, y) != 0) continue;
      if (z > pressed * (1 + kSameShare)) pressed = 0;
      if (z > hidden * (1 + kSameShare)) hidden = 0;
    }
  }
}

}  // namespace palpable
