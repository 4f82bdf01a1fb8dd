#include "palpable/map/moving_mask.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <hwy/base.h>
#include <hwy/cache_control.h>
#include <limits>
#include <optional>
#include <utility>

namespace palpable {
namespace {

constexpr int kTile = StaticPicture::kTile;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// A mask's pixels while it is being made.
constexpr std::uint8_t kOff = 0, kOpen = 128, kOn = 255;

// Holes are closed when what moves lies on both sides within so many pixels.
constexpr int kLongestHole = 24;

// Four neighbours' depths that differ by less than this share, or by so many sigma, are looked up
// once: four values of one depth span 2.1 sigma on average, more than 4 once in forty times. So are
// two fours beside each other, by the share of their means.
constexpr float kAlike = 0.02F;
constexpr float kAlikeSigmas = 4;

constexpr int kFloatsOfLine = 16;  // of the cache

// A group of which this share is seen to move needs no memory of earlier frames.
constexpr double kEvident = 0.1;

// Of a tile's 16 pixels: so many called too close and the tile is.
constexpr int kTooClosePixels = 3;

// Of a tile and its eight neighbours: so many look alike, or it is chance.
constexpr int kFewestAlike = 5;
// And so many beside a tile that looks shaded: it is a dark place of what moves.
constexpr int kFewestBeside = 3;

// A camera that has not moved for so many frames stands: sooner, one that sways rests.
constexpr int kToStand = 12;

// While nothing moves, a camera that sways looks at its canvas once in so many frames: to learn.
constexpr int kQuietEvery = 4;

// The picture is good for a camera that has moved by less than so many pixels of what is so near,
// m.
constexpr double kSameView = 0.25;
constexpr double kNearThings = 0.3;

bool same_view(const Rigid3& a, const Rigid3& b, const PinholeCamera& camera) {
  const Rigid3 step = a.inverse() * b;
  if (!step.matrix().allFinite()) return false;
  // |R - 1| = sqrt(8) sin(angle / 2), which is sqrt(2) angle where it matters.
  const double angle = (step.linear() - Eigen::Matrix3d::Identity()).norm() / std::sqrt(2.0);
  return camera.fx_px * (angle + step.translation().norm() / kNearThings) < kSameView;
}

// What group() knows of a tile.
enum GroupState : std::uint8_t { kDone, kMayJoin, kWaits };

// The loops below touch each value once, in arrays apart from each other, which the compiler cannot
// know of members: told so, it takes many at a time.

// Of pixels' depths: where another is the nearest so far, the pixel goes by what that one says.
// `least`: how far the nearest so far is, as the bits of a float >= 0, which sort as their values
// do, with what is not a number behind them all.
void take_nearest(float there, std::int32_t says, const float* HWY_RESTRICT depth,
                  std::int32_t* HWY_RESTRICT least, std::int32_t* HWY_RESTRICT value, int count) {
  for (int k = 0; k < count; ++k) {
    const auto difference = std::bit_cast<std::int32_t>(std::abs(there - depth[k]));
    const std::int32_t nearer = difference < least[k] ? -1 : 0;
    value[k] ^= (value[k] ^ says) & nearer;
    least[k] ^= (least[k] ^ difference) & nearer;
  }
}

void tell_states(const std::uint8_t* label, std::uint8_t may_join, std::uint8_t waits,
                 std::uint8_t* HWY_RESTRICT state, std::size_t count) {
  static_assert(kDone == 0 && kMayJoin == 1 && kWaits == 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t joins = label[k] >= may_join ? 1 : 0, stands = label[k] >= waits ? 1 : 0;
    state[k] = static_cast<std::uint8_t>(joins + stands);
  }
}

// 1 where a tile has that label and a depth.
void tell_static(const std::uint8_t* label, std::uint8_t is_static, const float* depth,
                 std::uint8_t* HWY_RESTRICT told, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t same = label[k] == is_static ? 1 : 0, known = depth[k] == depth[k] ? 1 : 0;
    told[k] = same & known;
  }
}

void low_and_high(const float* a, const float* b, float* HWY_RESTRICT low, float* HWY_RESTRICT high,
                  float* HWY_RESTRICT sum, int count) {
  for (int i = 0; i < count; ++i) {
    low[i] = a[i] < b[i] ? a[i] : b[i];
    high[i] = a[i] > b[i] ? a[i] : b[i];
    sum[i] = a[i] + b[i];
  }
}

float sigma_of(const DepthNoise& noise, float depth) {
  return static_cast<float>(noise.constant) +
         depth * (static_cast<float>(noise.linear) + depth * static_cast<float>(noise.quadratic));
}

void any_of_three(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                  std::uint8_t* HWY_RESTRICT any, int count) {
  for (int i = 0; i < count; ++i) any[i] = a[i] | b[i] | c[i];
}

void all_of_three(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                  std::uint8_t* HWY_RESTRICT all, int count) {
  for (int i = 0; i < count; ++i) all[i] = a[i] & b[i] & c[i];
}

}  // namespace

