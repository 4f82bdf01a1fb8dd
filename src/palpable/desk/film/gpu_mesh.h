/// @file
/// Triangles on the GPU. The OpenGL context must be current.
#pragma once

#include "palpable/common/base/contract.h"
#include "palpable/desk/film/painted_mesh.h"
#include "palpable/live/render/gl_objects.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// Triangles on the GPU. A moving mesh has two sets of vertices, at the beginning and at the end of
/// an exposure; the shaders interpolate between them.
struct GpuMesh {
  /// The parts of a moving mesh by the shader that they need.
  enum class Part {
    kLit,      ///< without nails and creases
    kDark,     ///< as kLit, and facing away from the sun during the whole exposure
    kDetailed  ///< with nails or creases
  };

  GlBuffer vertices, last_vertices, indices;
  GlVertexArray array;
  int index_count = 0;
  int image = 0;
  float gloss = 0, sharpness = 1;
  bool in_shadows = true;
  bool is_desk_top = false;  // at height 0 with shadows on it

  GpuMesh() {
    static_assert(kStride == 12 * sizeof(float));
    array.floats(0, vertices, 3, kStride, 0);
    array.floats(1, vertices, 3, kStride, 12);
    array.floats(2, vertices, 2, kStride, 24);
    array.floats(3, vertices, 4, kStride, 32);
    array.indices(indices);
    end_at(vertices);
  }
  /// Uploads a still mesh.
  void fill(const PaintedMesh& mesh) {
    end_at(vertices);
    fill_first(mesh);
    indices.stream(std::span<const std::uint32_t>(mesh.indices));
  }
  /// Uploads a moving mesh.
  /// @param first,last  the mesh at the beginning and at the end of the exposure, with the same
  ///                    triangles
  void fill(const PaintedMesh& first, const PaintedMesh& last, const Eigen::Vector3f& to_sun) {
    PALPABLE_EXPECT(first.vertices.size() == last.vertices.size() && first.indices == last.indices,
                    "a moving mesh keeps its triangles while the shutter is open");
    last_vertices.stream(std::span<const PaintedVertex>(last.vertices));
    end_at(last_vertices);
    fill_first(first);
    stream_indices(first, last.vertices, to_sun);
  }
  void draw() const { draw(0, index_count); }
  /// Draws one part. Only for a moving mesh.
  void draw(Part part) const { draw(starts[index(part)], count(part)); }
  [[nodiscard]] int count(Part part) const { return starts[index(part) + 1] - starts[index(part)]; }

 private:
  static constexpr int kStride = sizeof(PaintedVertex);
  std::array<int, 4> starts{};  // first index of each part in `indices`, and the end
  static std::size_t index(Part part) { return static_cast<std::size_t>(part); }
  void draw(int first, int count) const {
    if (count == 0) return;
    array.bind();
    glDrawElements(
        GL_TRIANGLES, count, GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(static_cast<std::size_t>(first) * sizeof(std::uint32_t)));
  }
  /// Uploads all triangles in their order (for shadows and depth), followed by the same triangles
  /// sorted by Part.
  /// @param last  vertices at the end of the exposure
  void stream_indices(const PaintedMesh& mesh, std::span<const PaintedVertex> last,
                      const Eigen::Vector3f& to_sun) {
    constexpr float kNoCrease = 0.004F;  // weaker creases darken by 0.1 grey levels at most
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
      // True if all corners lie beyond one side of the square around the unit circle of the nail.
      const bool no_nail = all([&](auto v) { return extra(v).z() >= 1.0F; }) ||
                           all([&](auto v) { return extra(v).z() <= -1.0F; }) ||
                           all([&](auto v) { return extra(v).w() >= 1.0F; }) ||
                           all([&](auto v) { return extra(v).w() <= -1.0F; });
      const bool no_crease = all([&](auto v) { return extra(v).y() < kNoCrease; });
      const bool dark = all([&](auto v) {
        return std::max(mesh.vertices[v].normal.dot(to_sun), last[v].normal.dot(to_sun)) <= 0.0F;
      });
      const auto part = !no_nail || !no_crease ? Part::kDetailed : dark ? Part::kDark : Part::kLit;
      auto& to = parts[index(part)];
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

}  // namespace palpable
