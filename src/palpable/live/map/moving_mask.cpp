#include "palpable/live/map/moving_mask.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/map/tile_samples.h"

#include <algorithm>
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

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// A square of 2 x 2 tiles is smooth, and looked up once at its mean depth, if its depths differ by
// at most kSmoothShare of the depth or by at most kSmoothSigmas sigma. (Four measurements of the
// same depth span 2.1 sigma on average, and exceed 4 sigma in 2.5 % of the squares.) Two adjacent
// smooth squares are looked up together if their means differ by at most kSmoothShare.
constexpr float kSmoothShare = 0.02F;
constexpr float kSmoothSigmas = 4;

constexpr int kFloatsOfLine = 16;  // floats of a cache line

// A tile counts as too close to be measured when at least this many of its 16 pixels are too close.
constexpr int kTooClosePixels = 3;

// Number of tiles, among a tile and its eight neighbours. A tile that looks the same overrules its
// own depth only if this many look like the scene; with fewer it may look so by chance. And a tile
// without depth that looks the same is treated as changed if this many are changed.
constexpr int kFewestAlike = 5;
// A tile without depth whose look is undecided or shaded is treated as changed if this many of the
// nine are changed: it may be a dark part of a moving object.
constexpr int kFewestBeside = 3;

// Frames without camera motion after which the camera counts as standing still. Before, it may be
// swaying and pausing for a moment.
constexpr int kToStand = 12;

// Frames without camera motion after which the map is assumed to contain all surfaces in view that
// can be measured.
constexpr int kToKnow = 60;

// While nothing moves, the canvas of a camera that sways is drawn only in every 4th frame, which is
// enough to learn from.
constexpr int kQuietEvery = 4;

// The picture stays valid while the camera's motion shifts things at a distance of kNearThings m by
// less than kSameView px.
constexpr double kSameView = 0.25;
constexpr double kNearThings = 0.3;

// @param a, b  world_from_camera
bool same_view(const Rigid3& a, const Rigid3& b, const PinholeCamera& camera) {
  const Rigid3 step = a.inverse() * b;
  if (!step.matrix().allFinite()) return false;
  // |R - 1| = sqrt(8) sin(angle / 2), which is sqrt(2) angle for small angles.
  const double angle = (step.linear() - Eigen::Matrix3d::Identity()).norm() / std::sqrt(2.0);
  return camera.fx_px * (angle + step.translation().norm() / kNearThings) < kSameView;
}

// HWY_RESTRICT declares that arrays do not overlap, which the compiler cannot infer for members. It
// can then vectorise the loops.

// Marks with 1 the tiles that have this label and a depth, the others with 0.
void mark_label_with_depth(const std::uint8_t* label, std::uint8_t wanted, const float* depth,
                           std::uint8_t* HWY_RESTRICT marked, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t same = label[k] == wanted ? 1 : 0, known = depth[k] == depth[k] ? 1 : 0;
    marked[k] = same & known;
  }
}

// Marks with 1 the tiles that have this label, the others with 0.
void mark_label(const std::uint8_t* label, std::uint8_t wanted, std::uint8_t* HWY_RESTRICT marked,
                std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) marked[k] = label[k] == wanted ? 1 : 0;
}

// The number of a tile's pixels that are marked as too close. Its first pixel is (x0, y0).
int count_too_close(const MaskImage& too_close, int x0, int y0) {
  int count = 0;
  const auto across = static_cast<std::size_t>(std::min(kTile, too_close.width() - x0));
  for (int y = y0; y < std::min(y0 + kTile, too_close.height()); ++y) {
    std::uint32_t four = 0;  // four pixels at once, because most often none is marked
    const std::uint8_t* pixels = too_close.row(y) + x0;
    if (across == kTile) {
      std::memcpy(&four, pixels, kTile);
    } else {
      std::memcpy(&four, pixels, across);
    }
    for (; four != 0; four >>= 8) count += (four & 0xFF) != 0 ? 1 : 0;
  }
  return count;
}

