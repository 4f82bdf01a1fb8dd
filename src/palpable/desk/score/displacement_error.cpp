#include "palpable/desk/score/displacement_error.h"

#include "palpable/common/base/contract.h"

#include <cmath>

namespace palpable {

DisplacementError displacement_error(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& found,
                                     const Eigen::VectorXd& areas) {
  PALPABLE_EXPECT(truth.cols() == found.cols() && truth.cols() == areas.size() && areas.size() > 0,
                  "both displacements and the areas are of one skin");
  const Eigen::Matrix3Xd off = found - truth;
  const double wrong = off.colwise().squaredNorm().dot(areas);
  const double whole = truth.colwise().squaredNorm().dot(areas);
  DisplacementError error;
  if (wrong > 0) error.relative = std::sqrt(wrong / whole);
  error.worst = off.colwise().norm().maxCoeff();
  return error;
}

}  // namespace palpable
