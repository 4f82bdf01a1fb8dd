/// @file
/// One eye of the stereo camera on the GPU: its lens, and all pictures from the ideal one to the
/// raw one. The OpenGL context must be current.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/film/lens.h"
#include "palpable/desk/film/tiles.h"
#include "palpable/live/render/gl_objects.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Pictures whose mean is an exposure; they share one depth buffer.
struct PictureStack {
  GlTextureArray pictures;
  std::vector<GlFramebuffer> targets;

  /// Allocates at least `count` pictures. If there were fewer, their contents are lost.
  void hold(int count, const PinholeCamera& view, const GlTexture& depth) {
    if (count <= pictures.layers()) return;
    targets.clear();
    pictures = GlTextureArray(GL_RGBA8, view.width, view.height, count, GL_LINEAR);
    for (int i = 0; i < count; ++i) targets.emplace_back(pictures, i, depth);
  }
};

/// px, margin of the ideal picture on each side beyond the part that the lens sees. An exposure
/// also samples it with small rotations of the eye, which read the margin.
inline constexpr int kIdealMargin = 16;

/// One eye: its lens, and the pictures from the ideal one, without a lens, to the raw one.
struct Eye {
  DistortedCamera camera;
  PinholeCamera ideal;
  GlTexture ideal_color, ideal_depth, lens_map, raw_color;
  GlFramebuffer ideal_target, raw_target;
  float gain = 1;
  /// For each raw pixel the position in the ideal picture (px) from which its light comes, without
  /// lower().
  std::vector<Eigen::Vector2f> map;
  float lowered_by = 0;
  /// The first and the last row of the ideal picture (px) that each raw row needs.
  std::vector<std::array<float, 2>> rows;
  /// The part of the ideal picture that each tile of the raw picture needs, px: left, top, right,
  /// bottom. Row by row.
  static constexpr int kTile = 40;
  int tiles_across = 0;
  std::vector<Eigen::Vector4f> tiles;
  /// The pictures of an exposure: of the still things, and of the movers where no still thing hides
  /// them. They have no memory until the first exposure.
  PictureStack stills, layers;
  /// The desk without movers, kept while the eye does not move: each frame starts from a copy of
  /// it.
  GlTexture still_color, still_depth;
  /// Initial depth buffers: farthest where the lens looks and nearest elsewhere, so that nothing is
  /// painted there. `turned`: also farthest in the margin that rotated looks read.
  GlTexture seen_depth, seen_depth_turned;
  GlFramebuffer still_target;
  std::optional<Rigid3> still_from_desk, last_from_desk;

