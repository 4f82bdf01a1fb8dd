#include "palpable/map/scene_canvas.h"

#include "palpable/base/contract.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr int kTile = StaticPicture::kTile;
constexpr float kMiddle = 1.5F;    // of a tile, from its first pixel
constexpr int kTurns = 4;          // frames in which all tiles are looked at
constexpr float kNearest = 0.05F;  // m
constexpr float kFarthest = 1e3F;  // m; so is no depth that is infinite
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Beyond it nothing is in a picture, px. Whole numbers below by cutting off what is positive: a
// call of floor() for each tile would cost more than all else.
constexpr int kFarOut = 1 << 13;
bool is_near(float u, float v) {
  return std::abs(u) < static_cast<float>(kFarOut) && std::abs(v) < static_cast<float>(kFarOut);
}
int round_to_int(float a) { return static_cast<int>(a + (kFarOut + 0.5F)) - kFarOut; }
int tile_of(float pixel) {
  return static_cast<int>((pixel + (kFarOut + 0.5F)) * (1.0F / kTile)) - kFarOut / kTile;
}

// Where a pixel of one view lies in another: w (u, v, 1) = Z M (x, y, 1) + m.
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

}  // namespace

SceneCanvas::SceneCanvas(const SceneCanvasSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.margin >= 0 && settings.distance > 0, "a margin is not negative");
  PALPABLE_EXPECT(settings.frames_to_stay >= 0 && settings.visits_to_renew >= 1 &&
                      settings.visits_to_renew <= 255,
                  "frames are counted from 1");
}

void SceneCanvas::resize(const PinholeCamera& camera) {
  if (camera.width == camera_.width && camera.height == camera_.height) return;
  const int tiles = camera.width / kTile, rows = camera.height / kTile;
  const int wide = tiles + 2 * settings_.margin, high = rows + 2 * settings_.margin;
  luma_ = GrayImage(kTile * wide, kTile * high);
  colors_ = Image<TileColor>(wide, high);
  depth_ = DepthImage(wide, high, kNaN);
  strange_ = Image<std::uint8_t>(wide, high);
  sources_ = Image<Source>(tiles, rows);
  nearest_ = DepthImage(tiles, rows);
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
  // |R - 1| = sqrt(8) sin(angle / 2), which is sqrt(2) angle where it matters.
  const double angle = (gone.linear() - Eigen::Matrix3d::Identity()).norm() / std::sqrt(2.0);
  const double pixels =
      depth_camera.fx_px * (angle + gone.translation().norm() / settings_.distance);
  if (stayed_ > 0 && pixels < kTile * settings_.margin) {
    ++stayed_;
    return;
  }
  world_from_key_ = world_from_camera;
  stayed_ = 1;
  std::fill(depth_.begin(), depth_.end(), kNaN);
}

// Whether the four by four pixels from (x, y) of the canvas on are known.
bool SceneCanvas::holds(int x, int y) const {
  if (x < 0 || y < 0 || x + kTile > luma_.width() || y + kTile > luma_.height()) return false;
  const int i0 = x / kTile, i1 = (x + kTile - 1) / kTile;
  const int j0 = y / kTile, j1 = (y + kTile - 1) / kTile;
  const float sum = depth_(i0, j0) + depth_(i1, j0) + depth_(i0, j1) + depth_(i1, j1);
  return !std::isnan(sum);
}

