/// @file
/// The mesh that tables of touch are made on, where the body's own is too fine for them: their size
/// grows with the square of the skin's vertices. The body's skin is carried by the coarser one.
#pragma once

#include "palpable/describe/body_description.h"
#include "palpable/geometry/surface_mesh.h"

#include <optional>

namespace palpable {

/// Vertices of a skin beyond which tables are made on a coarser mesh, unless the description says
/// otherwise, and about how many that one's skin has.
inline constexpr int kFineSkin = 8000, kCoarseSkin = 4000;

/// m: edges of the coarser mesh; nothing where tables are made on the body's own. A description
/// that states an edge decides; so does a body whose tetrahedra are given, for these cannot be made
/// coarser.
[[nodiscard]] std::optional<double> touch_edge(const BodyDescription& description,
                                               const SurfaceMesh& skin);

/// The same body with edges as long on the skin and within, without sites that were chosen by hand
/// and responses between them: pose_body() gives what tables are made of.
[[nodiscard]] BodyDescription with_edge(const BodyDescription& description, double edge);

}  // namespace palpable
