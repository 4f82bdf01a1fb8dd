#include "palpable/bake/solid/load_response.h"

#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/common/base/contract.h"

#include <algorithm>

namespace palpable {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Eigen::Map<const Matrix3Xd> as_field(const VectorXd& u) { return {u.data(), 3, u.size() / 3}; }

SolidModel checked(const SolidModel& model) {
  check_model(model);
  return model;
}

}  // namespace

struct LoadResponse::Core {
  SolidModel model;
  Matrix3Xd rest;
  TetAssembly assembly;
  mutable FactorWorkspace factor_workspace;  // used by the constructor only
  ExactFactor factor;
  VectorXd free_mask;

  Core(const SolidModel& the_model, const Preloaded* preloaded)
      : model(checked(the_model)),
        rest(preloaded != nullptr ? preloaded->rest : Matrix3Xd::Zero(3, model.mesh.node_count())),
        assembly(model),
        factor(factorise()),
        free_mask(VectorXd::Ones(3 * model.mesh.node_count())) {
    for (const HeldComponent& held : held_components(model)) free_mask[held.at] = 0.0;
  }

  [[nodiscard]] Index values() const { return free_mask.size(); }

  // The coefficient of a^order of the forces along u_0 + a u_1 + a^2 u_2.
  [[nodiscard]] VectorXd term(int order, const VectorXd& u_1, const VectorXd& u_2) const {
    PALPABLE_EXPECT(u_1.size() == values() && u_2.size() == values(),
                    "a displacement has three values a node");
    SeriesFields scratch;
    Matrix3Xd force;
    assembly.force_term(order, rest, as_field(u_1), as_field(u_2), scratch, force);
    return force.reshaped();
  }

 private:
  ExactFactor factorise() {
    BlockMatrix K(assembly.pattern());
    PassFields fields;
    assembly.set_state(rest, fields);
    assembly.tangent(fields, K);
    return {CholeskyAnalysis(assembly.pattern(), factor_workspace), K, factor_workspace};
  }
};

LoadResponse::LoadResponse(const SolidModel& model, const Preloaded* preloaded)
    : core_(std::make_unique<Core>(model, preloaded)) {}
LoadResponse::~LoadResponse() = default;
LoadResponse::LoadResponse(LoadResponse&&) noexcept = default;

const SolidModel& LoadResponse::model() const { return core_->model; }
const Matrix3Xd& LoadResponse::rest() const { return core_->rest; }
const VectorXd& LoadResponse::free_mask() const { return core_->free_mask; }

MatrixXd LoadResponse::linear(const MatrixXd& loads) const {
  PALPABLE_EXPECT(loads.rows() == core_->values(), "a load has three values a node");
  const TetAssembly& assembly = core_->assembly;
  FactorWorkspace workspace;
  MatrixXd u = MatrixXd::Zero(loads.rows(), loads.cols());
  constexpr Index kLoadsAtATime = 16;
  VectorXd free;
  Matrix3Xd field(3, assembly.node_count());
  for (Index first = 0; first < loads.cols(); first += kLoadsAtATime) {
    const Index count = std::min(kLoadsAtATime, loads.cols() - first);
    MatrixXd B(3 * static_cast<Index>(assembly.free_nodes().size()), count);
    for (Index c = 0; c < count; ++c) {
      field.reshaped() = loads.col(first + c);
      assembly.gather(field, free);
      B.col(c) = free;
    }
    core_->factor.solve(B, workspace);
    for (Index c = 0; c < count; ++c) {
      field.setZero();
      assembly.add_scattered(B.col(c), 1.0, field);
      u.col(first + c) = field.reshaped();
    }
  }
  return u;
}

VectorXd LoadResponse::second_force(const VectorXd& u_1) const { return core_->term(2, u_1, u_1); }

VectorXd LoadResponse::third_force(const VectorXd& u_1, const VectorXd& u_2) const {
  return core_->term(3, u_1, u_2);
}

// D^2 f is symmetric: D^2 f (v, w) = 1/2 (D^2 f (v + w)^2 - D^2 f v^2 - D^2 f w^2).
VectorXd LoadResponse::mixed_force(const VectorXd& v, const VectorXd& w) const {
  return second_force(v + w) - second_force(v) - second_force(w);
}

VectorXd LoadResponse::stiffness_times(const VectorXd& u) const {
  PassFields fields;
  core_->assembly.set_state(core_->rest, fields);
  Matrix3Xd force(3, core_->assembly.node_count());
  core_->assembly.force_change(fields, as_field(u), force);
  return force.reshaped();
}

}  // namespace palpable