MovingMask::MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings)
    : noise_(noise), settings_(settings), space_(noise, settings.space), stood_(kToStand) {
  PALPABLE_EXPECT(settings.step > 0 && settings.sigmas >= 0 && settings.same_share > 0,
                  "a tolerance is not negative");
  PALPABLE_EXPECT(settings.grow_px >= 0 && settings.fewest_tiles >= 0 &&
                      settings.frames_to_carry >= 0 && settings.frames_to_carry < 127,
                  "a margin is not negative");
}

void MovingMask::resize(const DepthImage& depth) {
  const int width = (depth.width() + kTile - 1) / kTile;
  const int height = (depth.height() + kTile - 1) / kTile;
  if (mask_.width() == depth.width() && mask_.height() == depth.height()) return;
  mask_ = above_ = below_ = MaskImage(depth.width(), depth.height());
  open_.reserve(mask_.size());
  row_is_empty_.assign(static_cast<std::size_t>(height), 1);
  tile_depth_ = DepthImage(width, height);
  tile_label_ = tile_static_ = Image<std::uint8_t>(width, height);
  seen_ = Image<std::uint8_t>(width, height);
  age_ = Image<std::uint8_t>(width, height, 127);
  moved_depth_ = DepthImage(width, height);
  ray_depth_ = DepthImage((width + 1) / 2, (height + 1) / 2);
  any_beside_ = all_beside_ = all_move_ = Image<std::uint8_t>(width, height);
  alike_.resize(static_cast<std::size_t>((width + 1) / 2));
  columns_.resize(2 * alike_.size());
  highest_ = sums_ = columns_;
  row_.resize(static_cast<std::size_t>(width) + 2);
  queue_.reserve(tile_depth_.size());
  edge_.reserve(tile_depth_.size());
  questions_.reserve(static_cast<std::size_t>(2 * width));
  view_ = {GrayImage(depth.width(), depth.height()), Image<TileColor>(width, height),
           Image<std::uint8_t>(width, height), Image<std::uint8_t>(width, height)};
  drawn_.resize(depth.width(), depth.height(), tile_static_);
}

// The depth in the middle of each tile; where it is unknown, the first known one of four others.
void MovingMask::sample(const SeenFrame& seen) {
  const DepthImage& depth = seen.depth;
  static constexpr std::array<std::array<int, 2>, 5> kPlaces{
      {{2, 2}, {1, 1}, {3, 3}, {0, 3}, {3, 0}}};
  const bool watched = !seen.too_close.empty();
  const int width = depth.width(), height = depth.height(), tiles = tile_depth_.width();
  // How many of a tile's pixels are called too close.
  const auto too_close = [&](int x0, int y0) {
    int close = 0;
    const auto across = static_cast<std::size_t>(std::min(kTile, width - x0));
    for (int y = y0; y < std::min(y0 + kTile, height); ++y) {
      std::uint32_t four = 0;  // most often none
      const std::uint8_t* pixels = seen.too_close.row(y) + x0;
      if (across == kTile) {
        std::memcpy(&four, pixels, kTile);
      } else {
        std::memcpy(&four, pixels, across);
      }
      for (; four != 0; four >>= 8) close += (four & 0xFF) != 0 ? 1 : 0;
    }
    return close;
  };
  for (int j = 0; j < tile_depth_.height(); ++j) {
    float* found = tile_depth_.row(j);
    std::uint8_t* label = tile_label_.row(j);
    const auto& [x0, y0] = kPlaces.front();
    std::fill_n(label, tiles, kUnknown);
    // Of every four rows of depth one is read, which the processor does not foresee.
    if (const int next = kTile * (j + 1) + y0; next < height) {
      for (int x = 0; x < width; x += kFloatsOfLine) hwy::Prefetch(depth.row(next) + x);
    }
    if (kTile * j + y0 < height && kTile * (tiles - 1) + x0 < width) {
      const float* row = depth.row(kTile * j + y0) + x0;
      for (int i = 0; i < tiles; ++i) found[i] = row[kTile * i];
    } else {
      std::fill_n(found, tiles, kNaN);
    }
    for (int i = 0; i < tiles; ++i) {
      if (!std::isnan(found[i])) continue;
      for (const auto& [dx, dy] : kPlaces) {
        const int x = kTile * i + dx, y = kTile * j + dy;
        if (x >= width || y >= height) continue;
        found[i] = depth(x, y);
        if (!std::isnan(found[i])) break;
      }
      if (watched && std::isnan(found[i]) && too_close(kTile * i, kTile * j) >= kTooClosePixels) {
        label[i] = kMoving;
      }
    }
  }
}

