#include "palpable/bake/solid/implicit_dynamics.h"

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

// The constants of the method, from rho_inf.
struct AlphaMethod {
  double am, af, gamma, beta;

  explicit AlphaMethod(double rho)
      : am((2 * rho - 1) / (rho + 1)),
        af(rho / (rho + 1)),
        gamma(0.5 - am + af),
        beta(0.25 * (1 - am + af) * (1 - am + af)) {}
};

SolidModel checked_copy(const SolidModel& model) {
  check_model(model);
  return model;
}

// The rows and columns of M at free nodes.
SparseMatrix at_free_nodes(const SparseMatrix& M, const std::vector<int>& free_nodes) {
  std::vector<int> free_of_node(static_cast<std::size_t>(M.rows()), -1);
  for (std::size_t k = 0; k < free_nodes.size(); ++k) {
    free_of_node[static_cast<std::size_t>(free_nodes[k])] = static_cast<int>(k);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index c = 0; c < M.outerSize(); ++c) {
    for (SparseMatrix::InnerIterator m(M, c); m; ++m) {
      const int row = free_of_node[static_cast<std::size_t>(m.row())];
      const int column = free_of_node[static_cast<std::size_t>(m.col())];
      if (row >= 0 && column >= 0) entries.emplace_back(row, column, m.value());
    }
  }
  const auto count = static_cast<Index>(free_nodes.size());
  SparseMatrix free(count, count);
  free.setFromTriplets(entries.begin(), entries.end());
  return free;
}

}  // namespace

// Vectors are those of the free nodes (3F), with zeros in held directions, as TetAssembly has them.
struct ImplicitDynamics::Core {
  SolidModel model;
  DynamicsSettings settings;
  AlphaMethod method;
  TetAssembly assembly;
  VectorXd mask;   // 1 where free
  SparseMatrix M;  // (F x F) kg
  BlockMatrix K_rest;
  MatrixXd M_shapes;        // (3F x m) M Phi
  VectorXd modal_damping;   // (m) 2 zeta omega_i (1 - omega_i / omega_m), rad/s
  double of_stiffness = 0;  // s: 2 zeta / omega_m
  double of_M, of_C, of_K;  // their factors in the effective stiffness, 1/s^2, 1/s, 1
  FactorWorkspace workspace;
  std::optional<CholeskyFactor> factor;  // of the effective stiffness at rest
  VectorXd preload;
  Matrix3Xd rest;

  // The state.
  double time = 0;
  Matrix3Xd u;
  VectorXd v, a, f;              // f: internal forces at u
  std::optional<VectorXd> load;  // that `a` belongs to, with the preload
  DynamicEnergy energy;
  double largest_force = 0;  // N
  int newton_steps = 0, cg_iterations = 0;

  // Scratch memory.
  PassFields fields;
  CgScratch cg_scratch;
  Matrix3Xd force;

  Core(const SolidModel& the_model, double density, const ModalDamping& damping,
       const DynamicsSettings& the_settings, const Preloaded* preloaded)
      : model(checked_copy(the_model)),
        settings(the_settings),
        method(settings.rho_inf),
        assembly(model),
        M(at_free_nodes(consistent_mass(model.mesh, density), assembly.free_nodes())),
        K_rest(assembly.pattern()),
        rest(preloaded != nullptr ? preloaded->rest : Matrix3Xd::Zero(3, model.mesh.node_count())),
        force(3, model.mesh.node_count()) {
    if (assembly.free_nodes().empty()) {
      throw Error("every node of the body is fixed: nothing can move; fix fewer nodes");
    }
    const double h = settings.time_step;
    of_M = (1 - method.am) / (method.beta * h * h);
    of_C = (1 - method.af) * method.gamma / (method.beta * h);
    of_K = 1 - method.af;
    assembly.gather(Matrix3Xd::Ones(3, model.mesh.node_count()), mask);
    preload = VectorXd::Zero(mask.size());
    if (preloaded != nullptr) assembly.gather(preloaded->force, preload);
    assembly.set_state(rest, fields);
    assembly.tangent(fields, K_rest);
    set_damping(damping);
    factorise();
  }

  void set_damping(const ModalDamping& damping) {
    const Index m = damping.omega.size();
    PALPABLE_EXPECT(damping.ratio >= 0 && (damping.ratio == 0 || m > 0),
                    "a damping ratio needs modes");
    PALPABLE_EXPECT(
        damping.shapes.cols() == m && (m == 0 || damping.shapes.rows() == model.mesh.nodes.size()),
        "a shape has three values a node");
    if (damping.ratio == 0) return;
    const double last = damping.omega[m - 1];
    of_stiffness = 2 * damping.ratio / last;
    modal_damping = 2 * damping.ratio * damping.omega.array() * (1 - damping.omega.array() / last);
    PALPABLE_EXPECT(damping.omega[0] > 0 && modal_damping.minCoeff() >= 0, "frequencies that rise");
    M_shapes.resize(mask.size(), m);
    VectorXd shape;
    for (Index k = 0; k < m; ++k) {
      assembly.gather(
          Eigen::Map<const Matrix3Xd>(damping.shapes.col(k).data(), 3, model.mesh.node_count()),
          shape);
      M_shapes.col(k) = mass_times(shape);
    }
  }

