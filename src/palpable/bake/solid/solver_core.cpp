#include "palpable/bake/solid/solver_core.h"

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

namespace {

// Iterations of conjugate gradients on K, preconditioned by the factor of K itself, for a force of
// (1, 1, 1) at every node. That bends slender bodies, for which rounding of the factor matters
// most. An exact factor needs one or two iterations.
int iterations_with_own_factor(const BlockMatrix& K, const CholeskyFactor& factor,
                               FactorWorkspace& workspace) {
  constexpr double kDigits = 1e-4;
  constexpr int kMost = 20;
  const CgSystem system{
      .K = [&](const VectorXd& x, VectorXd& y) { K.multiply(x, y); },
      .preconditioner = [&](const VectorXd& b,
                            VectorXd& x) { factor.solve_roughly(b, x, workspace); }};
  CgScratch scratch;
  VectorXd x;
  const CgResult cg = conjugate_gradients(system, VectorXd::Ones(3 * K.pattern().rows()), kDigits,
                                          kMost, x, scratch);
  return cg.end == CgEnd::kConverged ? cg.iterations : kMost + 1;
}

RestFactor rest_factor(const TetAssembly& assembly, const CholeskyAnalysis& analysis,
                       FactorWorkspace& workspace, SolverSetup& setup) {
  // Largest number of iterations with which 16 bits are kept: compact bodies take a few, slender
  // ones many.
  constexpr int kGoodEnough = 6;
  BlockMatrix K(assembly.pattern());
  {
    const CpuTimer timer(setup.tangent_s);
    PassFields fields;
    assembly.set_state(Matrix3Xd::Zero(3, assembly.node_count()), fields);
    assembly.tangent(fields, K);
  }
  const CpuTimer timer(setup.factor_s);
  setup.factor_flops = analysis.factor_flops();
  for (const FactorPrecision precision : {FactorPrecision::k16Bits, FactorPrecision::k32Bits}) {
    std::optional<CholeskyFactor> factor = CholeskyFactor::make(analysis, K, precision, workspace);
    if (!factor) break;
    if (precision == FactorPrecision::k16Bits &&
        iterations_with_own_factor(K, *factor, workspace) > kGoodEnough) {
      continue;
    }
    setup.factor_bytes = static_cast<double>(factor->bytes());
    return {precision, *std::move(factor)};
  }
  throw Error(
      "the undeformed body can move without resistance: its stiffness is singular although "
      "enough nodes are fixed; parts that hang together by a single node or edge do that, so "
      "mesh the body anew or fix nodes of each part");
}

// Returns make(), and adds its CPU time to `seconds`.
template <class Make>
auto timed(double& seconds, const Make& make) {
  const CpuTimer timer(seconds);
  return make();
}

SolidModel checked_model(SolidModel model) {
  check_model(model);
  if (static_cast<Eigen::Index>(held_components(model).size()) == model.mesh.nodes.size()) {
    throw Error("every node of the body is fixed: nothing is left to solve; fix fewer nodes");
  }
  return model;
}

}  // namespace

EquilibriumSolver::Core::Core(SolidModel the_model, EquilibriumSettings the_settings)
    : model(checked_model(std::move(the_model))),
      settings(the_settings),
      held(held_components(model)),
      assembly(timed(setup.pattern_s, [&] { return TetAssembly(model); })),
      analysis(
          timed(setup.ordering_s, [&] { return CholeskyAnalysis(assembly.pattern(), workspace); })),
      at_rest(rest_factor(assembly, analysis, workspace, setup)) {
  setup.element_bytes = static_cast<double>(assembly.bytes());
}

bool EquilibriumSolver::Core::moves_supports() const {
  return std::any_of(held.begin(), held.end(),
                     [](const HeldComponent& h) { return h.displacement != 0.0; });
}

void EquilibriumSolver::Core::check_load(const Matrix3Xd& load) const {
  PALPABLE_EXPECT(load.cols() == model.mesh.node_count(), "one force for each node of the body");
  if (!load.allFinite()) throw Error("a nodal force is not finite");
  VectorXd at_free_nodes;
  assembly.gather(load, at_free_nodes);
  if (at_free_nodes.squaredNorm() > 0.0) return;
  if (load.squaredNorm() > 0.0) {
    throw Error(
        "the load acts on fixed nodes only, so nothing would move; put it on nodes that are "
        "free (and in directions that are), or fix fewer");
  }
  if (!moves_supports()) throw Error("the load is zero; give a force");
}

}  // namespace palpable