// Of each 2 x 2 tiles of two rows their mean depth, or 0 where they differ by more than noise or
// one is not known: four tiles of one depth are looked up once, and most of a picture is smooth.
void MovingMask::find_alike(int j, int j1) {
  const int width = tile_depth_.width(), fours = (width + 1) / 2;
  low_and_high(tile_depth_.row(j), tile_depth_.row(j1), columns_.data(), highest_.data(),
               sums_.data(), width);
  columns_[static_cast<std::size_t>(2 * fours - 1)] = columns_[static_cast<std::size_t>(width - 1)];
  highest_[static_cast<std::size_t>(2 * fours - 1)] = highest_[static_cast<std::size_t>(width - 1)];
  sums_[static_cast<std::size_t>(2 * fours - 1)] = sums_[static_cast<std::size_t>(width - 1)];
  for (std::size_t i = 0; i < alike_.size(); ++i) {
    const float low = std::min(columns_[2 * i], columns_[2 * i + 1]);
    const float high = std::max(highest_[2 * i], highest_[2 * i + 1]);
    const float sum = sums_[2 * i] + sums_[2 * i + 1];  // NaN where one is not known
    const float scatter = kAlikeSigmas * sigma_of(noise_, low);
    alike_[i] = sum > 0 && high - low <= std::max(kAlike * low, scatter) ? 0.25F * sum : 0;
  }
}

