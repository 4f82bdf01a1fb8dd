/// @file
/// What the desk's renderer keeps on the GPU: meshes, shadow maps, the pictures of an eye.
/// desk_renderer.cpp alone uses it. OpenGL's names and terms; the context must be current.
#pragma once

#include "palpable/base/contract.h"
#include "palpable/geometry/camera.h"
#include "palpable/render/gl_objects.h"
#include "palpable/synth/desk_scene.h"
#include "palpable/synth/lens.h"
#include "palpable/synth/light_box.h"
#include "palpable/synth/seen_box.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Triangles on the GPU, as they are when an exposure begins and when it ends.
struct GpuMesh {
  /// Triangles of what moves: without nails and creases, the same looking away from the sun all the
  /// time, and the others.
  enum class Part { kLit, kDark, kDetailed };

  GlBuffer vertices, last_vertices, indices;
  GlVertexArray array;
  int index_count = 0;
  int image = 0;
  float gloss = 0, sharpness = 1;
  bool in_shadows = true;
  bool is_desk_top = false;  // all at height 0

  GpuMesh() {
    static_assert(kStride == 12 * sizeof(float));
    array.floats(0, vertices, 3, kStride, 0);
    array.floats(1, vertices, 3, kStride, 12);
    array.floats(2, vertices, 2, kStride, 24);
    array.floats(3, vertices, 4, kStride, 32);
    array.indices(indices);
    end_at(vertices);
  }
  /// The same from beginning to end.
  void fill(const PaintedMesh& mesh) {
    end_at(vertices);
    fill_first(mesh);
    indices.stream(std::span<const std::uint32_t>(mesh.indices));
  }
  /// What moves. @param last  the same triangles, moved
  void fill(const PaintedMesh& first, const PaintedMesh& last, const Eigen::Vector3f& to_sun) {
    PALPABLE_EXPECT(first.vertices.size() == last.vertices.size() && first.indices == last.indices,
                    "what moves keeps its triangles while the shutter is open");
    last_vertices.stream(std::span<const PaintedVertex>(last.vertices));
    end_at(last_vertices);
    fill_first(first);
    stream_indices(first, last.vertices, to_sun);
  }
  void draw() const { draw(0, index_count); }
  /// Of a mesh that was filled as a mover.
  void draw(Part part) const { draw(starts[index(part)], count(part)); }
  [[nodiscard]] int count(Part part) const { return starts[index(part) + 1] - starts[index(part)]; }

 private:
  static constexpr int kStride = sizeof(PaintedVertex);
  std::array<int, 4> starts{};  // of the parts in `indices`, and their end
  static std::size_t index(Part part) { return static_cast<std::size_t>(part); }
  void draw(int first, int count) const {
    if (count == 0) return;
    array.bind();
    glDrawElements(
        GL_TRIANGLES, count, GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(static_cast<std::size_t>(first) * sizeof(std::uint32_t)));
  }
  /// The mesh's triangles in their order, and then once more by what lights them.
  /// @param last  as the exposure ends
  void stream_indices(const PaintedMesh& mesh, std::span<const PaintedVertex> last,
                      const Eigen::Vector3f& to_sun) {
    constexpr float kNoCrease = 0.004F;  // darkens by a tenth of a grey level at most
    std::array<std::vector<std::uint32_t>, 3> parts;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const std::array<std::uint32_t, 3> corners = {mesh.indices[i], mesh.indices[i + 1],
                                                    mesh.indices[i + 2]};
      const auto all = [&](const auto& is) {
        return std::all_of(corners.begin(), corners.end(), is);
      };
      const auto extra = [&](std::uint32_t v) -> const Eigen::Vector4f& {
        return mesh.vertices[v].extra;
      };
      // Beside a line that touches the nail's circle.
      const bool no_nail = all([&](auto v) { return extra(v).z() >= 1.0F; }) ||
                           all([&](auto v) { return extra(v).z() <= -1.0F; }) ||
                           all([&](auto v) { return extra(v).w() >= 1.0F; }) ||
                           all([&](auto v) { return extra(v).w() <= -1.0F; });
      const bool no_crease = all([&](auto v) { return extra(v).y() < kNoCrease; });
      const bool dark = all([&](auto v) {
        return std::max(mesh.vertices[v].normal.dot(to_sun), last[v].normal.dot(to_sun)) <= 0.0F;
      });
      const auto part = !no_nail || !no_crease ? Part::kDetailed : dark ? Part::kDark : Part::kLit;
      auto& to = parts[static_cast<std::size_t>(part)];
      to.insert(to.end(), corners.begin(), corners.end());
    }
    std::vector<std::uint32_t> twice = mesh.indices;
    twice.reserve(2 * mesh.indices.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
      starts[p] = static_cast<int>(twice.size());
      twice.insert(twice.end(), parts[p].begin(), parts[p].end());
    }
    starts.back() = static_cast<int>(twice.size());
    indices.stream(std::span<const std::uint32_t>(twice));
  }
  void end_at(const GlBuffer& buffer) {
    array.floats(4, buffer, 3, kStride, 0);
    array.floats(5, buffer, 3, kStride, 12);
  }
  void fill_first(const PaintedMesh& mesh) {
    vertices.stream(std::span<const PaintedVertex>(mesh.vertices));
    index_count = static_cast<int>(mesh.indices.size());
    image = mesh.image;
    gloss = mesh.gloss;
    sharpness = mesh.sharpness;
    in_shadows = mesh.in_shadows;
    is_desk_top =
        in_shadows && std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                  [](const PaintedVertex& v) { return v.position.z() == 0.0F; });
  }
};

