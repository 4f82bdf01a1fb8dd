#include "palpable/bake/solid/stress_together.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/shape_gradients.h"
#include "palpable/common/material/law.h"
#include "palpable/common/material/simd.h"
#include "palpable/common/material/tensor.h"

#include <cstring>
#include <utility>
#include <variant>

namespace palpable {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

struct Stress {
  // sigma = P F^T / J of one element in eight states.
  // @param values  (3N x 8) row by row   @param sigma  (6 x 8) row by row
  // @returns whether every J > 0
  template <class Law>
  PALPABLE_ALWAYS_INLINE static bool run(const Law& law, const double* g, const int* nodes,
                                         const double* values, double* sigma) {
    Tensor<Pack> F;
    for (int i = 0; i < 3; ++i) {
      Pack u[4];
      for (int a = 0; a < 4; ++a) {
        std::memcpy(&u[a], values + Index{kPackSize} * (3 * Index{nodes[a]} + i), sizeof(Pack));
      }
      for (int J = 0; J < 3; ++J) {
        F(i, J) = u[0] * g[J] + u[1] * g[3 + J] + u[2] * g[6 + J] + u[3] * g[9 + J];
      }
      F(i, i) += 1.0;
    }
    const Deformation<Pack> d = deformation(F);
    const Tensor<Pack> P = first_piola(law, d);
    constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
    for (int k = 0; k < 6; ++k) {
      const int i = kRow[k], j = kColumn[k];
      const Pack value = (P(i, 0) * F(j, 0) + P(i, 1) * F(j, 1) + P(i, 2) * F(j, 2)) / d.J;
      std::memcpy(sigma + kPackSize * k, &value, sizeof(Pack));
    }
    bool all = true;
    for (int lane = 0; lane < kPackSize; ++lane) all = all && d.J[lane] > 0.0;
    return all;
  }
};

}  // namespace

StressTogether::StressTogether(const SolidModel& model, std::vector<int> nodes)
    : model_(model),
      nodes_(std::move(nodes)),
      recovery_(model.mesh),
      group_of_(material_groups(model)) {
  PALPABLE_EXPECT(!model.mesh.is_quadratic(), "4-node tetrahedra");
}

MatrixXd StressTogether::operator()(const MatrixXd& u) const {
  const TetMesh& mesh = model_.mesh;
  PALPABLE_EXPECT(u.rows() == 3 * Index{mesh.node_count()} && u.cols() == kStates,
                  "eight displacements of all nodes");
  static_assert(kStates == kPackSize);
  const SimdLevel simd = best_simd_level();
  const MatrixXd by_state = u.transpose();
  MatrixXd at_points(6 * kStates, mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const ShapeGradients shape = shape_gradients(mesh, e);
    const int group = group_of_[e];
    const Material& material = group < 0 ? model_.material : model_.groups[group].material;
    const double* const g = shape.g.data();
    const int* const corners = &mesh.tets(0, e);
    const double* const values = by_state.data();
    double* const sigma = &at_points(0, e);
    const bool upright = std::visit(
        [&](const auto& law) { return run_at<Stress>(simd, law, g, corners, values, sigma); },
        material);
    if (!upright) throw Error("an element is inverted by the displacement: use a smaller load");
  }
  const MatrixXd nodal = recovery_.apply_at(nodes_, at_points);
  MatrixXd stress(6 * nodal.cols(), kStates);
  for (Index n = 0; n < nodal.cols(); ++n) {
    stress.middleRows<6>(6 * n) = nodal.col(n).reshaped(Index{kStates}, 6).transpose();
  }
  return stress;
}

}  // namespace palpable
