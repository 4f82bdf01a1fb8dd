#include "palpable/common/contact/point_forces.h"

#include <algorithm>

namespace palpable {

ForcesAtStart::ForcesAtStart(std::size_t most) : most_(most) {
  begun_.reserve(most);
  mixed_.reserve(2 * most);
}

void ForcesAtStart::start(const std::vector<PointForce>& forces) {
  begun_.assign(forces.begin(), forces.end());
}

void ForcesAtStart::limit_step(std::vector<PointForce>& forces, float share) {
  mixed_.clear();
  auto begun = begun_.begin();
  const auto add_begun = [&] {
    mixed_.push_back(
        {begun->point, (1 - share) * begun->force, begun->by, (1 - share) * begun->friction});
    ++begun;
  };
  for (const PointForce& now : forces) {
    while (begun != begun_.end() && stands_before(*begun, now)) add_begun();
    Eigen::Vector3f force = share * now.force, friction = share * now.friction;
    if (begun != begun_.end() && !stands_before(now, *begun)) {
      force += (1 - share) * begun->force;
      friction += (1 - share) * begun->friction;
      ++begun;
    }
    mixed_.push_back({now.point, force, now.by, friction});
  }
  while (begun != begun_.end()) add_begun();
  // If the step limit holds frame after frame, forces would accumulate without end.
  while (mixed_.size() > most_) {
    mixed_.erase(std::min_element(mixed_.begin(), mixed_.end(), [](const auto& a, const auto& b) {
      return a.force.squaredNorm() < b.force.squaredNorm();
    }));
  }
  forces.assign(mixed_.begin(), mixed_.end());
}

}  // namespace palpable
