/// @file
/// The coarser skin for which the tables of touch of a body with a fine skin are made. The fine
/// skin moves with it (carried_skin.h).
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct CoarseSkin {
  SurfaceMesh surface;              ///< m, body frame, in the state without contact
  std::vector<std::uint8_t> fixed;  ///< (V) 1 where the support holds the vertex
};

}  // namespace palpable