void MovingMask::label(const Rigid3& world_from_camera, const SurfaceMap* map) {
  const Eigen::Matrix3f R = world_from_camera.linear().cast<float>();
  const Eigen::Vector3f t = world_from_camera.translation().cast<float>();
  if (!R.allFinite() || !(t.cwiseAbs().maxCoeff() < 400.0F)) return;
  const Eigen::Vector3f across = R.col(0) / static_cast<float>(tiles_.fx_px);
  const Eigen::Vector3f down = R.col(1) / static_cast<float>(tiles_.fy_px);
  const Eigen::Vector3f first = R.col(2) - static_cast<float>(tiles_.cx_px) * across -
                                static_cast<float>(tiles_.cy_px) * down;
  const auto farthest = static_cast<float>(settings_.space.farthest);
  const auto old_surface = static_cast<float>(settings_.frames_to_trust);
  FreeSpace::Reader space(space_);
  std::optional<SurfaceMap::Reader> surface;
  if (map != nullptr) surface.emplace(*map);
  const auto same_share = static_cast<float>(settings_.same_share);
  const auto unexplained = [&](int i, int j) {
    const float before = moved_depth_(i, j);
    const bool same = std::abs(tile_depth_(i, j) - before) <= same_share * before;
    return same && age_(i, j) < settings_.frames_to_carry ? kCarried : kUnexplained;
  };
  const auto ask = [&](int i, int j, float Z, int tiles) {
    if (!(Z > 0)) return;  // unknown, or too close
    const float x = static_cast<float>(i) + 0.5F * static_cast<float>(tiles - 1);
    const float y = static_cast<float>(j) + (tiles > 1 ? 0.5F : 0.0F);
    const Eigen::Vector3f p = t + Z * (first + x * across + y * down);
    const Voxel* voxel = surface && Z <= farthest ? surface->voxel(p) : nullptr;
    if (voxel != nullptr) hwy::Prefetch(voxel);
    questions_.push_back({p, voxel, Z, i, j, tiles});
  };
  const auto step = static_cast<float>(settings_.step);
  const auto sigmas = static_cast<float>(settings_.sigmas);
  const auto answer = [&](const Question& q) -> std::uint8_t {
    if (q.depth > farthest) return kStatic;
    // The map comes first: at a slanted surface rays pass through the cells in which it lies.
    if (q.voxel != nullptr && was_seen(*q.voxel)) {
      const float d = map->units().distance_of(*q.voxel);
      const float sigma = sigma_of(noise_, q.depth);
      const float allowed = std::max(step, sigmas * sigma);
      if (d > allowed) return kMoving;
      if (d >= -allowed) {
        return map->weighs(*q.voxel, old_surface, sigma) ? kStatic : unexplained(q.i, q.j);
      }
    }
    return space.is_free(q.point) ? kMoving : unexplained(q.i, q.j);
  };
  const int width = tile_label_.width(), height = tile_label_.height();
  for (int j = 0; j < height; j += 2) {
    const int j1 = std::min(j + 1, height - 1);
    // All of two rows before the first is answered: the voxels come from memory together.
    questions_.clear();
    find_alike(j, j1);
    for (int i = 0; i < width; i += 2) {
      const auto four = static_cast<std::size_t>(i / 2);
      if (const float Z = alike_[four]; Z > 0) {
        const float beside = i + 3 < width ? alike_[four + 1] : 0;  // the next four's, if alike
        if (std::abs(beside - Z) <= kAlike * Z) {
          ask(i, j, 0.5F * (Z + beside), 4);
          i += 2;
        } else {
          ask(i, j, Z, 2);
        }
        continue;
      }
      const int i1 = std::min(i + 1, width - 1);
      ask(i, j, tile_depth_(i, j), 1);
      if (i1 > i) ask(i1, j, tile_depth_(i1, j), 1);
      if (j1 > j) ask(i, j1, tile_depth_(i, j1), 1);
      if (i1 > i && j1 > j) ask(i1, j1, tile_depth_(i1, j1), 1);
    }
    for (const Question& q : questions_) {
      const std::uint8_t label = answer(q);
      tile_label_(q.i, q.j) = label;
      if (q.tiles == 1) continue;
      for (int i = q.i; i < std::min(q.i + q.tiles, width); ++i) {
        tile_label_(i, j) = tile_label_(i, j1) = label;
      }
    }
  }
}