void low_and_high(const float* a, const float* b, float* HWY_RESTRICT low, float* HWY_RESTRICT high,
                  float* HWY_RESTRICT sum, int count) {
  for (int i = 0; i < count; ++i) {
    low[i] = a[i] < b[i] ? a[i] : b[i];
    high[i] = a[i] > b[i] ? a[i] : b[i];
    sum[i] = a[i] + b[i];
  }
}

bool is_changed(StaticPicture::Look look) { return look == StaticPicture::kChanged; }
bool is_scene(StaticPicture::Look look) {
  return look == StaticPicture::kSame || look == StaticPicture::kShadow;
}

// The number of tiles, among a tile and its up to eight neighbours, whose look fulfils `looks`.
template <class Looks>
int count_around(const StaticPicture& picture, const Image<std::uint8_t>& tiles, int i, int j,
                 const Looks& looks) {
  int count = 0;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, tiles.height() - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, tiles.width() - 1); ++a) {
      count += looks(picture.tile(a, b)) ? 1 : 0;
    }
  }
  return count;
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
  borrowed_ = MaskImage(depth.width(), depth.height());
  ray_depth_ = DepthImage((width + 1) / 2, (height + 1) / 2);
  smooth_.resize((width + 1) / 2);
  lowest_.resize(2 * smooth_.size());
  highest_ = sums_ = lowest_;
  look_ups_.reserve(2 * width);
  groups_.resize(width, height);
  outline_.resize(depth.width(), depth.height());
  view_ = {GrayImage(depth.width(), depth.height()), Image<TileColor>(width, height),
           Image<std::uint8_t>(width, height), Image<std::uint8_t>(width, height)};
  drawn_.resize(depth.width(), depth.height(), tile_static_);
}

// Finds each tile's depth, and labels the tiles that are too close to have one.
void MovingMask::sample(const SeenFrame& seen) {
  const DepthImage& depth = seen.depth;
  const int width = depth.width(), height = depth.height(), tiles = tile_depth_.width();
  const auto& [x0, y0] = kTileSamples.front();
  for (int j = 0; j < tile_depth_.height(); ++j) {
    float* found = tile_depth_.row(j);
    std::fill_n(tile_label_.row(j), tiles, kUnknown);
    // Only every fourth row of depth is read, which the hardware prefetcher does not predict.
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
      if (std::isnan(found[i])) sample_other_places(seen, i, j);
    }
  }
}

// Finds the depth of a tile that has none in its middle, and labels it if it is too close.
void MovingMask::sample_other_places(const SeenFrame& seen, int i, int j) {
  const DepthImage& depth = seen.depth;
  float& found = tile_depth_(i, j);
  for (const auto& [dx, dy] : kTileSamples) {  // up to the first sample that has a depth
    const int x = kTile * i + dx, y = kTile * j + dy;
    if (x >= depth.width() || y >= depth.height()) continue;
    found = depth(x, y);
    if (!std::isnan(found)) return;
  }
  if (!seen.too_close.empty() && std::isnan(found) &&
      count_too_close(seen.too_close, kTile * i, kTile * j) >= kTooClosePixels) {
    tile_label_(i, j) = kMoving;
  }
}

// Sets smooth_ for each 2 x 2 tiles of rows j and j1: their mean depth, or 0 if the depths differ
// by more than noise or one is unknown. Most of a picture is smooth, and there four tiles need only
// one look-up.
void MovingMask::find_smooth_squares(int j, int j1) {
  const int width = tile_depth_.width(), last = static_cast<int>(lowest_.size()) - 1;
  low_and_high(tile_depth_.row(j), tile_depth_.row(j1), lowest_.data(), highest_.data(),
               sums_.data(), width);
  // If the number of tiles is odd, the last one counts twice.
  lowest_[last] = lowest_[width - 1];
  highest_[last] = highest_[width - 1];
  sums_[last] = sums_[width - 1];
  for (std::size_t i = 0; i < smooth_.size(); ++i) {
    const float low = std::min(lowest_[2 * i], lowest_[2 * i + 1]);
    const float high = std::max(highest_[2 * i], highest_[2 * i + 1]);
    const float sum = sums_[2 * i] + sums_[2 * i + 1];  // NaN if one is unknown
    const float scatter = kSmoothSigmas * noise_.sigma_in_float(low);
    smooth_[i] = sum > 0 && high - low <= std::max(kSmoothShare * low, scatter) ? 0.25F * sum : 0;
  }
}

