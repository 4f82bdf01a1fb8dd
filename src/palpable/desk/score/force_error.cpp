#include "palpable/desk/score/force_error.h"

namespace palpable {

double force_error(const Eigen::Vector3d& truth, std::span<const Eigen::Vector3d> felt) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& force : felt) sum += force;
  const double off = (sum - truth).norm();
  return off == 0 ? 0 : off / truth.norm();
}

}  // namespace palpable
