#include "palpable/live/session/capsule_press.h"

#include "palpable/common/geometry/surface_mesh.h"

#include <cstddef>
#include <utility>

namespace palpable {

using Eigen::Vector3f;

void CapsuleGaps::set(std::span<const Capsule> capsules) {
  fields_.clear();
  boxes_.clear();
  box_.setEmpty();
  for (const Capsule& capsule : capsules) {
    fields_.emplace_back(capsule);
    boxes_.push_back(box_of(capsule).cast<float>());
    box_.extend(boxes_.back());
  }
}

bool CapsuleGaps::gap(const Vector3f& place, SurfaceGap& gap) const {
  const Eigen::Vector3d x = place.cast<double>();
  double nearest = static_cast<double>(kGapReach);
  const CapsuleField* found = nullptr;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    if (!(boxes_[k].squaredExteriorDistance(place) < kGapReach * kGapReach)) continue;
    const double distance = fields_[k].distance(x);
    if (!(distance < nearest)) continue;
    nearest = distance;
    found = &fields_[k];
  }
  if (found == nullptr) return false;
  gap.distance = static_cast<float>(nearest);
  gap.normal = found->normal(x).cast<float>();
  gap.curvature = found->curvature(x).cast<float>();
  return true;
}

bool CapsuleGaps::is_near(const Vector3f& place, float reach) const {
  if (!(box_.squaredExteriorDistance(place) < reach * reach)) return false;
  for (const Eigen::AlignedBox3f& box : boxes_) {
    if (box.squaredExteriorDistance(place) < reach * reach) return true;
  }
  return false;
}

CapsulePress::CapsulePress(std::shared_ptr<const TouchableBody> body)
    : body_(std::move(body)), contact_(body_->body.surface, body_->body.fixed, *body_->touch) {}

TouchReport CapsulePress::advance(std::span<const Capsule> capsules, SceneBody& shown,
                                  std::vector<Touch>& touches) {
  gaps_.set(capsules);
  const TouchReport report = contact_.solver().advance(
      state_, [this](const Vector3f& place, SurfaceGap& gap) { return gaps_.gap(place, gap); },
      [this](const Vector3f& place, float reach) { return gaps_.is_near(place, reach); });
  touches.clear();
  contact_.find_touches(state_, nothing_, {}, touches);

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
