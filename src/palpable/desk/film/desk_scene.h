/// @file
/// All still things on the synthetic desk and round it, as painted triangles. Desk frame
/// (script/desk_body.h).
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/desk/film/painted_mesh.h"
#include "palpable/desk/script/desk_look.h"

#include <vector>

namespace palpable {

/// The meshes and their images; PaintedMesh::image is an index in `images`.
struct DeskScene {
  std::vector<ColorImage> images;
  std::vector<PaintedMesh> meshes;  ///< those near the first camera come last
};

/// A wooden desk with books, a carton, a mug and a written page, in a room. The desk is free round
/// the body and to its right, from where the hand comes.
[[nodiscard]] DeskScene desk_scene(const DeskLook& look);

}  // namespace palpable
