#include "palpable/bake/pipeline/state_file.h"

#include "palpable/bake/solid/stress.h"

#include <vector>

namespace palpable {

double write_state_file(const std::filesystem::path& file, const SolidModel& model,
                        const Eigen::Matrix3Xd& displacement, const VtuField& forces) {
  const StressField stress = nodal_cauchy_stress(model, displacement);
  const Eigen::VectorXd mises = von_mises(stress);
  const std::vector<VtuField> fields{{"displacement", displacement},
                                     {"cauchy_stress", stress},
                                     {"von_mises", mises.transpose()},
                                     {"principal_stresses", principal_stresses(stress)},
                                     forces};
  write_vtu_file(file, model.mesh, fields);
  return mises.maxCoeff();
}

}  // namespace palpable
