#include "palpable/bake/solid/implicit_dynamics.h"

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/bake/solid/contact_pairs.h"
#include "palpable/bake/solid/contact_points.h"
#include "palpable/bake/solid/sparse_cholesky.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"

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
using Eigen::Vector3d;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

namespace {

// As in contact.cpp: the first minimisation of a step with contact, and the factor after each
// update of the multipliers.
constexpr double kRoughTolerance = 1e-3, kTightened = 0.05;
constexpr int kRefreshIterations = 40;  // of conjugate gradients with contact, for a new factor
constexpr const char* kNotPositive = "the effective stiffness is not positive";

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

// What presses the body, and where.
struct ContactOfMotion {
  ObstacleMotion motion;
  DynamicContact settings;
  Boundary boundary;
  double edge, size;
  ContactPoints points;
  VectorXd penalties;  // (C) N/m
  ContactPairs pairs;
  std::optional<ObstacleGaps> gaps;  // at the end of the step

  // @param stiffness  (N) N/m, effective, of each node
  ContactOfMotion(ObstacleMotion the_motion, const DynamicContact& the_settings,
                  const TetMesh& mesh, const TetAssembly& assembly, const VectorXd& stiffness,
                  double now)
      : motion(std::move(the_motion)),
        settings(the_settings),
        boundary(boundary_of(mesh)),
        edge(mean_edge_length(boundary.surface)),
        size((mesh.nodes.rowwise().maxCoeff() - mesh.nodes.rowwise().minCoeff()).norm()),
        points(contact_points(
            mesh, boundary,
            contact_spacing(settings.spacing, boundary.surface, smallest_radius(motion(now))))),
        penalties(settings.penalty * means_at_points(points, stiffness)),
        pairs(assembly, boundary, points, penalties) {}
  ContactOfMotion(const ContactOfMotion&) = delete;
  ContactOfMotion& operator=(const ContactOfMotion&) = delete;
};

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
  CholeskyAnalysis analysis;
  std::optional<CholeskyFactor> factor;  // of effective_stiffness() and, if renewed, contact
  std::unique_ptr<ContactOfMotion> contact;
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
  PassFields fields, damping_fields;
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
        analysis(assembly.pattern(), workspace),
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

  // The effective stiffness at rest without the modes' part of C, which is small where a period has
  // many steps and of low rank: conjugate gradients find it in a few iterations.
  [[nodiscard]] BlockMatrix effective_stiffness() const {
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
    return S;
  }

  // With the stiffness of the present contact.
  void factorise() {
    BlockMatrix S = effective_stiffness();
    if (contact) contact->pairs.add_tangent(S);
    factor = CholeskyFactor::make(analysis, S, FactorPrecision::k32Bits, workspace);
    if (!factor) throw Error("the body buckles in its rest: its stiffness has negative values");
  }

  void set_obstacle(ObstacleMotion motion, const DynamicContact& settings_of_contact) {
    const VectorXd stiffness =
        node_stiffnesses(effective_stiffness(), assembly.free_nodes(), model.mesh.node_count());
    contact = std::make_unique<ContactOfMotion>(std::move(motion), settings_of_contact, model.mesh,
                                                assembly, stiffness, time);
  }

  [[nodiscard]] VectorXd mass_times(const VectorXd& x) const {
    VectorXd y(x.size());
    Eigen::Map<Matrix3Xd>(y.data(), 3, M.rows()) =
        Eigen::Map<const Matrix3Xd>(x.data(), 3, M.rows()) * M;
    return y.cwiseProduct(mask);
  }

  // The damping of a step is that of its middle, as far as it is known at its beginning: to h^2.
  // Where an element is inverted in there, that of its beginning.
  void set_damping_state() {
    if (of_stiffness == 0) return;
    Matrix3Xd at = u;
    assembly.add_scattered(v, (1 - method.af) * settings.time_step, at);
    assembly.set_state(at, damping_fields);
    if (std::isfinite(assembly.force(damping_fields, force).energy)) return;
    assembly.set_state(u, damping_fields);
  }

