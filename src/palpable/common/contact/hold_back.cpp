#include "palpable/common/contact/hold_back.h"

#include <algorithm>

namespace palpable {

using Eigen::Vector3f;

HoldBack::HoldBack(Eigen::Index nodes, Eigen::Index vertices, std::size_t most_forces)
    : vertices_(vertices), most_forces_(most_forces), began_(3, nodes) {
  forces_began_.reserve(most_forces);
  mixed_.reserve(2 * most_forces);
}

void HoldBack::start(const TouchState& state) {
  began_ = state.u;
  forces_began_.assign(state.forces.begin(), state.forces.end());
}

double HoldBack::bound(TouchState& state, double largest_move) {
  const auto moved = static_cast<double>(
      (state.u.leftCols(vertices_) - began_.leftCols(vertices_)).colwise().norm().maxCoeff());
  if (!(moved > largest_move)) return 0;
  const auto share = static_cast<float>(largest_move / moved);
  state.u = began_ + share * (state.u - began_);
  mixed_.clear();
  std::size_t k = 0;
  for (const PointForce& now : state.forces) {
    for (; k < forces_began_.size() && forces_began_[k].point < now.point; ++k) {
      mixed_.push_back(
          {forces_began_[k].point, (1 - share) * forces_began_[k].force, forces_began_[k].by});
    }
    Vector3f force = share * now.force;
    if (k < forces_began_.size() && forces_began_[k].point == now.point) {
      force += (1 - share) * forces_began_[k++].force;
    }
    mixed_.push_back({now.point, force, now.by});
  }
  for (; k < forces_began_.size(); ++k) {
    mixed_.push_back(
        {forces_began_[k].point, (1 - share) * forces_began_[k].force, forces_began_[k].by});
  }
  // Of a state that was held back itself the least forces go first.
  while (mixed_.size() > most_forces_) {
    mixed_.erase(std::min_element(mixed_.begin(), mixed_.end(), [](const auto& a, const auto& b) {
      return a.force.squaredNorm() < b.force.squaredNorm();
    }));
  }
  state.forces.assign(mixed_.begin(), mixed_.end());
  return moved - largest_move;
}

}  // namespace palpable
