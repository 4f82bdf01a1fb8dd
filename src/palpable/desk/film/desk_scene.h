/// @file
/// Everything on the synthetic desk and round it that does not move, as painted triangles. Desk
/// frame (script/desk_body.h).
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/desk/film/painted_mesh.h"
#include "palpable/desk/script/desk_look.h"

#include <vector>

namespace palpable {

/// PaintedMesh::image of the meshes is an index in `images`.
struct DeskScene {
  std::vector<ColorImage> images;
  std::vector<PaintedMesh> meshes;  ///< what is near the first camera stands last
};

/// A wooden desk with books, a carton, a mug and a written page, in a room. The place round the
/// body is free, and so is the place to its right, where the hand comes from.
[[nodiscard]] DeskScene desk_scene(const DeskLook& look);

}  // namespace palpable
