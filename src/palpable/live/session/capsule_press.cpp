#include "palpable/live/session/capsule_press.h"

#include "palpable/common/geometry/surface_mesh.h"

#include <utility>

namespace palpable {

CapsulePress::CapsulePress(std::shared_ptr<const TouchableBody> body)
    : body_(std::move(body)), contact_(body_->body.surface, body_->body.fixed, *body_->touch) {}

TouchReport CapsulePress::advance(std::span<const Capsule> capsules, SceneBody& shown,
                                  std::vector<Touch>& touches) {
  obstacles_.set(capsules);
  const TouchReport report = contact_.solver().advance(state_, obstacles_);
  touches.clear();
  contact_.find_touches(state_, nullptr, {}, touches);

  const SurfaceMesh& skin = body_->body.surface;
  shown.vertices.resize(3, skin.vertex_count());
  shown.normals.resize(3, skin.vertex_count());
  shown.von_mises.resize(static_cast<std::size_t>(skin.vertex_count()));
  contact_.place(state_, shown.vertices);
  vertex_normals(shown.vertices, skin.triangles, shown.normals);
  shown.cauchy.resize(extras_.components ? 6 * shown.von_mises.size() : 0);
  contact_.stress(state_, shown.von_mises, shown.cauchy);
  shown.contact_pressure.clear();
  if (extras_.contact_pressure) {
    contact_.find_pressure(shown.vertices, shown.normals, shown.contact_pressure);
  }
  shown.stated_error = report.stated;
  return report;
}

}  // namespace palpable