// Looks up the tiles of one frame in map and free space.
class MovingMask::Labeller {
 public:
  Labeller(MovingMask& mask, const Rigid3& world_from_camera, const SurfaceMap* map)
      : mask_(mask),
        map_(map),
        space_(mask.space_),
        origin_(world_from_camera.translation().cast<float>()),
        farthest_(static_cast<float>(mask.settings_.space.farthest)),
        step_(static_cast<float>(mask.settings_.step)),
        sigmas_(static_cast<float>(mask.settings_.sigmas)),
        frames_to_trust_(static_cast<float>(mask.settings_.frames_to_trust)) {
    const Eigen::Matrix3f R = world_from_camera.linear().cast<float>();
    across_ = R.col(0) / static_cast<float>(mask.tiles_.fx_px);
    down_ = R.col(1) / static_cast<float>(mask.tiles_.fy_px);
    first_ = R.col(2) - static_cast<float>(mask.tiles_.cx_px) * across_ -
             static_cast<float>(mask.tiles_.cy_px) * down_;
    if (map != nullptr) surface_.emplace(*map);
  }

  // Labels the tiles of rows j and j1 = j + 1, or of one row j1 = j. All of them are looked up, and
  // their voxels prefetched, before the first is labelled.
  void label_rows(int j, int j1) {
    mask_.look_ups_.clear();
    mask_.find_smooth_squares(j, j1);
    look_up_rows(j, j1);
    const int width = mask_.tile_label_.width();
    for (const LookUp& found : mask_.look_ups_) {
      const std::uint8_t label = label_of(found);
      mask_.tile_label_(found.i, found.j) = label;
      if (found.across == 1) continue;
      for (int i = found.i; i < std::min(found.i + found.across, width); ++i) {
        mask_.tile_label_(i, j) = mask_.tile_label_(i, j1) = label;
      }
    }
  }

 private:
  void look_up_rows(int j, int j1) {
    const DepthImage& depth = mask_.tile_depth_;
    const int width = depth.width();
    for (int i = 0; i < width; i += 2) {
      const int square = i / 2;
      if (const float Z = mask_.smooth_[square]; Z > 0) {
        const float beside = i + 3 < width ? mask_.smooth_[square + 1] : 0;  // the next square's
        if (std::abs(beside - Z) <= kSmoothShare * Z) {
          look_up(i, j, 0.5F * (Z + beside), 4);
          i += 2;
        } else {
          look_up(i, j, Z, 2);
        }
        continue;
      }
      const int i1 = std::min(i + 1, width - 1);
      look_up(i, j, depth(i, j), 1);
      if (i1 > i) look_up(i1, j, depth(i1, j), 1);
      if (j1 > j) look_up(i, j1, depth(i, j1), 1);
      if (i1 > i && j1 > j) look_up(i1, j1, depth(i1, j1), 1);
    }
  }

  void look_up(int i, int j, float Z, int across) {
    if (!(Z > 0)) return;  // unknown, or too close
    const float x = static_cast<float>(i) + 0.5F * static_cast<float>(across - 1);
    const float y = static_cast<float>(j) + (across > 1 ? 0.5F : 0.0F);
    const Eigen::Vector3f p = origin_ + Z * (first_ + x * across_ + y * down_);
    const Voxel* voxel = surface_ && Z <= farthest_ ? surface_->voxel(p) : nullptr;
    if (voxel != nullptr) hwy::Prefetch(voxel);
    mask_.look_ups_.push_back({p, voxel, Z, i, j, across});
  }

  [[nodiscard]] std::uint8_t label_of(const LookUp& found) {
    const auto unexplained = [&] {
      return mask_.groups_.label_of_unexplained(found.i, found.j,
                                                mask_.tile_depth_(found.i, found.j));
    };
    if (found.depth > farthest_) return kStatic;
    // The map has priority over the free space: on its way to a slanted surface a ray passes
    // through cells that also contain a part of that surface.
    if (found.voxel != nullptr && was_seen(*found.voxel)) {
      const float d = map_->units().distance_of(*found.voxel);
      const float sigma = mask_.noise_.sigma_in_float(found.depth);
      const float allowed = std::max(step_, sigmas_ * sigma);
      if (d > allowed) return kMoving;
      if (d >= -allowed) {
        return map_->weighs(*found.voxel, frames_to_trust_, sigma) ? kStatic : unexplained();
      }
    }
    return space_.is_free(found.point) ? kMoving : unexplained();
  }

