/// @file
/// Detects a body that is far too large for the view, usually because of a wrong unit of length: a
/// body in millimetres read as metres surrounds the desk, and nothing touches it.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <optional>
#include <string>

namespace palpable {

/// A message with both sizes if the body is larger than the field of view at the body's distance.
/// Empty if it is not, or if the body stands behind the camera.
/// @param body              at rest, body frame; not empty
/// @param camera_from_body  pose of the body in the first frame
[[nodiscard]] std::optional<std::string> larger_than_view(const SurfaceMesh& body,
                                                          const Rigid3& camera_from_body,
                                                          const PinholeCamera& camera);

}  // namespace palpable
