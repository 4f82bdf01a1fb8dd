#include "palpable/live/map/scene_canvas.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Core>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <hwy/base.h>
#include <hwy/cache_control.h>
#include <limits>

namespace palpable {
namespace {

constexpr float kMiddle = 1.5F;  // px from a tile's first pixel to its middle
constexpr int kTurns = 4;        // frames in which each tile is visited once
// m; tiles that land nearer or farther than this are not drawn, nor are those of infinite depth.
constexpr float kNearestDepth = 0.05F, kFarthestDepth = 1e3F;
constexpr float kUnknownDepth = std::numeric_limits<float>::quiet_NaN();

// px; larger than any picture. It is added before a coordinate is truncated to an integer and
// subtracted afterwards, so that truncation acts on a positive number and equals floor(), which
// would be slower than all the rest.
constexpr int kFarOut = 1 << 13;
constexpr auto kFarOutside = static_cast<float>(kFarOut);
std::int32_t near_mask(float u) { return std::abs(u) < kFarOutside ? -1 : 0; }
bool is_near(float u, float v) { return (near_mask(u) & near_mask(v)) != 0; }
int round_to_int(float a) { return static_cast<int>(a + (kFarOut + 0.5F)) - kFarOut; }
int tile_of(float pixel) {
  return static_cast<int>((pixel + (kFarOut + 0.5F)) * (1.0F / kTile)) - kFarOut / kTile;
}

// The first tile of row j that a frame visits in learn(); it then visits every fourth.
int first_visited(int j, int frame) { return (frame + 2 * j) % kTurns; }

// Maps pixel (x, y) at depth Z of one view to pixel (u, v) at depth w of another:
//
//     w (u, v, 1) = Z M (x, y, 1) + m
struct Transfer {
  Transfer(const PinholeCamera& c, const Rigid3& to_from_from) {
    Eigen::Matrix3d K;
    K << c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1;
    M = (K * to_from_from.linear() * K.inverse()).cast<float>();
    m = (K * to_from_from.translation()).cast<float>();
  }
  [[nodiscard]] Eigen::Vector3f operator()(float x, float y, float Z) const {
    return Z * (M.col(0) * x + M.col(1) * y + M.col(2)) + m;
  }
  Eigen::Matrix3f M;
  Eigen::Vector3f m;
};

// u if the mask is -1, and a coordinate far outside if it is 0.
float inside_or_far(std::int32_t mask, float u) {
  return std::bit_cast<float>((std::bit_cast<std::int32_t>(u) & mask) |
                              (std::bit_cast<std::int32_t>(-kFarOutside) & ~mask));
}

// Computes where a row of tiles lands in another view: in tile (a, b), which may lie outside the
// view, at depth Z, moved by (-dx, -dy) px. The tiles' first pixels are (x0, y), (x0 + 4, y) and so
// on.
void transfer_row(const Transfer& t, const float* HWY_RESTRICT depth, int count, int x0, int y,
                  float* HWY_RESTRICT Z, std::int32_t* HWY_RESTRICT a, std::int32_t* HWY_RESTRICT b,
                  std::int32_t* HWY_RESTRICT dx, std::int32_t* HWY_RESTRICT dy) {
  const float first = static_cast<float>(x0) + kMiddle, v0 = static_cast<float>(y) + kMiddle;
  const Eigen::Vector3f across = t.M.col(0), down = t.M.col(1) * v0, ahead = t.M.col(2), m = t.m;
  for (int i = 0; i < count; ++i) {
    const float u0 = first + static_cast<float>(kTile * i);
    const float z = depth[i] * (across.z() * u0 + down.z() + ahead.z()) + m.z();
    const float w = 1 / z;
    const float u = w * (depth[i] * (across.x() * u0 + down.x() + ahead.x()) + m.x());
    const float v = w * (depth[i] * (across.y() * u0 + down.y() + ahead.y()) + m.y());
    // Without a branch, so that the compiler can vectorise. NaN is not within.
    const std::int32_t within =
        (z > kNearestDepth ? -1 : 0) & (z < kFarthestDepth ? -1 : 0) & near_mask(u) & near_mask(v);
    const float near_u = inside_or_far(within, u), near_v = inside_or_far(within, v);
    Z[i] = z;
    a[i] = tile_of(near_u);
    b[i] = tile_of(near_v);
    dx[i] = round_to_int(u0 - near_u);
    dy[i] = round_to_int(v0 - near_v);
  }
}

}  // namespace

SceneCanvas::SceneCanvas(const SceneCanvasSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.margin >= 0 && settings.distance > 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.frames_to_stay >= 0, "a number of frames is not negative");
}