  // Without the modes' part of C, which is small where a period has many steps and of low rank:
  // conjugate gradients find it in a few iterations.
  void factorise() {
    BlockMatrix S = K_rest;
    const BlockPattern& pattern = assembly.pattern();
    const double share = of_K + of_C * of_stiffness;
    for (int row = 0; row < pattern.rows(); ++row) {
      for (int p = pattern.row_start[row]; p < pattern.row_start[row + 1]; ++p) {
        const int column = pattern.column[p];
        S.block(p) *= share;
        const double mass = of_M * M.coeff(row, column);
        for (int i = 0; i < 3; ++i) {
          S.block(p)(i, i) += mass * mask[3 * row + i] * mask[3 * column + i];
        }
      }
    }
    const CholeskyAnalysis analysis(pattern, workspace);
    factor = CholeskyFactor::make(analysis, S, FactorPrecision::k32Bits, workspace);
    if (!factor) throw Error("the body buckles in its rest: its stiffness has negative values");
  }

  [[nodiscard]] VectorXd mass_times(const VectorXd& x) const {
    VectorXd y(x.size());
    Eigen::Map<Matrix3Xd>(y.data(), 3, M.rows()) =
        Eigen::Map<const Matrix3Xd>(x.data(), 3, M.rows()) * M;
    return y.cwiseProduct(mask);
  }

  [[nodiscard]] VectorXd damping_times(const VectorXd& x) const {
    if (of_stiffness == 0) return VectorXd::Zero(x.size());
    VectorXd y;
    K_rest.multiply(x, y);
    y = of_stiffness * y.cwiseProduct(mask);
    y += M_shapes * modal_damping.cwiseProduct(M_shapes.transpose() * x);
    return y;
  }

  // Internal forces at the displacement x, and the energy; infinite if an element is inverted.
  double internal_force(const Matrix3Xd& x, VectorXd& free) {
    assembly.set_state(x, fields);
    const BodyState state = assembly.force(fields, force);
    if (std::isfinite(state.energy)) assembly.gather(force, free);
    return state.energy;
  }

  // x = S^-1 b, with the effective stiffness S at the displacement `at`.
  VectorXd solve(const Matrix3Xd& at, const VectorXd& b, double relative_tolerance) {
    assembly.set_state(at, fields);
    const CgSystem system{
        .K =
            [&](const VectorXd& x, VectorXd& y) {
              assembly.tangent_product(fields, x, y);
              y = of_K * y + of_M * mass_times(x);
              if (of_stiffness > 0) y += of_C * damping_times(x);
            },
        .preconditioner = [&](const VectorXd& r,
                              VectorXd& x) { factor->solve_roughly(r, x, workspace); }};
    VectorXd x;
    const CgResult cg = conjugate_gradients(system, b, relative_tolerance,
                                            settings.max_cg_iterations, x, cg_scratch);
    cg_iterations += cg.iterations;
    if (cg.end != CgEnd::kConverged) {
      throw trouble(cg.end == CgEnd::kNegativeCurvature ? "the effective stiffness is not positive"
                                                        : "conjugate gradients did not converge");
    }
    return x;
  }

  [[nodiscard]] Error trouble(const char* what) const {
    return Error(fmt::format("{} at {:.4g} s, with a time step of {:.3g} s: try a smaller one",
                             what, time, settings.time_step));
  }

  // How much a jumps where the forces jump by df. M^-1 df would throw motion that the steps cannot
  // follow, from which they then gain energy; S^-1 makes little of it, and is the same up to h^2
  // where the steps follow.
  void jump(const VectorXd& df) {
    if (df.norm() <= settings.tolerance * largest_force) return;
    a += of_M * solve(u, df, 1e-6);
  }

  // What a step is solved for: the end of the step as a function of du = u' - u.
  struct End {
    VectorXd du, a, v, f, residual;
    double elastic = 0, inertia = 0;  // J; N, the norm
  };

  // False if an element is inverted.
  bool evaluate(const VectorXd& total_load, End& end) {
    const auto& [am, af, gamma, beta] = method;
    const double h = settings.time_step;
    Matrix3Xd at = u;
    assembly.add_scattered(end.du, 1.0, at);
    end.elastic = internal_force(at, end.f);
    if (!std::isfinite(end.elastic)) return false;
    end.a = (end.du - h * v) / (beta * h * h) - (0.5 - beta) / beta * a;
    end.v = v + h * ((1 - gamma) * a + gamma * end.a);
    const VectorXd inertia = mass_times((1 - am) * end.a + am * a);
    end.residual =
        total_load - inertia - damping_times((1 - af) * end.v + af * v) - (1 - af) * end.f - af * f;
    end.inertia = inertia.norm();
    return true;
  }