// What looks as the scene does is static: a matcher gives the pixels beside a hand the hand's
// depth, and plain or dark places any. Without a depth, what does not look so is taken for moving.
void MovingMask::compare_look(const SeenFrame& seen, const Rigid3& world_from_camera) {
  compared_ = nullptr;
  if (!settings_.look) return;
  const bool stands = same_view(picture_pose_, world_from_camera, seen.depth_camera);
  const bool sways = canvas_.stays() && (!stands || stood_ < kToStand);
  if (!stands && !sways) return;
  ++compares_;
  const auto moving = std::count(tile_label_.begin(), tile_label_.end(), kMoving);
  if (sways && !moved_ && moving < settings_.fewest_tiles && compares_ % kQuietEvery != 0) return;
  tell_static(tile_label_.data(), kStatic, tile_depth_.data(), tile_static_.data(),
              tile_static_.size());
  const int w = seen.depth.width(), h = seen.depth.height();
  const GrayImage& luma = seen.left_half.empty() ? seen.left : seen.left_half;
  if (sways) {
    canvas_.draw(world_from_camera, view_);
    if (drawn_.compare(luma, seen.color, w, h, tile_static_, view_)) compared_ = &drawn_;
  } else if (picture_.compare(luma, seen.color, w, h, tile_static_)) {
    compared_ = &picture_;
  }
  if (compared_ == nullptr) return;
  const StaticPicture& picture = *compared_;
  const bool starting = !sways && picture.starting();
  const int width = tile_label_.width(), height = tile_label_.height();
  // How many of a tile and its neighbours look so.
  const auto around = [&](int i, int j, auto looks) {
    int count = 0;
    for (int b = std::max(j - 1, 0); b <= std::min(j + 1, height - 1); ++b) {
      for (int a = std::max(i - 1, 0); a <= std::min(i + 1, width - 1); ++a) {
        count += looks(picture.tile(a, b)) ? 1 : 0;
      }
    }
    return count;
  };
  using Look = StaticPicture::Look;
  const auto is_changed = [](Look look) { return look == StaticPicture::kChanged; };
  const auto is_scene = [](Look look) {
    return look == StaticPicture::kSame || look == StaticPicture::kShadow;
  };
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      std::uint8_t& label = tile_label_(i, j);
      const Look look = picture.tile(i, j);
      if (label == kStatic && look != StaticPicture::kChanged && !starting) continue;  // most
      const bool measured = !std::isnan(tile_depth_(i, j));
      if (starting && look == StaticPicture::kNothing) {
        label = std::min<std::uint8_t>(label, kUnexplained);
      } else if (label == kStatic) {
        // A hand that lies on the scene's surface, if it hangs together with what moves.
        if (look == StaticPicture::kChanged) label = kUnexplained;
      } else if (!measured) {
        // What looks the same by chance, unclear or shaded amid what has changed belongs to it.
        const int fewest = look == StaticPicture::kChanged ? 0
                           : look == StaticPicture::kSame  ? kFewestAlike
                                                           : kFewestBeside;
        if (fewest == 0 || around(i, j, is_changed) >= fewest) {
          if (label == kUnknown) label = kChanged;
        } else if (is_scene(look)) {
          label = kUnknown;
        }
      } else if ((look == StaticPicture::kSame && around(i, j, is_scene) >= kFewestAlike) ||
                 (look == StaticPicture::kShadow && picture.is_plain(i, j))) {
        label = kUnknown;
        tile_depth_(i, j) = kNaN;  // it is a neighbour's
      } else if (label < kChanged || label == kCarried) {
        // Nothing but a neighbour speaks against it: the scene in the shade, or at its edge.
        const bool shaded =
            look == StaticPicture::kShadow ||
            (look == StaticPicture::kNothing && around(i, j, is_scene) >= kFewestAlike);
        if (shaded) label = kStatic;
      }
    }
  }
}

