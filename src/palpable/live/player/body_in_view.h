/// @file
/// Whether a body fits into what the camera sees: a forgotten unit makes it a house around the
/// desk, which nothing touches.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <optional>
#include <string>

namespace palpable {

/// What to say of a body that is larger than all that the camera sees at the distance where it
/// stands, its size and what is seen there; nothing for others, and for one that stands behind the
/// camera.
/// @param body              at rest, body frame; not empty
/// @param camera_from_body  where the body stands in the first frame
[[nodiscard]] std::optional<std::string> larger_than_view(const SurfaceMesh& body,
                                                          const Rigid3& camera_from_body,
                                                          const PinholeCamera& camera);

}  // namespace palpable
