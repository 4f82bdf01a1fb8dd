#include "palpable/desk/score/von_mises_error.h"

#include "palpable/common/base/contract.h"

namespace palpable {

double von_mises_error(const Eigen::VectorXd& truth, const Eigen::VectorXd& found) {
  PALPABLE_EXPECT(truth.size() == found.size() && truth.size() > 0,
                  "both stresses are of one skin");
  const double worst = (found - truth).cwiseAbs().maxCoeff();
  return worst == 0 ? 0 : worst / truth.maxCoeff();
}

}  // namespace palpable
