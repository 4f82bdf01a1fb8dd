#include "palpable/describe/touch_mesh.h"

#include "palpable/base/error.h"
#include "palpable/mesh/remesh.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace palpable {

std::optional<double> touch_edge(const BodyDescription& description, const SurfaceMesh& skin) {
  if (description.touch.edge) return description.touch.edge;
  if (skin.vertex_count() <= kFineSkin) return std::nullopt;
  return mean_edge_length(skin) * std::sqrt(1.0 * skin.vertex_count() / kCoarseSkin);
}

BodyProblem pose_coarser(const BodyDescription& description, const SurfaceMesh& skin, double edge) {
  BodyDescription coarse = description;
  coarse.sites = {};
  coarse.sites.count = 1;
  try {
    return pose_body(coarse, remeshed(coarse, skin, edge));
  } catch (const Error& error) {
    throw Error(
        fmt::format("tables of touch need a coarser mesh than one with {} vertices on its skin: {}",
                    skin.vertex_count(), error.what()));
  }
}

BodyProblem pose_for_touch(const BodyDescription& description) {
  BodyProblem own = pose_body(description);
  const SurfaceMesh& skin = own.mesh.boundary.surface;
  const std::optional<double> edge = touch_edge(description, skin);
  return edge ? pose_coarser(description, skin, *edge) : std::move(own);
}

}  // namespace palpable
