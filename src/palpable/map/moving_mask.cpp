#include "palpable/map/moving_mask.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <hwy/base.h>
#include <hwy/cache_control.h>
#include <limits>
#include <optional>

namespace palpable {
namespace {

using enum TileGroups::Label;

constexpr int kTile = StaticPicture::kTile;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Four neighbours' depths that differ by less than this share, or by so many sigma, are looked up
// once: four values of one depth span 2.1 sigma on average, more than 4 once in forty times. So are
// two fours beside each other, by the share of their means.
constexpr float kAlike = 0.02F;
constexpr float kAlikeSigmas = 4;

constexpr int kFloatsOfLine = 16;  // of the cache

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

// The loops below touch each value once, in arrays apart from each other, which the compiler cannot
// know of members: told so, it takes many at a time.

// 1 where a tile has that label and a depth.
void tell_static(const std::uint8_t* label, std::uint8_t is_static, const float* depth,
                 std::uint8_t* HWY_RESTRICT told, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t same = label[k] == is_static ? 1 : 0, known = depth[k] == depth[k] ? 1 : 0;
    told[k] = same & known;
  }
}

// 1 where a tile has that label, else 0.
void tell_label(const std::uint8_t* label, std::uint8_t is, std::uint8_t* HWY_RESTRICT told,
                std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) told[k] = label[k] == is ? 1 : 0;
}

void low_and_high(const float* a, const float* b, float* HWY_RESTRICT low, float* HWY_RESTRICT high,
                  float* HWY_RESTRICT sum, int count) {
  for (int i = 0; i < count; ++i) {
    low[i] = a[i] < b[i] ? a[i] : b[i];
    high[i] = a[i] > b[i] ? a[i] : b[i];
    sum[i] = a[i] + b[i];
  }
}

}  // namespace

MovingMask::MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings)
    : noise_(noise),
      settings_(settings),
      space_(noise, settings.space),
      groups_(settings.groups),
      outline_(settings.grow_px),
      stood_(kToStand) {
  PALPABLE_EXPECT(settings.step > 0 && settings.sigmas >= 0, "a tolerance is not negative");
}

void MovingMask::resize(const DepthImage& depth) {
  const int width = (depth.width() + kTile - 1) / kTile;
  const int height = (depth.height() + kTile - 1) / kTile;
  if (depth_size_ == std::pair(depth.width(), depth.height())) return;
  depth_size_ = {depth.width(), depth.height()};
  tile_depth_ = DepthImage(width, height);
  tile_label_ = tile_moves_ = tile_static_ = Image<std::uint8_t>(width, height);
  ray_depth_ = DepthImage((width + 1) / 2, (height + 1) / 2);
  alike_.resize(static_cast<std::size_t>((width + 1) / 2));
  columns_.resize(2 * alike_.size());
  highest_ = sums_ = columns_;
  questions_.reserve(static_cast<std::size_t>(2 * width));
  groups_.resize(width, height);
  outline_.resize(depth.width(), depth.height());
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
    const float scatter = kAlikeSigmas * noise_.sigma_in_float(low);
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
    const auto unexplained = [&] { return groups_.unexplained(q.i, q.j, tile_depth_(q.i, q.j)); };
    if (q.depth > farthest) return kStatic;
    // The map comes first: at a slanted surface rays pass through the cells in which it lies.
    if (q.voxel != nullptr && was_seen(*q.voxel)) {
      const float d = map->units().distance_of(*q.voxel);
      const float sigma = noise_.sigma_in_float(q.depth);
      const float allowed = std::max(step, sigmas * sigma);
      if (d > allowed) return kMoving;
      if (d >= -allowed) {
        return map->weighs(*q.voxel, old_surface, sigma) ? kStatic : unexplained();
      }
    }
    return space.is_free(q.point) ? kMoving : unexplained();
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
  if (sways && !moved_ && moving < settings_.groups.fewest_tiles && compares_ % kQuietEvery != 0)
    return;
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
  moved_ = groups_.find(tile_depth_, tile_label_);
  tell_label(tile_label_.data(), kMoving, tile_moves_.data(), tile_moves_.size());
  return outline_.draw(depth, tile_depth_, tile_moves_, {compared_, compared_ == &drawn_});
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
    if (compared_ == &picture_) picture_.learn(outline_.near_moving(), tile_static_);
  }
  canvas_.follow(depth_camera_, world_from_camera);
  if (compared_ == &drawn_) {
    canvas_.learn(world_from_camera, drawn_, tile_depth_, tile_static_, outline_.near_moving());
  }
  find_ray_depths();
  PinholeCamera rays = tiles_.scaled_down(2);
  rays.width = ray_depth_.width();
  rays.height = ray_depth_.height();
  space_.add(rays, world_from_camera, ray_depth_);
}

}  // namespace palpable
