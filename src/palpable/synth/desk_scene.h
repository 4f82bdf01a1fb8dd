/// @file
/// What lies on the synthetic desk: triangles with painted surfaces, in the desk frame
/// (press_clip.h).
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/synth/hand.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// One corner of a painted triangle, as the vertex shader reads it.
struct PaintedVertex {
  Eigen::Vector3f position;  ///< m
  Eigen::Vector3f normal;    ///< unit
  Eigen::Vector2f uv;        ///< 0..1 is the image once
  /// x: share of the ambient light that arrives; y: 1 for a crease of the skin; z, w: place on a
  /// finger nail, whose edge is the unit circle.
  Eigen::Vector4f extra = {1.0F, 0.0F, 9.0F, 9.0F};
};

/// A surface with one image.
struct PaintedMesh {
  std::vector<PaintedVertex> vertices;
  std::vector<std::uint32_t> indices;  ///< three a triangle
  int image = 0;                       ///< index in DeskScene::images, or in the hand's two
  float gloss = 0.0F;                  ///< strength of the highlight
  float sharpness = 20.0F;             ///< exponent of the highlight
};

/// All that does not move.
struct DeskScene {
  std::vector<ColorImage> images;
  std::vector<PaintedMesh> meshes;
};

/// A wooden desk before a wall, with books, a carton, a mug, a written page. The place round the
/// body and to its right, where the hand comes from, is free.
[[nodiscard]] DeskScene desk_scene(std::uint64_t seed);

/// The hand's surface: [0] skin, [1] sleeve. Vertices lie on the capsules; between them the
/// triangles stay within 0.09 mm. Normals are those of the capsules' smooth union, so that joints
/// are shaded as a hand and not as a chain of sausages.
[[nodiscard]] std::vector<PaintedMesh> hand_meshes(std::span<const HandCapsule> hand);

}  // namespace palpable