void SceneCanvas::draw(const Rigid3& world_from_camera, PictureView& view) {
  const int tiles = sources_.width(), rows = sources_.height(), margin = settings_.margin;
  std::fill(sources_.begin(), sources_.end(), Source{});
  std::fill(nearest_.begin(), nearest_.end(), std::numeric_limits<float>::infinity());
  const Transfer transfer(camera_, world_from_camera.inverse(Eigen::Isometry) * world_from_key_);
  for (int j = 0; j < depth_.height(); ++j) {
    const float y = static_cast<float>(kTile * (j - margin)) + kMiddle;
    for (int i = 0; i < depth_.width(); ++i) {
      const float Z = depth_(i, j);
      if (std::isnan(Z)) continue;
      const float x = static_cast<float>(kTile * (i - margin)) + kMiddle;
      const Eigen::Vector3f p = transfer(x, y, Z);
      if (!(p.z() > kNearest && p.z() < kFarthest)) continue;
      const float w = 1 / p.z(), u = w * p.x(), v = w * p.y();
      if (!is_near(u, v)) continue;
      const int a = tile_of(u), b = tile_of(v);
      if (a < 0 || b < 0 || a >= tiles || b >= rows || p.z() >= nearest_(a, b)) continue;
      nearest_(a, b) = p.z();
      sources_(a, b) = {static_cast<std::int16_t>(round_to_int(x - u)),
                        static_cast<std::int16_t>(round_to_int(y - v)),
                        static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)};
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < tiles; ++i) {
      Source from = sources_(i, j);
      if (from.i < 0 && i > 0 && i + 1 < tiles && sources_(i + 1, j).i >= 0) {
        from = sources_(i - 1, j);
      }
      if (from.i < 0 && j > 0 && j + 1 < rows && sources_(i, j + 1).i >= 0) {
        from = sources_(i, j - 1);
      }
      const int x = kTile * (i + margin) + from.dx, y = kTile * (j + margin) + from.dy;
      const bool known = from.i >= 0 && holds(x, y);
      view.known(i, j) = known ? 1 : 0;
      if (known) view.colors(i, j) = colors_(from.i, from.j);
      for (int k = 0; k < kTile; ++k) {
        std::uint8_t* to = view.luma.row(kTile * j + k) + kTile * i;
        if (known) {
          std::copy_n(luma_.row(y + k) + x, kTile, to);
        } else {
          std::fill_n(to, kTile, std::uint8_t{0});
        }
      }
    }
  }
}

void SceneCanvas::learn(const Rigid3& world_from_camera, const StaticPicture& picture,
                        const DepthImage& tile_depth, const Image<std::uint8_t>& is_static,
                        const Image<std::uint8_t>& moves) {
  const Transfer transfer(camera_, world_from_key_.inverse(Eigen::Isometry) * world_from_camera);
  const GrayImage& now = picture.luma();
  const int margin = settings_.margin;
  ++frame_;
  for (int j = 0; j < sources_.height(); ++j) {
    for (int i = (frame_ + 2 * j) % kTurns; i < sources_.width(); i += kTurns) {
      if (is_static(i, j) == 0 || moves(i, j) != 0) continue;
      const float u = static_cast<float>(kTile * i) + kMiddle;
      const float v = static_cast<float>(kTile * j) + kMiddle;
      const Eigen::Vector3f p = transfer(u, v, tile_depth(i, j));
      if (!(p.z() > kNearest && p.z() < kFarthest)) continue;
      const float x = p.x() / p.z(), y = p.y() / p.z();
      if (!is_near(x, y)) continue;
      const int a = tile_of(x) + margin, b = tile_of(y) + margin;
      if (a < 0 || b < 0 || a >= depth_.width() || b >= depth_.height()) continue;
      std::uint8_t& strange = strange_(a, b);
      if (!std::isnan(depth_(a, b))) {
        const bool changed = picture.tile(i, j) == StaticPicture::kChanged;
        strange = static_cast<std::uint8_t>(changed ? strange + 1 : 0);
        if (strange >= settings_.visits_to_renew) depth_(a, b) = kNaN;
        continue;
      }
      const TileColor* color = picture.color(i, j);
      if (color == nullptr) continue;
      const int from_x = kTile * (a - margin) - round_to_int(x - u);
      const int from_y = kTile * (b - margin) - round_to_int(y - v);
      if (from_x < 0 || from_y < 0 || from_x + kTile > now.width() ||
          from_y + kTile > now.height()) {
        continue;
      }
      for (int k = 0; k < kTile; ++k) {
        std::copy_n(now.row(from_y + k) + from_x, kTile, luma_.row(kTile * b + k) + kTile * a);
      }
      colors_(a, b) = *color;
      depth_(a, b) = p.z();
      strange = 0;
    }
  }
}

}  // namespace palpable
