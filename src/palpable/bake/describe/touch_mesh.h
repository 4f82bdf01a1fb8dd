/// @file
/// A coarser mesh for tables of touch, where the body's own mesh is too fine: the size of tables
/// grows with the square of the number of vertices on the skin. The coarser mesh carries the body's
/// skin (response/touch_skin.h).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <optional>

namespace palpable {

/// Number of vertices of a skin above which tables are made on a coarser mesh, unless the
/// description says otherwise, and the approximate number of vertices of the coarser skin.
inline constexpr int kFineSkin = 8000, kCoarseSkin = 4000;

/// m: edge of the coarser mesh; nothing where tables are made on the body's own mesh. A given
/// volume mesh is used as it is where tables are requested without an edge.
[[nodiscard]] std::optional<double> touch_edge(const BodyDescription& description,
                                               const SurfaceMesh& skin);

/// The body on a mesh with this edge, in the same position, with one site and no responses between
/// sites.
/// @param skin  of the body, body frame
/// @throws Error as pose_body(); a coarser mesh has no sets
[[nodiscard]] BodyProblem pose_coarser(const BodyDescription& description, const SurfaceMesh& skin,
                                       double edge);

/// The problem on which tables of touch are made: the body on its own mesh, or on the coarser one.
/// @throws Error as pose_body()
[[nodiscard]] BodyProblem pose_for_touch(const BodyDescription& description);

}  // namespace palpable
