/// @file
/// What lies on the synthetic desk: triangles with painted surfaces, in the desk frame
/// (desk_body.h).
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/synth/hand.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
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
  int image = 0;                       ///< index in DeskScene::images, or in mover_images()
  float gloss = 0.0F;                  ///< strength of the highlight
  float sharpness = 20.0F;             ///< exponent of the highlight
  /// Lies where the desk's things cast shadows. Else it is far away and flat, without a highlight:
  /// light is worked out at its vertices.
  bool in_shadows = true;
};

/// Which desk in which room.
struct DeskLook {
  std::uint64_t seed = 1;
  /// A room of 9 x 11 m with a corridor behind it, so that surfaces lie up to 15.5 m away; else
  /// a wall right behind the desk.
  bool room = true;
  bool left_free = false;     ///< nothing lies left of the body: a second hand comes from there
  bool bare = false;          ///< nothing on the desk or the walls, no texture anywhere
  double skin_texture = 1.0;  ///< contrast of the skin's blotches and lines against a real hand's
  double skin_gloss = 0.20;   ///< strength of the highlight on skin
};

/// All that does not move.
struct DeskScene {
  std::vector<ColorImage> images;
  std::vector<PaintedMesh> meshes;
};

/// A wooden desk with books, a carton, a mug, a written page. The place round the body and to its
/// right, where the hand comes from, is free.
[[nodiscard]] DeskScene desk_scene(const DeskLook& look);

/// What movers are painted with; PaintedMesh::image of mover_meshes() counts in them.
[[nodiscard]] std::vector<ColorImage> mover_images(const DeskLook& look);

/// The movers' surfaces, one mesh for each image. Vertices lie on the capsules; between them the
/// triangles stay within 0.09 mm. Normals of skin and sleeve are those of the capsules' smooth
/// union, so that joints are shaded as a hand and not as a chain of sausages. A cup is turned as
/// one piece where its frame is given, and its capsules are left out. So are triangles that lie
/// inside of another capsule, where nobody sees them.
/// @param also  the same movers at another moment: only what is inside then, too, is left out, so
///              that both moments have the same triangles
[[nodiscard]] std::vector<PaintedMesh> mover_meshes(std::span<const HandCapsule> capsules,
                                                    const std::optional<Rigid3>& desk_from_cup,
                                                    const DeskLook& look,
                                                    std::span<const HandCapsule> also = {});

}  // namespace palpable