void SceneCanvas::resize(const PinholeCamera& camera) {
  if (camera.width == camera_.width && camera.height == camera_.height) return;
  const int tiles = camera.width / kTile, rows = camera.height / kTile;
  const int wide = tiles + 2 * settings_.margin, high = rows + 2 * settings_.margin;
  luma_ = GrayImage(kTile * wide, kTile * high);
  colors_ = Image<TileColor>(wide, high);
  depth_ = DepthImage(wide, high, kUnknownDepth);
  sources_ = Image<Source>(tiles, rows);
  nearest_ = DepthImage(tiles, rows);
  const std::vector<std::int32_t> row(wide);
  landing_ = {std::vector<float>(wide), row, row, row, row};
  stayed_ = 0;
}

void SceneCanvas::follow(const PinholeCamera& depth_camera, const Rigid3& world_from_camera) {
  resize(depth_camera);
  camera_ = depth_camera;
  if (!world_from_camera.matrix().allFinite()) {
    stayed_ = 0;
    return;
  }
  const Rigid3 gone = world_from_key_.inverse(Eigen::Isometry) * world_from_camera;
  // |R - 1| = sqrt(8) sin(angle / 2), which is sqrt(2) angle for small angles.
  const double angle = (gone.linear() - Eigen::Matrix3d::Identity()).norm() / std::sqrt(2.0);
  const double pixels =
      depth_camera.fx_px * (angle + gone.translation().norm() / settings_.distance);
  if (stayed_ > 0 && pixels < kTile * settings_.margin) {
    ++stayed_;
    return;
  }
  world_from_key_ = world_from_camera;
  stayed_ = 1;
  std::fill(depth_.begin(), depth_.end(), kUnknownDepth);
}

// Whether all of the 4 x 4 pixels from (x, y) of the canvas on are known.
bool SceneCanvas::holds(int x, int y) const {
  if (x < 0 || y < 0 || x + kTile > luma_.width() || y + kTile > luma_.height()) return false;
  const int i0 = x / kTile, i1 = (x + kTile - 1) / kTile;
  const int j0 = y / kTile, j1 = (y + kTile - 1) / kTile;
  const float sum = depth_(i0, j0) + depth_(i1, j0) + depth_(i0, j1) + depth_(i1, j1);
  return !std::isnan(sum);
}

// Prefetches the part of the canvas from which row j of the frame's tiles will probably be drawn.
// @param like  source of a tile in an earlier row, whose offset is probably similar
void SceneCanvas::prefetch_row(int j, const Source& like) const {
  constexpr int kLine = 64;  // of the cache, bytes
  const int x0 = std::max(kTile * settings_.margin + like.dx, 0);
  const int x1 = std::min(x0 + kTile * sources_.width(), luma_.width());
  const int y = kTile * (j + settings_.margin) + like.dy;
  for (int row = std::max(y, 0); row < std::min(y + kTile, luma_.height()); ++row) {
    for (int x = x0; x < x1; x += kLine) hwy::Prefetch(luma_.row(row) + x);
  }
}

void SceneCanvas::draw(const Rigid3& world_from_camera, PictureView& view) {
  find_sources(world_from_camera);
  const int tiles = sources_.width(), rows = sources_.height(), margin = settings_.margin;
  const std::ptrdiff_t width = luma_.width();
  for (int j = 0; j < rows; ++j) {
    const Source* row = sources_.row(j);
    const Source* above = sources_.row(std::max(j - 1, 0));
    const Source* below = sources_.row(std::min(j + 1, rows - 1));
    std::uint8_t *known = view.known.row(j), *needs_color = view.needs_color.row(j);
    TileColor* colors = view.colors.row(j);
    std::uint8_t* to = view.luma.row(kTile * j);
    const std::ptrdiff_t stride = view.luma.width();
    const int visited = first_visited(j, frame_ + 1);
    prefetch_row(j + 2, row[tiles / 2]);
    for (int i = 0; i < tiles; ++i, to += kTile) {
      Source from = row[i];
      if (from.i < 0 && i > 0 && i + 1 < tiles && row[i + 1].i >= 0) from = row[i - 1];
      if (from.i < 0 && j > 0 && j + 1 < rows && below[i].i >= 0) from = above[i];
      const int x = kTile * (i + margin) + from.dx, y = kTile * (j + margin) + from.dy;
      known[i] = from.i >= 0 && holds(x, y) ? 1 : 0;
      needs_color[i] = known[i] == 0 && i % kTurns == visited ? 1 : 0;
      if (known[i] != 0) {
        colors[i] = colors_(from.i, from.j);
        const std::uint8_t* pixels = luma_.row(y) + x;
        for (int k = 0; k < kTile; ++k) std::memcpy(to + k * stride, pixels + k * width, kTile);
      } else {
        for (int k = 0; k < kTile; ++k) std::memset(to + k * stride, 0, kTile);
      }
    }
  }
}

