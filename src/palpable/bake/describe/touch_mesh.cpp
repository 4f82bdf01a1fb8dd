#include "palpable/bake/describe/touch_mesh.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace palpable {

std::optional<double> touch_edge(const BodyDescription& description, const SurfaceMesh& skin) {
  if (description.touch.edge) return description.touch.edge;
  // A given volume mesh may have sets, which a coarser mesh would lose; where tables are requested
  // explicitly it is used as it is.
  const bool as_given = description.shape.is_volume() && !description.touch.by_default;
  if (as_given || skin.vertex_count() <= kFineSkin) return std::nullopt;
  return mean_edge_length(skin) * std::sqrt(1.0 * skin.vertex_count() / kCoarseSkin);
}

BodyProblem pose_coarser(const BodyDescription& description, const SurfaceMesh& skin, double edge) {
  BodyDescription coarse = description;
  coarse.sites = {};
  coarse.sites.count = 1;
  try {
    return pose_body(coarse, remeshed(coarse, skin, edge));
  } catch (const Error& error) {
    throw Error(fmt::format(
        "{}: tables of touch need a coarser mesh than one with {} vertices on its skin ('edge' in "
        "[touch]; {:.3g} m was tried): {}",
        description.source.string(), skin.vertex_count(), edge, error.what()));
  }
}

BodyProblem pose_for_touch(const BodyDescription& description) {
  BodyMesh own = make_body_mesh(description);
  const SurfaceMesh& skin = own.boundary.surface;
  const std::optional<double> edge = touch_edge(description, skin);
  return edge ? pose_coarser(description, skin, *edge) : pose_body(description, std::move(own));
}

}  // namespace palpable
