#include "palpable/live/session/modal_bodies.h"

#include <cstddef>

namespace palpable {
namespace {

std::vector<ModalMember> bodies_of(const std::vector<ModalBodies::Member>& members) {
  std::vector<ModalMember> bodies;
  for (const ModalBodies::Member& member : members) bodies.push_back(member.body);
  return bodies;
}

}  // namespace

ModalBodies::ModalBodies(const std::vector<Member>& members)
    : members_(members), contact_(bodies_of(members)), states_(members.size()) {
  for (const Member& member : members_) {
    seen_.push_back(member.seen);
    RestShape& rest = rest_.emplace_back(*member.body.body);
    skins_.push_back(rest.vertices);
    patches_.emplace_back(2 * ModalContact::kMostPoints);
    pressures_.emplace_back(member.body.body->surface);
    const int k = static_cast<int>(rest_.size()) - 1;
    contact_.normals(k, {}, rest.normals);
    contact_.stress(k, {}, rest.von_mises, rest.cauchy);
  }
}

void ModalBodies::advance() {
  report_ = contact_.advance(states_, seen_);
  for (std::size_t k = 0; k < members_.size(); ++k) {
    skins_[k] = contact_.place(static_cast<int>(k), states_[k]);
  }
}

void ModalBodies::find_touches(int member, std::vector<Touch>& touches) {
  const auto k = static_cast<std::size_t>(member);
  const SurfaceMesh& rest = members_[k].body.body->surface;
  std::vector<PressedPoint>& points = patches_[k].points();
  points.clear();
  for (const SkinForce& force : states_[k].forces) {
    const Eigen::Vector3f now = force.at.at(skins_[k]);
    Eigen::Vector3f before = Eigen::Vector3f::Zero();
    for (int c = 0; c < 3; ++c) {
      const int v = force.at.corners[static_cast<std::size_t>(c)];
      before += force.at.weights[c] * rest.vertices.col(v).cast<float>();
    }
    const int by = force.by < 0 ? -1 : members_[static_cast<std::size_t>(force.by)].number;
    points.push_back({now, now - before, force.force, force.at.area, by});
  }
  patches_[k].find(members_[k].seen, touches);
}

void ModalBodies::reconstruct(int member, const SceneExtras& extras, SceneBody& shown) {
  const auto k = static_cast<std::size_t>(member);
  shown.stated_error.reset();
  if (states_[k].q.isZero(0)) {  // what stands about costs a copy
    rest_[k].show(extras, shown);
    if (extras.contact_pressure) shown.contact_pressure.resize(rest_[k].von_mises.size(), 0.0f);
    return;
  }
  rest_[k].make_room(extras, shown);
  shown.vertices = skins_[k];
  contact_.normals(member, states_[k], shown.normals);
  contact_.stress(member, states_[k], shown.von_mises, shown.cauchy);
  if (extras.contact_pressure) {
    pressures_[k].spread(patches_[k], shown.vertices, shown.normals, shown.contact_pressure);
  }
}

}  // namespace palpable
