/// @file
/// Triangles with a painted surface, as the GPU reads them. Desk frame (script/desk_body.h).
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// One corner of a painted triangle, as the vertex shader reads it.
struct PaintedVertex {
  Eigen::Vector3f position;  ///< m
  Eigen::Vector3f normal;    ///< unit
  Eigen::Vector2f uv;        ///< 0..1 is the whole image; beyond, the image repeats
  /// x: share of the room's light that arrives; y: 1 in the middle of a crease of the skin, 0 far
  /// from one; z, w: place on a finger nail, whose edge is the unit circle.
  Eigen::Vector4f extra = {1.0F, 0.0F, 9.0F, 9.0F};
};

/// A surface that is painted with one image.
struct PaintedMesh {
  std::vector<PaintedVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three a triangle
  int image = 0;                       ///< index in DeskScene::images, or in mover_images()
  float gloss = 0.0F;                  ///< strength of the highlight
  float sharpness = 20.0F;             ///< exponent of the highlight
  /// true: things on the desk and movers can cast shadows on it. false: it is far away, flat and
  /// without a highlight, so that its light can be computed at the vertices.
  bool in_shadows = true;
};

}  // namespace palpable