/// A depth picture from the light, compared and filtered by the texture unit. Outside is lit.
struct ShadowMap {
  GlTexture depth;
  GlFramebuffer target;
  /// 0..1 across the map, z too, from the desk frame.
  Eigen::Matrix4d light;
  /// How much light reaches the desk's top, 0..1, where the map sees it.
  GlTexture top;
  GlFramebuffer top_target;

  ShadowMap(int size, const Eigen::Matrix4d& light_from_desk_matrix)
      : depth(GL_DEPTH_COMPONENT32F, size, size, GL_LINEAR),
        target({}, &depth),
        light(light_from_desk_matrix),
        top(GL_R8, size, size, GL_LINEAR) {
    const std::array<const GlTexture*, 1> colors = {&top};
    top_target = GlFramebuffer(colors, nullptr);
    const GLuint name = depth.get();
    glTextureParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    const std::array<float, 4> lit = {1, 1, 1, 1};
    glTextureParameterfv(name, GL_TEXTURE_BORDER_COLOR, lit.data());
    glNamedFramebufferDrawBuffer(target.get(), GL_NONE);
    glNamedFramebufferReadBuffer(target.get(), GL_NONE);
  }
  /// How far its four comparisons lie apart: an edge of about three texels.
  [[nodiscard]] float spread() const { return 2.25F / static_cast<float>(depth.width()); }
  /// z of the desk's top: dot with (u, v, 1).
  [[nodiscard]] Eigen::Vector3f depth_of_top() const {
    Eigen::Matrix3d uv1_from_xy1;  // of points at height 0
    uv1_from_xy1 << light.block<2, 2>(0, 0), light.block<2, 1>(0, 3), 0, 0, 1;
    const Eigen::RowVector3d z(light(2, 0), light(2, 1), light(2, 3));
    return (z * uv1_from_xy1.inverse()).transpose().cast<float>();
  }
};

/// Pictures of one eye that an exposure is the mean of, with one depth buffer.
struct PictureStack {
  GlTextureArray pictures;
  std::vector<GlFramebuffer> targets;

  /// Makes room for `count` pictures, at least; what they show is lost when there was less.
  void hold(int count, const PinholeCamera& view, const GlTexture& depth) {
    if (count <= pictures.layers()) return;
    targets.clear();
    pictures = GlTextureArray(GL_RGBA8, view.width, view.height, count, GL_LINEAR);
    for (int i = 0; i < count; ++i) targets.emplace_back(pictures, i, depth);
  }
};

/// How many px more than the lens sees the ideal picture shows on each side: an exposure is made of
/// pictures that are turned a little.
inline constexpr int kIdealMargin = 16;