  // One step of Newton's method, shortened where it would invert an element or raise the residual.
  void newton_step(const VectorXd& total_load, End& end) {
    Matrix3Xd at = u;
    assembly.add_scattered(end.du, 1.0, at);
    const double norm = end.residual.norm();
    const double relative = norm / largest_force;
    const double forcing =
        std::max(std::min(0.05, relative), std::min(0.5, 0.3 * settings.tolerance / relative));
    const VectorXd d = solve(at, end.residual, forcing);
    End trial;
    for (double share = 1.0; share > 1e-4; share *= 0.5) {
      trial.du = end.du + share * d;
      if (evaluate(total_load, trial) && trial.residual.norm() < norm) {
        std::swap(end, trial);
        ++newton_steps;
        return;
      }
    }
    throw trouble("Newton's method found no better state");
  }

  [[nodiscard]] bool is_solved(const End& end) const {
    return end.residual.norm() <=
           std::max(settings.tolerance * largest_force, assembly.force_noise());
  }
};

ImplicitDynamics::ImplicitDynamics(const SolidModel& model, double density,
                                   const ModalDamping& damping, const DynamicsSettings& settings,
                                   const Preloaded* preloaded) {
  PALPABLE_EXPECT(settings.time_step > 0 && std::isfinite(settings.time_step), "a time step");
  PALPABLE_EXPECT(settings.rho_inf >= 0 && settings.rho_inf <= 1, "rho_inf from 0 to 1");
  PALPABLE_EXPECT(settings.tolerance > 0, "a tolerance");
  core_ = std::make_unique<Core>(model, density, damping, settings, preloaded);
  start(core_->rest, Matrix3Xd::Zero(3, model.mesh.node_count()));
}
ImplicitDynamics::~ImplicitDynamics() = default;
ImplicitDynamics::ImplicitDynamics(ImplicitDynamics&&) noexcept = default;

void ImplicitDynamics::start(const Matrix3Xd& u, const Matrix3Xd& v) {
  Core& c = *core_;
  PALPABLE_EXPECT(u.cols() == c.model.mesh.node_count() && v.cols() == u.cols(),
                  "a displacement and a velocity for each node");
  c.time = 0;
  c.u = u;
  c.assembly.gather(v, c.v);
  c.a = VectorXd::Zero(c.v.size());
  c.load.reset();
  c.energy = {};
  c.energy.elastic = c.internal_force(u, c.f);
  if (!std::isfinite(c.energy.elastic)) throw Error("an element is inverted at the start");
  c.energy.kinetic = 0.5 * c.v.dot(c.mass_times(c.v));
  c.largest_force = std::max(c.f.norm(), c.preload.norm());
  c.newton_steps = c.cg_iterations = 0;
}

void ImplicitDynamics::step(const Matrix3Xd& load) {
  Core& c = *core_;
  PALPABLE_EXPECT(load.cols() == c.model.mesh.node_count(), "a force for each node");
  const double h = c.settings.time_step;
  VectorXd total;
  c.assembly.gather(load, total);
  total += c.preload;
  c.largest_force = std::max(c.largest_force, total.norm());
  // Before the first step `a` is 0: all that is not in balance jumps.
  c.jump(total - (c.load ? *c.load : VectorXd(c.f + c.damping_times(c.v))));
  c.load = total;

  // With this start a' = a.
  Core::End end{.du = h * c.v + 0.5 * h * h * c.a, .a = {}, .v = {}, .f = {}, .residual = {}};
  if (c.evaluate(total, end)) {
    c.largest_force = std::max({c.largest_force, end.inertia, end.f.norm()});
  } else {
    end.du.setZero();
    c.evaluate(total, end);
  }
  for (int k = 0; !c.is_solved(end); ++k) {
    if (k == c.settings.max_newton_steps) throw c.trouble("Newton's method did not converge");
    c.newton_step(total, end);
  }

  c.energy.work += total.dot(end.du);
  c.energy.dissipated += end.du.dot(c.damping_times((1 - c.method.af) * end.v + c.method.af * c.v));
  c.assembly.add_scattered(end.du, 1.0, c.u);
  c.v = end.v;
  c.a = end.a;
  c.f = end.f;
  c.energy.elastic = end.elastic;
  c.energy.kinetic = 0.5 * c.v.dot(c.mass_times(c.v));
  c.time += h;
}

double ImplicitDynamics::time() const { return core_->time; }
const Matrix3Xd& ImplicitDynamics::rest() const { return core_->rest; }
const Matrix3Xd& ImplicitDynamics::displacement() const { return core_->u; }
Matrix3Xd ImplicitDynamics::velocity() const {
  Matrix3Xd v = Matrix3Xd::Zero(3, core_->model.mesh.node_count());
  core_->assembly.add_scattered(core_->v, 1.0, v);
  return v;
}
const DynamicEnergy& ImplicitDynamics::energy() const { return core_->energy; }
int ImplicitDynamics::newton_steps() const { return core_->newton_steps; }
int ImplicitDynamics::cg_iterations() const { return core_->cg_iterations; }

}  // namespace palpable