  MovingMask& mask_;
  const SurfaceMap* map_;
  FreeSpace::Reader space_;
  std::optional<SurfaceMap::Reader> surface_;
  // The ray of tile (i, j) is origin + Z (first + i across + j down), world frame, m.
  Eigen::Vector3f origin_, across_, down_, first_;
  float farthest_, step_, sigmas_, frames_to_trust_;
};

void MovingMask::label(const Rigid3& world_from_camera, const SurfaceMap* map) {
  constexpr float kFarthestCamera = 400;  // m from the origin; the readers' range is 500 m
  if (!world_from_camera.linear().cast<float>().allFinite() ||
      !(world_from_camera.translation().cast<float>().cwiseAbs().maxCoeff() < kFarthestCamera)) {
    return;
  }
  Labeller labeller(*this, world_from_camera, map);
  const int height = tile_label_.height();
  for (int j = 0; j < height; j += 2) labeller.label_rows(j, std::min(j + 1, height - 1));
}

// Compares the frame with the picture (if the camera stands still) or with the canvas (if it
// sways), and corrects the labels. A tile that looks like the scene is static whatever its depth: a
// matcher assigns a hand's depth to the pixels beside it, and arbitrary depths to plain or dark
// regions. A tile that has no depth and has changed may move.
void MovingMask::compare_look(const SeenFrame& seen, const Rigid3& world_from_camera) {
  compared_ = nullptr;
  if (!settings_.look || !compare_with_picture(seen, world_from_camera)) return;
  const bool is_starting = compared_ == &picture_ && picture_.starting();
  for (int j = 0; j < tile_label_.height(); ++j) {
    for (int i = 0; i < tile_label_.width(); ++i) relabel_by_look(*compared_, is_starting, i, j);
  }
}

// Compares the frame and sets compared_; false if there was nothing to compare with.
bool MovingMask::compare_with_picture(const SeenFrame& seen, const Rigid3& world_from_camera) {
  const bool stands = same_view(picture_pose_, world_from_camera, seen.depth_camera);
  const bool sways = canvas_.stays() && (!stands || stood_ < kToStand);
  if (!stands && !sways) return false;
  ++compares_;
  const auto moving = std::count(tile_label_.begin(), tile_label_.end(), kMoving);
  if (sways && !moved_ && moving < settings_.groups.fewest_tiles && compares_ % kQuietEvery != 0) {
    return false;
  }
  mark_label_with_depth(tile_label_.data(), kStatic, tile_depth_.data(), tile_static_.data(),
                        tile_static_.size());
  const int w = seen.depth.width(), h = seen.depth.height();
  const GrayImage& luma = seen.left_half.empty() ? seen.left : seen.left_half;
  if (sways) {
    canvas_.draw(world_from_camera, view_);
    if (drawn_.compare(luma, seen.color, w, h, tile_static_, view_)) compared_ = &drawn_;
  } else if (picture_.compare(luma, seen.color, w, h, tile_static_)) {
    compared_ = &picture_;
  }
  return compared_ != nullptr;
}

void MovingMask::relabel_by_look(const StaticPicture& picture, bool is_starting, int i, int j) {
  std::uint8_t& label = tile_label_(i, j);
  const StaticPicture::Look look = picture.tile(i, j);
  if (label == kStatic && look != StaticPicture::kChanged && !is_starting) return;  // most tiles
  if (is_starting && look == StaticPicture::kNothing) {
    // While the picture is being learnt, the false depths of a plain desk must not count as moving.
    label = std::min<std::uint8_t>(label, kUnexplained);
  } else if (label == kStatic) {
    // Possibly a hand that lies flat on the surface: it moves if it is connected to moving tiles.
    if (look == StaticPicture::kChanged) label = kUnexplained;
  } else if (std::isnan(tile_depth_(i, j))) {
    relabel_without_depth(picture, i, j);
  } else {
    relabel_with_depth(picture, i, j);
  }
}

