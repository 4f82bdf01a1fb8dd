#include "palpable/bake/touch_bake/full_solution.h"

#include "palpable/common/base/contract.h"

#include <array>

namespace palpable {

using Eigen::Index;
using Eigen::Matrix3Xd;

std::optional<Eigen::Matrix3Xf> full_solution(const EquilibriumSolver& solver,
                                              const SkinResponse& skin, const Preloaded* preloaded,
                                              std::span<const VertexForce> forces) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * Index{skin.vertex_count()});
  for (const VertexForce& f : forces) {
    PALPABLE_EXPECT(0 <= f.vertex && f.vertex < skin.vertex_count(), "forces act on the skin");
    load.segment<3>(3 * Index{f.vertex}) += f.force.cast<double>();
  }
  const Matrix3Xd nodal = skin.at_nodes(load).reshaped(3, skin.body().rest().cols());
  if (!nodal.allFinite() || nodal.isZero(0)) return std::nullopt;
  const PathResult path = solver.solve_path(nodal, std::array{1.0}, {.preloaded = preloaded});
  if (!path.complete) return std::nullopt;
  const Matrix3Xd moved = path.steps.back().displacement - skin.body().rest();
  return Eigen::Matrix3Xf(
      skin.in_shell(moved.reshaped()).reshaped(3, skin.shell_count()).cast<float>());
}

}  // namespace palpable