// Finds for each tile of a frame the tile of the canvas that lands there; the nearest, if there are
// several.
void SceneCanvas::find_sources(const Rigid3& world_from_camera) {
  std::fill(sources_.begin(), sources_.end(), Source{});
  std::fill(nearest_.begin(), nearest_.end(), std::numeric_limits<float>::infinity());
  const Transfer transfer(camera_, world_from_camera.inverse(Eigen::Isometry) * world_from_key_);
  const int margin = settings_.margin;
  for (int j = 0; j < depth_.height(); ++j) {
    float* Z = landing_.Z.data();
    std::int32_t *a = landing_.a.data(), *b = landing_.b.data();
    std::int32_t *dx = landing_.dx.data(), *dy = landing_.dy.data();
    transfer_row(transfer, depth_.row(j), depth_.width(), kTile * -margin, kTile * (j - margin), Z,
                 a, b, dx, dy);
    for (int i = 0; i < depth_.width(); ++i) {
      if (a[i] < 0 || b[i] < 0 || a[i] >= sources_.width() || b[i] >= sources_.height()) continue;
      float& nearest = nearest_(a[i], b[i]);
      if (Z[i] >= nearest) continue;
      nearest = Z[i];
      sources_(a[i], b[i]) = {static_cast<std::int16_t>(dx[i]), static_cast<std::int16_t>(dy[i]),
                              static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)};
    }
  }
}

// Puts 4 x 4 pixels from (x, y) of an image onto tile (a, b) of the canvas.
void SceneCanvas::put_onto(int a, int b, const GrayImage& from, int x, int y,
                           const TileColor& color, float Z) {
  for (int k = 0; k < kTile; ++k) {
    std::copy_n(from.row(y + k) + x, kTile, luma_.row(kTile * b + k) + kTile * a);
  }
  colors_(a, b) = color;
  depth_(a, b) = Z;
}

void SceneCanvas::learn(const Rigid3& world_from_camera, const StaticPicture& picture,
                        const DepthImage& tile_depth, const Image<std::uint8_t>& is_static,
                        const Image<std::uint8_t>& moves) {
  const Transfer transfer(camera_, world_from_key_.inverse(Eigen::Isometry) * world_from_camera);
  const GrayImage& now = picture.luma();
  const int margin = settings_.margin;
  ++frame_;
  for (int j = 0; j < sources_.height(); ++j) {
    for (int i = first_visited(j, frame_); i < sources_.width(); i += kTurns) {
      if (is_static(i, j) == 0 || moves(i, j) != 0) continue;
      const float u = static_cast<float>(kTile * i) + kMiddle;
      const float v = static_cast<float>(kTile * j) + kMiddle;
      const Eigen::Vector3f p = transfer(u, v, tile_depth(i, j));
      if (!(p.z() > kNearestDepth && p.z() < kFarthestDepth)) continue;
      const float x = p.x() / p.z(), y = p.y() / p.z();
      if (!is_near(x, y)) continue;
      const int a = tile_of(x) + margin, b = tile_of(y) + margin;
      if (a < 0 || b < 0 || a >= depth_.width() || b >= depth_.height()) continue;
      if (!std::isnan(depth_(a, b))) continue;
      const TileColor* color = picture.color(i, j);
      if (color == nullptr) continue;
      const int from_x = kTile * (a - margin) - round_to_int(x - u);
      const int from_y = kTile * (b - margin) - round_to_int(y - v);
      if (from_x < 0 || from_y < 0 || from_x + kTile > now.width() ||
          from_y + kTile > now.height()) {
        continue;
      }
      put_onto(a, b, now, from_x, from_y, *color, p.z());
    }
  }
}

}  // namespace palpable
