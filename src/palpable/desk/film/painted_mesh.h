/// @file
/// Triangles with a painted surface in the layout that the GPU reads. Desk frame
/// (script/desk_body.h).
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// One corner of a painted triangle, as the vertex shader reads it.
struct PaintedVertex {
  Eigen::Vector3f position;  ///< m
  Eigen::Vector3f normal;    ///< unit
  Eigen::Vector2f uv;        ///< 0..1 is the whole image; outside, the image repeats
  /// x: share of the room's light that reaches it; y: 1 in the middle of a crease of the skin, 0
  /// far from one; z, w: position on a finger nail, whose edge is the unit circle.
  Eigen::Vector4f extra = {1.0F, 0.0F, 9.0F, 9.0F};
};

/// A surface painted with one image.
struct PaintedMesh {
  std::vector<PaintedVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three per triangle
  int image = 0;                       ///< index in DeskScene::images, or in mover_images()
  float gloss = 0.0F;                  ///< strength of the highlight
  float sharpness = 20.0F;             ///< exponent of the highlight
  /// Whether things on the desk and movers can cast shadows on it. false: it is far away, flat and
  /// without a highlight, so that its light is computed at the vertices only.
  bool in_shadows = true;
};

}  // namespace palpable
