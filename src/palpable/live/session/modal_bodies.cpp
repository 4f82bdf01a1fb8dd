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
    const SurfaceMesh& rest = member.body.body->surface;
    skins_.push_back(rest.vertices.cast<float>());
    rest_normals_.emplace_back(3, skins_.back().cols());
    rest_stress_.emplace_back(static_cast<std::size_t>(skins_.back().cols()));
    rest_cauchy_.emplace_back(6 * rest_stress_.back().size());
    patches_.emplace_back(2 * ModalContact::kMostPoints);
    pressures_.emplace_back(rest);
    const int k = static_cast<int>(rest_stress_.size()) - 1;
    contact_.normals(k, {}, rest_normals_.back());
    contact_.stress(k, {}, rest_stress_.back(), rest_cauchy_.back());
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
  shown.vertices = skins_[k];
  shown.cauchy.resize(extras.components ? rest_cauchy_[k].size() : 0);
  shown.contact_pressure.clear();
  if (states_[k].q.isZero(0)) {  // what stands about costs a copy
    shown.normals = rest_normals_[k];
    shown.von_mises = rest_stress_[k];
    if (extras.components) shown.cauchy = rest_cauchy_[k];
    if (extras.contact_pressure) shown.contact_pressure.resize(rest_stress_[k].size(), 0.0f);
    return;
  }
  shown.normals.resize(3, skins_[k].cols());
  shown.von_mises.resize(static_cast<std::size_t>(skins_[k].cols()));
  contact_.normals(member, states_[k], shown.normals);
  contact_.stress(member, states_[k], shown.von_mises, shown.cauchy);
  if (extras.contact_pressure) {
    pressures_[k].spread(patches_[k], shown.vertices, shown.normals, shown.contact_pressure);
  }
}

}  // namespace palpable