/// One eye: its lens and the pictures on the way.
struct Eye {
  DistortedCamera camera;
  PinholeCamera ideal;
  GlTexture ideal_color, ideal_depth, lens_map, raw_color;
  GlFramebuffer ideal_target, raw_target;
  float gain = 1;
  /// Where raw pixels look, px of the ideal picture, while no row lies lower than calibrated.
  std::vector<Eigen::Vector2f> map;
  float lowered_by = 0;
  /// Rows of the ideal picture that a raw row needs.
  std::vector<std::array<float, 2>> rows;
  /// What tiles of the raw picture need of the ideal one, row by row, px: left, top, right, bottom.
  static constexpr int kTile = 40;
  int tiles_across = 0;
  std::vector<Eigen::Vector4f> tiles;
  /// Of an exposure: what stands still, and movers where that does not hide them. Empty until
  /// something is exposed.
  PictureStack stills, layers;
  /// The desk without movers, kept while the eye does not move; each frame starts as a copy of it.
  GlTexture still_color, still_depth;
  /// Depths to begin with: far where the lens looks, and where looks that are turned a little do.
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
    const auto w = static_cast<std::size_t>(lens.pinhole.width);
    rows.assign(static_cast<std::size_t>(lens.pinhole.height), {1e9F, -1e9F});
    tiles_across = (lens.pinhole.width + kTile - 1) / kTile;
    tiles.assign(
        static_cast<std::size_t>(tiles_across * ((lens.pinhole.height + kTile - 1) / kTile)),
        {1e9F, 1e9F, -1e9F, -1e9F});
    for (std::size_t i = 0; i < map.size(); ++i) {
      rows[i / w][0] = std::min(rows[i / w][0], map[i].y());
      rows[i / w][1] = std::max(rows[i / w][1], map[i].y());
      Eigen::Vector4f& tile =
          tiles[i / w / kTile * static_cast<std::size_t>(tiles_across) + i % w / kTile];
      tile.head<2>() = tile.head<2>().cwiseMin(map[i]);
      tile.tail<2>() = tile.tail<2>().cwiseMax(map[i]);
    }
    const auto fill = [&](GlTexture& depth, int margin) {
      depth.upload(0, 0, ideal.width, ideal.height, GL_DEPTH_COMPONENT, GL_FLOAT,
                   depth_where_seen(map, ideal, margin).data());
    };
    fill(seen_depth, 1);  // the place of a look-up is rounded
    fill(seen_depth_turned, kIdealMargin);
    upload_lens_map();
  }

  /// Sets by how many raw px the picture lies lower than calibrated.
  void lower(float rows_px) {
    if (rows_px == lowered_by) return;
    lowered_by = rows_px;
    upload_lens_map();
  }

  /// Pixels of the ideal picture to places in its texture, 0..1; homogeneous.
  [[nodiscard]] Eigen::Matrix3d place_from_pixel() const {
    Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
    m(0, 0) = 1.0 / ideal.width;
    m(0, 2) = 0.5 / ideal.width;
    m(1, 1) = 1.0 / ideal.height;
    m(1, 2) = 0.5 / ideal.height;
    return m;
  }
  /// Rays (x/Z, y/Z, 1) to places.
  [[nodiscard]] Eigen::Matrix3d place_from_ray() const {
    Eigen::Matrix3d pixel_from_ray;
    pixel_from_ray << ideal.fx_px, 0, ideal.cx_px, 0, ideal.fy_px, ideal.cy_px, 0, 0, 1;
    return place_from_pixel() * pixel_from_ray;
  }

  /// The part of the ideal picture that looks see which are not turned.
  [[nodiscard]] Box without_margin() const {
    return {kIdealMargin, kIdealMargin, ideal.width - 2 * kIdealMargin,
            ideal.height - 2 * kIdealMargin};
  }

  /// The tiles of the raw picture that look into any of some rectangles of the ideal one.
  [[nodiscard]] Tiles raw_tiles(std::span<const Box> in_ideal) const {
    constexpr float kFilter = 1;  // px that a filtered look-up reads beyond its place
    Tiles found(camera.pinhole.width, camera.pinhole.height, kTile);
    for (const Box& box : in_ideal) {
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
  void upload_lens_map() {
    const int w = camera.pinhole.width, h = camera.pinhole.height;
    const Eigen::Array2f size(static_cast<float>(ideal.width), static_cast<float>(ideal.height));
    std::vector<Eigen::Vector2f> places(map.size());
    for (int y = 0; y < h; ++y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, h - 1);
      const auto at = [&](int x, int row) -> const Eigen::Vector2f& {
        return map[static_cast<std::size_t>(row) * static_cast<std::size_t>(w) +
                   static_cast<std::size_t>(x)];
      };
      for (int x = 0; x < w; ++x) {
        const Eigen::Vector2f down =
            (at(x, below) - at(x, above)) / static_cast<float>(below - above);
        places[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
               static_cast<std::size_t>(x)] =
            ((at(x, y) - lowered_by * down).array() + 0.5F) / size;
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

/// The truth's own target.
struct DepthTarget {
  GlTexture z, depth;
  GlFramebuffer target;
  explicit DepthTarget(const PinholeCamera& view)
      : z(GL_RG32F, view.width, view.height),
        depth(GL_DEPTH_COMPONENT32F, view.width, view.height) {
    const std::array<const GlTexture*, 1> colors = {&z};
    target = GlFramebuffer(colors, &depth);
  }
};

}  // namespace palpable
