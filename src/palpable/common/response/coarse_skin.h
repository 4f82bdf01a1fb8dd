/// @file
/// A skin that is coarser than the body's, on which its tables of touch are: a fine skin moves with
/// it (carried_skin.h).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct CoarseSkin {
  SurfaceMesh surface;              ///< m, body frame, where presses begin
  std::vector<std::uint8_t> fixed;  ///< (V) 1 where the support holds the vertex
};

}  // namespace palpable
