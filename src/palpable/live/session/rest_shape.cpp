#include "palpable/live/session/rest_shape.h"

#include "palpable/common/geometry/surface_mesh.h"

#include <cstddef>

namespace palpable {

RestShape::RestShape(const ReducedBody& body)
    : vertices(body.surface.vertices.cast<float>()),
      normals(3, vertices.cols()),
      von_mises(static_cast<std::size_t>(vertices.cols()), 0.0f),
      cauchy(6 * von_mises.size(), 0.0f) {
  vertex_normals(vertices, body.surface.triangles, normals);
}

void RestShape::show(const SceneExtras& extras, SceneBody& shown) const {
  shown.vertices = vertices;
  shown.normals = normals;
  shown.von_mises = von_mises;
  shown.cauchy.resize(extras.components ? cauchy.size() : 0);
  if (extras.components) shown.cauchy = cauchy;
  shown.contact_pressure.clear();
}

void RestShape::make_room(const SceneExtras& extras, SceneBody& shown) const {
  shown.vertices.resize(3, vertices.cols());
  shown.normals.resize(3, vertices.cols());
  shown.von_mises.resize(von_mises.size());
  shown.cauchy.resize(extras.components ? cauchy.size() : 0);
  shown.contact_pressure.clear();
}

}  // namespace palpable
