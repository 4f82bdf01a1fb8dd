#include "palpable/describe/touch_mesh.h"

#include "palpable/mesh/remesh.h"

#include <cmath>

namespace palpable {

std::optional<double> touch_edge(const BodyDescription& description, const SurfaceMesh& skin) {
  if (description.touch.edge || description.shape.is_volume()) return description.touch.edge;
  if (skin.vertex_count() <= kFineSkin) return std::nullopt;
  return mean_edge_length(skin) * std::sqrt(1.0 * skin.vertex_count() / kCoarseSkin);
}

BodyDescription with_edge(const BodyDescription& description, double edge) {
  BodyDescription coarse = description;
  coarse.shape.edge = edge;
  if (coarse.shape.inner_edge && !(*coarse.shape.inner_edge > edge)) {
    coarse.shape.inner_edge.reset();
  }
  coarse.sites = {};
  coarse.sites.count = 1;
  return coarse;
}

}  // namespace palpable