// What moves hangs together: groups of moving tiles, and of those that moved a moment ago and are
// not explained now; small groups are mismatches. Then the unexplained
// tiles that continue a group's depth without a jump and lie no deeper than the group does. Where
// they are many times the group, it is a new part of the scene that something touches: they stay.
void MovingMask::group() {
  moved_ = false;
  const int width = tile_label_.width(), height = tile_label_.height();
  const auto share = static_cast<float>(settings_.same_share);
  tell_states(tile_label_.data(), kUnexplained, kChanged, seen_.data(), seen_.size());
  // Calls `visit` with each tile around one, and what seen_ says of it.
  const auto around = [&](Tile at, const auto& visit) {
    for (int y = std::max(at.j - 1, 0); y <= std::min(at.j + 1, height - 1); ++y) {
      for (int x = std::max(at.i - 1, 0); x <= std::min(at.i + 1, width - 1); ++x) {
        visit(x, y, seen_(x, y));
      }
    }
  };
  const auto tile_at = [](int i, int j) {
    return Tile{static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)};
  };
  std::size_t start = 0;
  while (const void* found = std::memchr(seen_.data() + start, kWaits, seen_.size() - start)) {
    start = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - seen_.data());
    seen_.data()[start] = kDone;
    queue_.assign(1, tile_at(static_cast<int>(start) % width, static_cast<int>(start) / width));
    edge_.clear();  // those of them with tiles beside them that may join
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const Tile at = queue_[head];
      bool on_edge = false;
      around(at, [&](int i, int j, std::uint8_t& state) {
        on_edge = on_edge || state == kMayJoin;
        if (state != kWaits) return;
        state = kDone;
        queue_.push_back(tile_at(i, j));
      });
      if (on_edge) edge_.push_back(at);
    }
    const std::size_t moving = queue_.size();
    if (static_cast<int>(moving) < settings_.fewest_tiles) {
      for (const Tile at : queue_) tile_label_(at.i, at.j) = kStatic;
      continue;
    }
    moved_ = true;
    std::size_t evident = 0;
    double sum = 0, squares = 0, known = 0;
    for (const Tile at : queue_) {
      evident += tile_label_(at.i, at.j) != kCarried ? 1 : 0;
      const auto Z = static_cast<double>(tile_depth_(at.i, at.j));
      if (std::isnan(Z)) continue;  // too close
      sum += Z;
      squares += Z * Z;
      known += 1;
    }
    const double mean = sum / std::max(known, 1.0);
    const auto deepest = static_cast<float>(
        1.1 * (mean + 2 * std::sqrt(std::max(squares / known - mean * mean, 0.0))));
    const std::size_t joined = edge_.size();  // the first of them
    for (std::size_t head = 0; head < edge_.size(); ++head) {
      const Tile at = edge_[head];
      const float from = tile_depth_(at.i, at.j);
      around(at, [&](int i, int j, std::uint8_t& state) {
        if (state != kMayJoin) return;
        const float Z = tile_depth_(i, j);
        if (!(Z <= deepest && std::abs(from - Z) <= share * Z)) return;
        state = kDone;
        edge_.push_back(tile_at(i, j));
      });
    }
    const auto first = edge_.begin() + static_cast<std::ptrdiff_t>(joined);
    if (static_cast<double>(edge_.size() - joined) <=
        settings_.most_unexplained * static_cast<double>(moving)) {
      queue_.insert(queue_.end(), first, edge_.end());
    } else {
      // Another group may take them.
      for (auto at = first; at != edge_.end(); ++at) seen_(at->i, at->j) = kMayJoin;
    }
    const bool sure = static_cast<double>(evident) >= kEvident * static_cast<double>(queue_.size());
    for (const Tile at : queue_) {
      std::uint8_t &age = age_(at.i, at.j), &of_tile = tile_label_(at.i, at.j);
      const bool fresh = sure && of_tile >= kChanged;
      // + 128: this frame has spoken.
      age = static_cast<std::uint8_t>(fresh ? 128 : 128 + std::min(age + 1, 127));
      of_tile = kMoving;
      moved_depth_(at.i, at.j) = tile_depth_(at.i, at.j);
    }
  }
  for (std::uint8_t& age : age_) {
    age = age >= 128 ? static_cast<std::uint8_t>(age - 128) : std::uint8_t{127};
  }
  std::replace(tile_label_.begin(), tile_label_.end(), std::uint8_t{kCarried},
               std::uint8_t{kStatic});
}

// Which tiles move or have a neighbour that does (seen_), and which move with all of theirs.
void MovingMask::find_border() {
  const int width = tile_label_.width(), height = tile_label_.height();
  for (int j = 0; j < height; ++j) {  // beside each other
    const std::uint8_t* label = tile_label_.row(j);
    std::uint8_t* moves = row_.data() + 1;
    for (int i = 0; i < width; ++i) moves[i] = label[i] == kMoving ? 1 : 0;
    moves[-1] = moves[0];
    moves[width] = moves[width - 1];
    any_of_three(moves - 1, moves, moves + 1, any_beside_.row(j), width);
    all_of_three(moves - 1, moves, moves + 1, all_beside_.row(j), width);
  }
  for (int j = 0; j < height; ++j) {  // above each other
    const int above = std::max(j - 1, 0), below = std::min(j + 1, height - 1);
    any_of_three(any_beside_.row(above), any_beside_.row(j), any_beside_.row(below), seen_.row(j),
                 width);
    all_of_three(all_beside_.row(above), all_beside_.row(j), all_beside_.row(below),
                 all_move_.row(j), width);
  }
}