  [[nodiscard]] VectorXd damping_times(const VectorXd& x) {
    if (of_stiffness == 0) return VectorXd::Zero(x.size());
    VectorXd y;
    assembly.tangent_product(damping_fields, x, y);
    y *= of_stiffness;
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

  // x = S^-1 b, with the effective stiffness S at the displacement `at`, and that of the contact at
  // the last evaluation. Nothing where it is not positive.
  std::optional<VectorXd> solve(const Matrix3Xd& at, const VectorXd& b, double relative_tolerance,
                                bool with_curvature) {
    assembly.set_state(at, fields);
    const CgSystem system{
        .K =
            [&](const VectorXd& x, VectorXd& y) {
              assembly.tangent_product(fields, x, y);
              y = of_K * y + of_M * mass_times(x);
              if (of_stiffness > 0) y += of_C * damping_times(x);
              if (contact) contact->pairs.add_product(x, with_curvature, y);
            },
        .preconditioner = [&](const VectorXd& r,
                              VectorXd& x) { factor->solve_roughly(r, x, workspace); }};
    VectorXd x;
    const CgResult cg = conjugate_gradients(system, b, relative_tolerance,
                                            settings.max_cg_iterations, x, cg_scratch);
    cg_iterations += cg.iterations;
    // Pairs of contact are stiff and come and go.
    if (contact && cg.iterations > kRefreshIterations) factorise();
    if (cg.end == CgEnd::kNegativeCurvature) return std::nullopt;
    if (cg.end != CgEnd::kConverged) throw trouble("conjugate gradients did not converge");
    return x;
  }

  [[nodiscard]] Error trouble(const char* what) const {
    return Error(fmt::format("{} at {:.4g} s, with a time step of {:.3g} s: try a smaller one",
                             what, time, settings.time_step));
  }

  // Where the forces jump by df, the acceleration a jumps by of_M S^-1 df, with S the
  // effective stiffness. M^-1 df would start motion of periods below h, which the steps do not
  // resolve and from which they gain energy. Where h resolves the motion the two agree to h^2.
  void jump(const VectorXd& df) {
    if (df.norm() <= settings.tolerance * largest_force) return;
    const std::optional<VectorXd> x = solve(u, df, 1e-6, false);
    if (!x) throw trouble(kNotPositive);
    a += of_M * *x;
  }

  // A step is the minimum over du = u' - u of
  //     1/2 du . (of_M M + of_C C) du + of_K Psi(u + du) - b . du + contact
  struct Step {
    VectorXd b, inertia;  // inertia: M ((1 - am) a' + am a) at du = 0
  };
  [[nodiscard]] Step begin_step(const VectorXd& total_load) {
    const auto& [am, af, gamma, beta] = method;
    const double h = settings.time_step;
    const VectorXd a_0 = -v / (beta * h) - (0.5 - beta) / beta * a;
    const VectorXd v_0 = v + h * ((1 - gamma) * a + gamma * a_0);
    Step step{total_load, mass_times((1 - am) * a_0 + am * a)};
    step.b -= step.inertia + damping_times((1 - af) * v_0 + af * v) + af * f;
    return step;
  }

  struct End {
    VectorXd du, f, residual;
    double elastic = 0, potential = 0;  // J
    double inertia = 0;                 // N, the norm
  };

  // False if an element is inverted.
  bool evaluate(const Step& step, End& end) {
    Matrix3Xd at = u;
    assembly.add_scattered(end.du, 1.0, at);
    end.elastic = internal_force(at, end.f);
    if (!std::isfinite(end.elastic)) return false;
    const VectorXd inertia = of_M * mass_times(end.du);
    const VectorXd moved = inertia + of_C * damping_times(end.du);
    end.inertia = (inertia + step.inertia).norm();
    end.residual = step.b - moved - of_K * end.f;
    end.potential = 0.5 * end.du.dot(moved) + of_K * end.elastic - step.b.dot(end.du);
    if (contact) {
      end.potential += contact->pairs.evaluate(*contact->gaps, model.mesh.nodes + at);
      end.residual += forces_of_contact();
    }
    return true;
  }

  // Of the last evaluation.
  [[nodiscard]] VectorXd forces_of_contact() const {
    Matrix3Xd at_nodes = Matrix3Xd::Zero(3, model.mesh.node_count());
    contact->pairs.add_forces(at_nodes);
    VectorXd free;
    assembly.gather(at_nodes, free);
    return free;
  }

  // One step of Newton's method, shortened where it would invert an element or raise the potential.
  void newton_step(const Step& step, End& end) {
    Matrix3Xd at = u;
    assembly.add_scattered(end.du, 1.0, at);
    const double norm = end.residual.norm();
    const double relative = norm / largest_force;
    const double forcing =
        std::max(std::min(0.05, relative), std::min(0.5, 0.3 * settings.tolerance / relative));
    std::optional<VectorXd> d = solve(at, end.residual, forcing, true);
    // Without the obstacle's curvature the step is still a descent direction.
    if (!d && contact) d = solve(at, end.residual, forcing, false);
    if (!d) throw trouble(kNotPositive);
    const double slope = end.residual.dot(*d);
    const double rounding = assembly.energy_noise() + 1e-13 * std::abs(end.potential);
    End trial;
    for (double share = 1.0; share > 1e-6; share *= 0.5) {
      trial.du = end.du + share * *d;
      if (!evaluate(step, trial)) continue;
      if (trial.potential <= end.potential - 1e-4 * share * slope + rounding ||
          trial.residual.norm() <= 0.5 * norm) {
        std::swap(end, trial);
        ++newton_steps;
        return;
      }
    }
    throw trouble("Newton's method found no better state");
  }

  void minimise(const Step& step, double tolerance, End& end) {
    for (int k = 0; !is_solved(end, tolerance); ++k) {
      if (k == settings.max_newton_steps) throw trouble("Newton's method did not converge");
      newton_step(step, end);
    }
  }

  // Solves the step with the obstacle, from `end`.
  void minimise_with_contact(const Step& step, End& end) {
    ContactPairs& pairs = contact->pairs;
    const auto positions = [&] {
      Matrix3Xd at = model.mesh.nodes + u;
      assembly.add_scattered(end.du, 1.0, at);
      return at;
    };
    double tolerance = std::max(kRoughTolerance, settings.tolerance);
    for (int update = 0; update < contact->settings.max_updates; ++update) {
      const bool is_new = pairs.find(*contact->gaps, positions(), contact->edge) > 0;
      if (is_new || update == 0) evaluate(step, end);
      minimise(step, tolerance, end);
      const double change = pairs.update_multipliers();
      const bool all_there = pairs.find(*contact->gaps, positions(), contact->edge) == 0;
      if (all_there && tolerance <= settings.tolerance &&
          change <= contact->settings.largest_entry * contact->size) {
        return;
      }
      evaluate(step, end);
      tolerance = std::max(kTightened * tolerance, settings.tolerance);
    }
    throw trouble("the forces of contact did not settle");
  }

  [[nodiscard]] bool is_solved(const End& end, double tolerance) const {
    return end.residual.norm() <= std::max(tolerance * largest_force, assembly.force_noise());
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
  if (c.contact) {
    c.contact.reset();
    c.factorise();
  }
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
  c.set_damping_state();
  VectorXd total;
  c.assembly.gather(load, total);
  total += c.preload;
  c.largest_force = std::max(c.largest_force, total.norm());
  // Before the first step `a` is 0: all that is not in balance jumps.
  c.jump(total - (c.load ? *c.load : VectorXd(c.f + c.damping_times(c.v))));
  c.load = total;

  if (c.contact) c.contact->gaps.emplace(c.contact->motion(c.time + h));
  const Core::Step step = c.begin_step(total);
  // With this start a' = a.
  Core::End end{.du = h * c.v + 0.5 * h * h * c.a, .f = {}, .residual = {}};
  if (c.evaluate(step, end)) {
    c.largest_force = std::max({c.largest_force, end.inertia, end.f.norm()});
  } else {
    end.du.setZero();
    c.evaluate(step, end);
  }
  if (c.contact) {
    c.minimise_with_contact(step, end);
    c.energy.work += c.forces_of_contact().dot(end.du);
  } else {
    c.minimise(step, c.settings.tolerance, end);
  }

  const auto& [am, af, gamma, beta] = c.method;
  const VectorXd a = (end.du - h * c.v) / (beta * h * h) - (0.5 - beta) / beta * c.a;
  const VectorXd v = c.v + h * ((1 - gamma) * c.a + gamma * a);
  c.energy.work += total.dot(end.du);
  c.energy.dissipated += end.du.dot(c.damping_times((1 - af) * v + af * c.v));
  c.assembly.add_scattered(end.du, 1.0, c.u);
  c.v = v;
  c.a = a;
  c.f = end.f;
  c.energy.elastic = end.elastic;
  c.energy.kinetic = 0.5 * c.v.dot(c.mass_times(c.v));
  c.time += h;
}

void ImplicitDynamics::set_obstacle(ObstacleMotion motion, const DynamicContact& contact) {
  core_->set_obstacle(std::move(motion), contact);
}

Vector3d ImplicitDynamics::contact_force() const {
  Vector3d sum = Vector3d::Zero();
  if (!core_->contact) return sum;
  for (const ContactPair& pair : core_->contact->pairs.pairs()) sum += pair.whole_force();
  return sum;
}

int ImplicitDynamics::touching() const {
  if (!core_->contact) return 0;
  const std::vector<ContactPair>& pairs = core_->contact->pairs.pairs();
  return static_cast<int>(std::count_if(pairs.begin(), pairs.end(),
                                        [](const ContactPair& pair) { return pair.force > 0; }));
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
