#include "palpable/desk/score/overpress.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/touched_places.h"

#include <algorithm>

namespace palpable {
namespace {

double overpress_at(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                    const Eigen::Matrix3Xd& found, const Eigen::Vector3d& touched) {
  const Eigen::RowVectorXd away = (rest.colwise() - touched).colwise().norm();
  const double reach = std::max(kTouchedPlace, away.minCoeff());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    if (away[v] <= reach) sum += truth.col(v);
  }
  double most = 0;
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    if (away[v] > reach) continue;
    const Eigen::Vector3d off = found.col(v) - truth.col(v);
    // If the true skin does not move, a displacement in any direction is too large.
    most = std::max(most, sum.norm() > 0 ? off.dot(sum.normalized()) : off.norm());
  }
  return most;
}

}  // namespace

double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                 const Eigen::Matrix3Xd& found, std::span<const Eigen::Vector3d> touched) {
  PALPABLE_EXPECT(rest.cols() == truth.cols() && rest.cols() == found.cols() && rest.cols() > 0,
                  "both displacements are of one skin");
  PALPABLE_EXPECT(!touched.empty(), "a touch is somewhere");
  double most = 0;
  for (const Eigen::Vector3d& place : touched) {
    most = std::max(most, overpress_at(rest, truth, found, place));
  }
  return most;
}

}  // namespace palpable