// From tiles to pixels. Pixels of unknown depth at the border stay open.
void MovingMask::draw(const DepthImage& depth) {
  find_border();
  const int width = tile_label_.width(), height = tile_label_.height();
  for (int j = 0; j < height; ++j) {
    const int y0 = kTile * j, y1 = std::min(y0 + kTile, depth.height());
    std::uint8_t* first = mask_.row(y0);
    const std::uint8_t *any = seen_.row(j), *all = all_move_.row(j);
    const bool was_empty = row_is_empty_[static_cast<std::size_t>(j)] != 0;
    const bool is_empty = std::memchr(any, 1, static_cast<std::size_t>(width)) == nullptr;
    row_is_empty_[static_cast<std::size_t>(j)] = is_empty ? 1 : 0;
    if (is_empty) {
      if (!was_empty) std::fill(first, mask_.row(y1 - 1) + depth.width(), kOff);
      continue;
    }
    for (int i = 0; i < width - 1; ++i)
      std::memset(first + kTile * i, all[i] != 0 ? kOn : kOff, kTile);
    std::fill(first + kTile * (width - 1), first + depth.width(), all[width - 1] != 0 ? kOn : kOff);
    for (int y = y0 + 1; y < y1; ++y) std::copy_n(first, depth.width(), mask_.row(y));
    for (int i = 0; i < width; ++i) {
      if (any[i] != 0 && all[i] == 0) draw_border(depth, i, j);
    }
  }
}

// The pixels of a tile that does not move as its neighbours do, or not all of them.
void MovingMask::draw_border(const DepthImage& depth, int i, int j) {
  const int width = tile_label_.width(), height = tile_label_.height();
  const int x0 = kTile * i, x1 = std::min(x0 + kTile, depth.width());
  const int y0 = kTile * j, y1 = std::min(y0 + kTile, depth.height());
  const bool moves = tile_label_(i, j) == kMoving;
  const bool measured = !std::isnan(tile_depth_(i, j));
  const bool too_close = moves && !measured;
  // Whether a pixel that looks the same is the scene's: in the dark it may be chance, and a
  // view that may be off by a pixel says less than a depth.
  const bool by_pixel =
      compared_ != nullptr &&
      (!moves || (compared_->tells_pixels(i, j) && !(measured && compared_ == &drawn_)));
  // All sixteen pixels with one neighbour after the other.
  std::array<float, kTile * kTile> Z;
  std::array<std::int32_t, kTile * kTile> least, value;
  Z.fill(kNaN);
  for (int y = y0; y < y1; ++y)
    std::copy(depth.row(y) + x0, depth.row(y) + x1, &Z[kTile * (y - y0)]);
  least.fill(std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity()));
  for (std::size_t k = 0; k < Z.size(); ++k) value[k] = too_close && std::isnan(Z[k]) ? kOn : kOpen;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, height - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, width - 1); ++a) {
      take_nearest(tile_depth_(a, b), tile_label_(a, b) == kMoving ? kOn : kOff, Z.data(),
                   least.data(), value.data(), kTile * (y1 - y0));
    }
  }
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      auto of_pixel =
          static_cast<std::uint8_t>(value[static_cast<std::size_t>(kTile * (y - y0) + x - x0)]);
      if (compared_ != nullptr && of_pixel != kOff) {
        const StaticPicture::Look look = compared_->pixel(x, y);
        if (look == StaticPicture::kSame && by_pixel) of_pixel = kOff;
        if (look == StaticPicture::kChanged) of_pixel = kOn;
      }
      mask_(x, y) = of_pixel;
    }
  }
}