// A changed tile may move. So may a tile among changed tiles that is shaded, undecided, or the same
// by chance.
void MovingMask::relabel_without_depth(const StaticPicture& picture, int i, int j) {
  std::uint8_t& label = tile_label_(i, j);
  const StaticPicture::Look look = picture.tile(i, j);
  const int fewest = look == StaticPicture::kChanged ? 0
                     : look == StaticPicture::kSame  ? kFewestAlike
                                                     : kFewestBeside;
  if (fewest == 0 || count_around(picture, tile_label_, i, j, is_changed) >= fewest) {
    if (label == kUnknown) label = kChanged;
  } else if (is_scene(look)) {
    label = kUnknown;
  }
}

void MovingMask::relabel_with_depth(const StaticPicture& picture, int i, int j) {
  std::uint8_t& label = tile_label_(i, j);
  const StaticPicture::Look look = picture.tile(i, j);
  const bool shows_scene = look == StaticPicture::kSame
                               ? count_around(picture, tile_label_, i, j, is_scene) >= kFewestAlike
                               : look == StaticPicture::kShadow && picture.is_plain(i, j);
  const bool moves = label >= kChanged && label != kCarried;
  if (shows_scene) {
    // The matcher has copied its depth from a neighbour.
    if (is_borrowed(picture, i, j)) mark_borrowed(i, j);
    label = kUnknown;
    tile_depth_(i, j) = kNaN;
  } else if (look == StaticPicture::kShadow && !moves) {
    label = kStatic;  // only its neighbours suggest a motion: it is the scene in shadow
  }
}

// Whether the depth of a tile that looks like the scene is known not to be the scene's. This needs
// a look that is as old as the picture, because a later one may be that of a new object, and a
// camera that has stood long enough for the map to contain the scene there.
bool MovingMask::is_borrowed(const StaticPicture& picture, int i, int j) const {
  if (&picture != &picture_ || stood_ < kToKnow || !picture.looks_as_ever(i, j)) return false;
  return tile_label_(i, j) == kMoving || picture.is_plain(i, j);
}

void MovingMask::mark_borrowed(int i, int j) {
  const int across = std::min(kTile, borrowed_.width() - kTile * i);
  for (int y = kTile * j; y < std::min(kTile * (j + 1), borrowed_.height()); ++y) {
    std::fill_n(borrowed_.row(y) + kTile * i, across, std::uint8_t{255});
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
  // A tile's ray is that of its first sample, pixel (2, 2) of 4 x 4.
  tiles_ = {tile_depth_.width(), tile_depth_.height(),  c.fx_px / kTile,
            c.fy_px / kTile,     (c.cx_px - 2) / kTile, (c.cy_px - 2) / kTile};
  sample(seen);
  label(world_from_camera, map);
  std::fill(borrowed_.begin(), borrowed_.end(), std::uint8_t{0});
  compare_look(seen, world_from_camera);
  moved_ = groups_.find(tile_depth_, tile_label_);
  mark_label(tile_label_.data(), kMoving, tile_moves_.data(), tile_moves_.size());
  return outline_.draw(depth, tile_depth_, tile_moves_, {compared_, compared_ == &drawn_});
}

// Finds the nearest depth of each 2 x 2 tiles, so that a ray ends in front of the nearest surface
// beside it.
void MovingMask::find_ray_depths() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const int width = tile_depth_.width(), height = tile_depth_.height();
  for (int j = 0; j < ray_depth_.height(); ++j) {
    const float* above = tile_depth_.row(2 * j);
    const float* below = tile_depth_.row(std::min(2 * j + 1, height - 1));
    for (int i = 0; i < width; ++i) {
      const float nearest = above[i] < kInfinity ? above[i] : kInfinity;  // a NaN is not less
      lowest_[i] = below[i] < nearest ? below[i] : nearest;
    }
    for (int i = 0; i < ray_depth_.width(); ++i) {
      const float nearest = std::min(lowest_[2 * i], lowest_[std::min(2 * i + 1, width - 1)]);
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
