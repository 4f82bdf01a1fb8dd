#include "palpable/bake/solid/equilibrium.h"

#include "palpable/bake/solid/solver_core.h"
#include "palpable/bake/solid/walk.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;
using Eigen::VectorXd;

EquilibriumSolver::EquilibriumSolver(SolidModel model, EquilibriumSettings settings)
    : core_(std::make_unique<const Core>(std::move(model), settings)) {}
EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

const SolidModel& EquilibriumSolver::model() const { return core_->model; }
const SolverSetup& EquilibriumSolver::setup() const { return core_->setup; }

PathResult EquilibriumSolver::solve_path(const Matrix3Xd& full_load, std::span<const double> levels,
                                         const PathOptions& options) const {
  core_->check_load(full_load);
  double before = 0.0;
  for (const double level : levels) {
    PALPABLE_EXPECT(level > before && std::isfinite(level), "levels are above 0 and increase");
    before = level;
  }
  const double begin = thread_cpu_seconds();
  Walk walk(*core_, full_load, options);
  PathResult path;
  path.steps.reserve(levels.size());
  path.complete = true;
  for (const double level : levels) {
    if (!walk.advance(level, core_->settings.tolerance)) {
      path.complete = false;
      path.stop = walk.failure().stop;
      path.why_stopped =
          fmt::format("load level {:.6g} was not reached, the last that was is {:.6g}: {}", level,
                      walk.now().level, walk.describe_failure());
      break;
    }
    path.steps.push_back(walk.now());
  }
  path.factors = walk.factors();
  path.halvings = walk.halvings();
  path.times = walk.times();
  path.times.total_s = thread_cpu_seconds() - begin;
  return path;
}

Matrix3Xd EquilibriumSolver::internal_force(const Matrix3Xd& u) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count(), "one displacement for each node");
  Matrix3Xd force(3, u.cols());
  PassFields fields;
  core_->assembly.set_state(u, fields);
  const BodyState state = core_->assembly.force(fields, force);
  if (!std::isfinite(state.energy)) {
    throw Error(
        fmt::format("element {} is inverted by the displacement (J = {:.3g}); it has no forces",
                    state.most_compressed, state.smallest_volume_ratio));
  }
  return force;
}

double EquilibriumSolver::stored_energy(const Matrix3Xd& u) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count(), "one displacement for each node");
  Matrix3Xd force(3, u.cols());
  PassFields fields;
  core_->assembly.set_state(u, fields);
  return core_->assembly.force(fields, force).energy;
}

Matrix3Xd EquilibriumSolver::tangent_times(const Matrix3Xd& u, const Matrix3Xd& du) const {
  PALPABLE_EXPECT(u.cols() == model().mesh.node_count() && du.cols() == u.cols(),
                  "one displacement for each node");
  VectorXd x, y;
  PassFields fields;
  core_->assembly.set_state(u, fields);
  core_->assembly.gather(du, x);
  core_->assembly.tangent_product(fields, x, y);
  Matrix3Xd result = Matrix3Xd::Zero(3, u.cols());
  core_->assembly.add_scattered(y, 1.0, result);
  return result;
}

}  // namespace palpable