// Decides the open pixels, all of which lie near something that moves: first along rows, and what
// is then still open along columns.
void MovingMask::fill() {
  const int width = mask_.width(), height = mask_.height();
  open_.clear();
  for (int y = 0; y < height; ++y) {
    if (row_is_empty_[static_cast<std::size_t>(y / kTile)] != 0) continue;
    std::uint8_t* row = mask_.row(y);
    for (int x = 0; x < width;) {
      const auto* next = static_cast<const std::uint8_t*>(
          std::memchr(row + x, kOpen, static_cast<std::size_t>(width - x)));
      if (next == nullptr) break;
      x = static_cast<int>(next - row);
      int end = x;
      while (end < width && row[end] == kOpen) ++end;
      const std::uint8_t left = x > 0 ? row[x - 1] : row[std::min(end, width - 1)];
      const std::uint8_t right = end < width ? row[end] : left;
      if (left == kOn && right == kOn && end - x <= kLongestHole) {
        std::fill(row + x, row + end, kOn);
      } else {
        const int grow = std::min(settings_.grow_px, end - x);
        if (left == kOn) std::fill(row + x, row + x + grow, kOn);
        if (right == kOn) std::fill(row + end - grow, row + end, kOn);
        for (int k = x; k < end; ++k) {
          if (row[k] == kOpen) open_.push_back(y * width + k);
        }
      }
      x = end;
    }
  }
  // How many open pixels away the next moving one is, above and below; 255: none there.
  const auto away = [&](int k, int step, const MaskImage& distance) -> std::uint8_t {
    const int to = k + step;
    if (to < 0 || to >= width * height) return 255;
    if (mask_.data()[to] == kOn) return 1;
    if (mask_.data()[to] == kOff) return 255;
    return static_cast<std::uint8_t>(std::min(distance.data()[to] + 1, 255));
  };
  for (const int k : open_) above_.data()[k] = away(k, -width, above_);
  for (auto k = open_.rbegin(); k != open_.rend(); ++k) {
    below_.data()[*k] = away(*k, width, below_);
  }
  for (const int k : open_) {
    const int above = above_.data()[k], below = below_.data()[k];
    const bool inside = above + below - 1 <= kLongestHole;
    mask_.data()[k] = inside || std::min(above, below) <= settings_.grow_px ? kOn : kOff;
  }
}

const MaskImage& MovingMask::find(const SeenFrame& seen, const Rigid3& world_from_camera,
                                  const SurfaceMap* map) {
  const DepthImage& depth = seen.depth;
  PALPABLE_EXPECT(
      seen.depth_camera.width == depth.width() && seen.depth_camera.height == depth.height(),
      "the depth is the camera's");
  PALPABLE_EXPECT(seen.too_close.empty() || (seen.too_close.width() == depth.width() &&
                                             seen.too_close.height() == depth.height()),
                  "what is too close has the depth's size");
  resize(depth);
  const PinholeCamera& c = depth_camera_ = seen.depth_camera;
  // Pixel (0, 0) of the tiles is the sampled one, (2, 2) of the depth.
  tiles_ = {tile_depth_.width(), tile_depth_.height(),  c.fx_px / kTile,
            c.fy_px / kTile,     (c.cx_px - 2) / kTile, (c.cy_px - 2) / kTile};
  sample(seen);
  label(world_from_camera, map);
  compare_look(seen, world_from_camera);
  group();
  draw(depth);
  fill();
  return mask_;
}

// Of each 2 x 2 tiles the nearest depth.
void MovingMask::find_ray_depths() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const int width = tile_depth_.width(), height = tile_depth_.height();
  for (int j = 0; j < ray_depth_.height(); ++j) {
    const float* above = tile_depth_.row(2 * j);
    const float* below = tile_depth_.row(std::min(2 * j + 1, height - 1));
    for (int i = 0; i < width; ++i) {
      const float nearest = above[i] < kInfinity ? above[i] : kInfinity;  // a NaN is not less
      columns_[static_cast<std::size_t>(i)] = below[i] < nearest ? below[i] : nearest;
    }
    for (int i = 0; i < ray_depth_.width(); ++i) {
      const auto a = static_cast<std::size_t>(2 * i);
      const auto b = static_cast<std::size_t>(std::min(2 * i + 1, width - 1));
      const float nearest = std::min(columns_[a], columns_[b]);
      ray_depth_(i, j) = nearest < kInfinity ? nearest : kNaN;
    }
  }
}

void MovingMask::learn(const Rigid3& world_from_camera) {
  if (!same_view(picture_pose_, world_from_camera, depth_camera_)) {
    picture_pose_ = world_from_camera;
    picture_.forget();
    stood_ = 0;
  } else {
    ++stood_;
    // seen_: what moves and its neighbours, as drawn
    if (compared_ == &picture_) picture_.learn(seen_, tile_static_);
  }
  canvas_.follow(depth_camera_, world_from_camera);
  if (compared_ == &drawn_) {
    canvas_.learn(world_from_camera, drawn_, tile_depth_, tile_static_, seen_);
  }
  find_ray_depths();
  PinholeCamera rays = tiles_.scaled_down(2);
  rays.width = ray_depth_.width();
  rays.height = ray_depth_.height();
  space_.add(rays, world_from_camera, ray_depth_);
}

}  // namespace palpable
