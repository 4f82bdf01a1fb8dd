#include "palpable/desk/score/placement_error.h"

#include "palpable/common/base/contract.h"

namespace palpable {

double placement_error(const Eigen::Matrix3Xd& rest, const Rigid3& truth, const Rigid3& drawn) {
  PALPABLE_EXPECT(rest.cols() > 0, "a body has vertices");
  const Eigen::Matrix3d turned = drawn.linear() - truth.linear();
  const Eigen::Vector3d shifted = drawn.translation() - truth.translation();
  return ((turned * rest).colwise() + shifted).colwise().norm().maxCoeff();
}

}  // namespace palpable
