/// @file
/// The mesh that tables of touch are made on, where the body's own is too fine for them: their size
/// grows with the square of the skin's vertices. The body's skin is carried by the coarser one
/// (response/carried_skin.h).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <optional>

namespace palpable {

/// Vertices of a skin beyond which tables are made on a coarser mesh, unless the description says
/// otherwise, and about how many that one's skin has.
inline constexpr int kFineSkin = 8000, kCoarseSkin = 4000;

/// m: edges of the coarser mesh; nothing where tables are made on the body's own. A mesh that was
/// given is taken as it is where tables are asked for without an edge.
[[nodiscard]] std::optional<double> touch_edge(const BodyDescription& description,
                                               const SurfaceMesh& skin);

/// The body on a mesh with such edges, at the same place, with one site and no responses between
/// sites.
/// @param skin  of the body, body frame
/// @throws Error as pose_body(); a coarser mesh has no sets
[[nodiscard]] BodyProblem pose_coarser(const BodyDescription& description, const SurfaceMesh& skin,
                                       double edge);

/// What tables of touch are made of: the body on its own mesh, or on the coarser one.
/// @throws Error as pose_body()
[[nodiscard]] BodyProblem pose_for_touch(const BodyDescription& description);

}  // namespace palpable