  Eye(const DistortedCamera& lens, float gain_)
      : camera(lens),
        ideal(with_margin(ideal_camera_for(lens, lens.pinhole.fx_px))),
        ideal_color(GL_RGBA8, ideal.width, ideal.height, GL_LINEAR),
        ideal_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height),
        lens_map(GL_RG32F, lens.pinhole.width, lens.pinhole.height),
        raw_color(GL_RGBA8, lens.pinhole.width, lens.pinhole.height),
        gain(gain_),
        still_color(GL_RGBA8, ideal.width, ideal.height, GL_LINEAR),
        still_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height),
        seen_depth(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height),
        seen_depth_turned(GL_DEPTH_COMPONENT32F, ideal.width, ideal.height) {
    const std::array<const GlTexture*, 1> ideal_colors = {&ideal_color};
    const std::array<const GlTexture*, 1> still_colors = {&still_color};
    still_target = GlFramebuffer(still_colors, &still_depth);
    const std::array<const GlTexture*, 1> raw_colors = {&raw_color};
    ideal_target = GlFramebuffer(ideal_colors, &ideal_depth);
    raw_target = GlFramebuffer(raw_colors, nullptr);
    map = distortion_map(camera, ideal);
    note_what_rows_and_tiles_need();
    const auto fill = [&](GlTexture& depth, int margin) {
      depth.upload(0, 0, ideal.width, ideal.height, GL_DEPTH_COMPONENT, GL_FLOAT,
                   depth_where_seen(map, ideal, margin).data());
    };
    fill(seen_depth, 1);  // one pixel, for the rounding of positions in the map
    fill(seen_depth_turned, kIdealMargin);
    upload_lens_map();
  }

  /// Sets how many raw rows the picture lies lower than calibrated.
  void lower(float rows_px) {
    if (rows_px == lowered_by) return;
    lowered_by = rows_px;
    upload_lens_map();
  }

  /// From pixels of the ideal picture to positions in its texture (0..1), both homogeneous.
  [[nodiscard]] Eigen::Matrix3d place_from_pixel() const {
    Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
    m(0, 0) = 1.0 / ideal.width;
    m(0, 2) = 0.5 / ideal.width;
    m(1, 1) = 1.0 / ideal.height;
    m(1, 2) = 0.5 / ideal.height;
    return m;
  }
  /// From rays (x/Z, y/Z, 1) to positions in the texture.
  [[nodiscard]] Eigen::Matrix3d place_from_ray() const {
    Eigen::Matrix3d pixel_from_ray;
    pixel_from_ray << ideal.fx_px, 0, ideal.cx_px, 0, ideal.fy_px, ideal.cy_px, 0, 0, 1;
    return place_from_pixel() * pixel_from_ray;
  }

  /// The part of the ideal picture that is seen while the eye does not turn.
  [[nodiscard]] PixelBox without_margin() const {
    return {kIdealMargin, kIdealMargin, ideal.width - 2 * kIdealMargin,
            ideal.height - 2 * kIdealMargin};
  }

  /// Marks the tiles of the raw picture whose light comes from one of the rectangles of the ideal
  /// one.
  [[nodiscard]] Tiles raw_tiles(std::span<const PixelBox> in_ideal) const {
    constexpr float kFilter = 1;  // px, reach of a filtered texture look-up
    Tiles found(camera.pinhole.width, camera.pinhole.height, kTile);
    for (const PixelBox& box : in_ideal) {
      if (box.empty()) continue;
      const Eigen::Vector2f low(static_cast<float>(box.x), static_cast<float>(box.y));
      const Eigen::Vector2f high =
          low + Eigen::Vector2f(static_cast<float>(box.width), static_cast<float>(box.height));
      for (std::size_t t = 0; t < tiles.size(); ++t)
        if ((tiles[t].tail<2>().array() + kFilter >= low.array()).all() &&
            (tiles[t].head<2>().array() - kFilter <= high.array()).all())
          found.marked[t] = true;
    }
    return found;
  }

 private:
  void note_what_rows_and_tiles_need() {
    const int w = camera.pinhole.width, h = camera.pinhole.height;
    rows.assign(h, {1e9F, -1e9F});
    tiles_across = (w + kTile - 1) / kTile;
    tiles.assign(tiles_across * ((h + kTile - 1) / kTile), {1e9F, 1e9F, -1e9F, -1e9F});
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const Eigen::Vector2f& at = map[y * w + x];
        rows[y][0] = std::min(rows[y][0], at.y());
        rows[y][1] = std::max(rows[y][1], at.y());
        Eigen::Vector4f& tile = tiles[y / kTile * tiles_across + x / kTile];
        tile.head<2>() = tile.head<2>().cwiseMin(at);
        tile.tail<2>() = tile.tail<2>().cwiseMax(at);
      }
  }
  void upload_lens_map() {
    const int w = camera.pinhole.width, h = camera.pinhole.height;
    const Eigen::Array2f size(static_cast<float>(ideal.width), static_cast<float>(ideal.height));
    std::vector<Eigen::Vector2f> places(map.size());
    for (int y = 0; y < h; ++y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, h - 1);
      const auto at = [&](int x, int row) -> const Eigen::Vector2f& { return map[row * w + x]; };
      for (int x = 0; x < w; ++x) {
        const Eigen::Vector2f down =
            (at(x, below) - at(x, above)) / static_cast<float>(below - above);
        places[y * w + x] = ((at(x, y) - lowered_by * down).array() + 0.5F) / size;
      }
    }
    lens_map.upload(0, 0, w, h, GL_RG, GL_FLOAT, places.data());
  }

  static PinholeCamera with_margin(PinholeCamera ideal) {
    ideal.width += 2 * kIdealMargin;
    ideal.height += 2 * kIdealMargin;
    ideal.cx_px += kIdealMargin;
    ideal.cy_px += kIdealMargin;
    return ideal;
  }
};

}  // namespace palpable
