#include "palpable/bake/solid/contact.h"

#include "palpable/bake/solid/conjugate_gradients.h"
#include "palpable/bake/solid/contact_pairs.h"
#include "palpable/bake/solid/displacement_range.h"
#include "palpable/bake/solid/mutual_pairs.h"
#include "palpable/bake/solid/quasi_newton.h"
#include "palpable/bake/solid/solver_core.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

// Relative tolerance of the residual in the first minimisation. While the multipliers are wrong, a
// more exact minimum would only cost Newton steps.
constexpr double kFirstTolerance = 1e-2;
constexpr double kTighter = 0.05;  // factor on that tolerance after each update of the multipliers
// Factor on ContactSettings::max_updates with friction: where several points of a triangle share a
// force, their shares converge slowly.
constexpr int kUpdatesWithFriction = 4;
// Updates of the multipliers in predict(), and Newton steps in each: it needs no exact equilibrium,
// because it only says where points are touched.
constexpr int kPredictionUpdates = 2, kPredictionSteps = 6;
// Spacing of the grid on which penetration between contact points is measured, ratio to their own.
constexpr double kFinerGrid = 0.25;
// Factor on ContactSettings::largest_entry between bodies with friction. Contact points of both
// skins lie side by side and share a force; where the rim of a contact sticks, their shares
// converge slowly. The usual bound was not reached in 30 updates.
constexpr double kRubbing = 5.0;
// Factors on ContactSettings::tolerance and ContactSettings::largest_entry for states with friction
// that are only passed.
constexpr double kPassingTolerance = 1e3, kPassingEntry = 10.0;
// Largest MutualPairs::Detection::shift at which the pairs between bodies count as converged.
constexpr double kSettled = 1e-4;

// (N) N/m, of each node at rest.
VectorXd stiffness_at_rest(const TetAssembly& assembly) {
  BlockMatrix K(assembly.pattern());
  PassFields fields;
  assembly.set_state(Matrix3Xd::Zero(3, assembly.node_count()), fields);
  assembly.tangent(fields, K);
  return node_stiffnesses(K, assembly.free_nodes(), assembly.node_count());
}

// The tangent with additional blocks between nodes of different components, which the pattern of
// the bodies alone lacks, and the analysis that its factors need.
struct WideTangent {
  BlockPattern pattern;
  BlockMatrix K{pattern};
  CholeskyAnalysis analysis;

  WideTangent(BlockPattern the_pattern, FactorWorkspace& workspace)
      : pattern(std::move(the_pattern)), analysis(pattern, workspace) {}

  // Copies the blocks of the bodies' own tangent; all other blocks become zero.
  void set(const BlockMatrix& own) {
    K.set_zero();
    for (int row = 0; row < own.pattern().rows(); ++row) {
      for (int p = own.pattern().row_start[row]; p < own.pattern().row_start[row + 1]; ++p) {
        K.block(pattern.find(row, own.pattern().column[p])) = own.block(p);
      }
    }
  }
};

}  // namespace

struct ContactWalk::Work {
  const EquilibriumSolver::Core& core;
  const TetAssembly& assembly;
  ContactSettings settings;
  const Preloaded* preloaded;
  ObstacleMotion motion;
  Boundary boundary;
  double edge, size, spacing;
  ContactPoints points;
  VectorXd stiffnesses;  // (N) N/m, of the nodes
  VectorXd penalties;    // (C) N/m
  ContactPairs pairs;
  std::optional<MutualPairs> mutual;

  FactorWorkspace workspace;
  std::optional<BlockMatrix> K;
  std::unique_ptr<WideTangent> wide;  // K points to its pattern, so it stays where it is
  std::optional<CholeskyFactor> own_factor;
  const CholeskyFactor* factor;
  bool factor_is_slow = false;
  QuasiNewton corrections;
  CgScratch scratch;
  PassFields fields;
  Matrix3Xd force, total, positions;
  VectorXd r, d, free_preload;
  double scale = 0.0;
  double held_norm = 0.0;

  bool checked_begin = false;
  bool is_rough = false;     // `now` was only passed
  ContactState now, before;  // before: the previous state, for the extrapolation
  Stop stop = Stop::kNone;
  std::string why;
  int factors = 0, updates = 0, newton_steps = 0, cg_iterations = 0;

  Work(const EquilibriumSolver& solver, ObstacleMotion the_motion, double begin,
       const ContactSettings& the_settings, const Preloaded* the_preload)
      : core(solver.core()),
        assembly(core.assembly),
        settings(the_settings),
        preloaded(the_preload),
        motion(std::move(the_motion)),
        boundary(boundary_of(core.model.mesh)),
        edge(mean_edge_length(boundary.surface)),
        size((core.model.mesh.nodes.rowwise().maxCoeff() -
              core.model.mesh.nodes.rowwise().minCoeff())
                 .norm()),
        spacing(
            contact_spacing(settings.spacing, boundary.surface, smallest_radius(motion(begin)))),
        points(contact_points(core.model.mesh, boundary, spacing)),
        stiffnesses(stiffness_at_rest(assembly)),
        penalties(settings.penalty * means_at_points(points, stiffnesses)),
        pairs(assembly, boundary, points, penalties,
              {settings.friction, settings.sticking_penalty / settings.penalty}),
        factor(&core.at_rest.factor),
        force(3, assembly.node_count()) {
    now.t = begin;
    now.displacement = preloaded != nullptr ? preloaded->rest
                                            : Matrix3Xd(Matrix3Xd::Zero(3, assembly.node_count()));
    if (preloaded != nullptr) {
      assembly.gather(preloaded->force, free_preload);
    } else {
      free_preload = VectorXd::Zero(3 * static_cast<Eigen::Index>(assembly.free_nodes().size()));
    }
    if (settings.mutual) {
      mutual.emplace(
          assembly, core.model.mesh, boundary, points, settings.mutual_penalty * stiffnesses, edge,
          Friction{settings.mutual_friction, settings.sticking_penalty / settings.mutual_penalty});
      now.mutual_force.setZero(3, mutual->component_count());
    }
    before = now;
  }

  // Whether there is friction with the obstacle, and between components.
  [[nodiscard]] bool with_obstacle() const { return settings.friction > 0.0; }
  [[nodiscard]] bool between_bodies() const { return mutual && settings.mutual_friction > 0.0; }
  [[nodiscard]] bool rubs() const { return with_obstacle() || between_bodies(); }

  // Returns the Lagrangian at u, J, and writes the residual to r. Infinite if an element is
  // inverted.
  double evaluate(const ObstacleGaps& gaps, const Matrix3Xd& u, BodyState& state,
                  bool glued = false) {
    assembly.set_state(u, fields);
    state = assembly.force(fields, force);
    if (!std::isfinite(state.energy)) return state.energy;
    positions = core.model.mesh.nodes + u;
    double contact = pairs.evaluate(gaps, positions, glued);
    if (mutual) contact += mutual->evaluate(positions, glued);
    total = -force;
    pairs.add_forces(total);
    if (mutual) mutual->add_forces(total);
    assembly.gather(total, r);
    VectorXd inside;
    assembly.gather(force, inside);
    const double held = std::max(0.0, force.squaredNorm() - inside.squaredNorm());
    r += free_preload;
    double sum = free_preload.squaredNorm() + held;
    for (const ContactPair& pair : pairs.pairs()) sum += pair.whole_force().squaredNorm();
    if (mutual) {
      for (const MutualPair& pair : mutual->pairs()) sum += 2.0 * pair.force * pair.force;
      if (between_bodies()) {
        for (const MutualPair& pair : mutual->pairs()) {
          sum += 2.0 * pair.friction.force.squaredNorm();
        }
      }
    }
    scale = std::sqrt(sum);
    const double preload =
        preloaded != nullptr ? preloaded->force.cwiseProduct(u - preloaded->rest).sum() : 0.0;
    return state.energy + contact - preload;
  }

  [[nodiscard]] const BlockPattern& pattern_of_factor() const {
    return wide ? wide->pattern : assembly.pattern();
  }

  bool renew_factor(const Matrix3Xd& u) {
    if (!K) K.emplace(assembly.pattern());
    assembly.set_state(u, fields);
    assembly.tangent(fields, *K);
    pairs.add_tangent(*K);
    std::optional<CholeskyFactor> fresh;
    if (mutual && !mutual->fits(pattern_of_factor())) {
      wide = std::make_unique<WideTangent>(mutual->widened(assembly.pattern()), workspace);
    }
    if (wide) {
      wide->set(*K);
      mutual->add_tangent(wide->K);
      fresh = CholeskyFactor::make(wide->analysis, wide->K, FactorPrecision::k32Bits, workspace);
    } else {
      fresh = CholeskyFactor::make(core.analysis, *K, FactorPrecision::k32Bits, workspace);
    }
    if (!fresh) return false;
    own_factor = std::move(fresh);
    factor = &*own_factor;
    corrections = QuasiNewton();
    factor_is_slow = false;
    ++factors;
    return true;
  }

  CgResult solve_tangent(const Matrix3Xd& u, bool with_curvature, double relative) {
    assembly.set_state(u, fields);
    const auto apply_factor = [&](const VectorXd& b, VectorXd& x) {
      factor->solve_roughly(b, x, workspace);
    };
    const CgSystem system{
        .K =
            [&](const VectorXd& x, VectorXd& y) {
              assembly.tangent_product(fields, x, y);
              pairs.add_product(x, with_curvature, y);
              if (mutual) mutual->add_product(x, y);
            },
        .preconditioner = [&](const VectorXd& b,
                              VectorXd& x) { corrections.solve(b, x, apply_factor); },
        .visit = [&](const VectorXd& s, const VectorXd& Ks) { corrections.record(s, Ks); }};
    const CgResult cg =
        conjugate_gradients(system, r, relative, settings.max_cg_iterations, d, scratch);
    cg_iterations += cg.iterations;
    corrections.use_recorded();
    return cg;
  }

  // Computes d, the Newton step for the residual r.
  Stop newton_step(const Matrix3Xd& u, double tolerance) {
    if (factor_is_slow && !renew_factor(u)) return Stop::kNegativeCurvature;
    const double relative = r.norm() / scale;
    const double forcing =
        std::max(std::min(0.02, relative), std::min(0.5, 0.3 * tolerance / relative));
    bool with_curvature = true;
    for (int attempt = 0; attempt < 3; ++attempt) {
      const CgResult cg = solve_tangent(u, with_curvature, forcing);
      if (cg.end == CgEnd::kConverged) {
        factor_is_slow = cg.iterations > settings.refresh_iterations;
        return Stop::kNone;
      }
      if (cg.end == CgEnd::kNegativeCurvature) {
        // With the obstacle's curvature the tangent may be indefinite, since a point may slide off.
        // Without it the step is still a descent direction.
        if (!with_curvature) return Stop::kNegativeCurvature;
        with_curvature = false;
      } else if (!renew_factor(u)) {
        return Stop::kNegativeCurvature;
      }
    }
    return Stop::kLinearSolver;
  }

  // Minimises the Lagrangian at fixed multipliers, starting from u, in `most` Newton steps.
  Stop minimise(const ObstacleGaps& gaps, double tolerance, Matrix3Xd& u, BodyState& state,
                int most) {
    double value = evaluate(gaps, u, state);
    if (!std::isfinite(value)) return Stop::kInversion;
    Matrix3Xd trial;
    for (int step = 0;; ++step) {
      const double norm = r.norm();
      if (norm <= std::max(tolerance * scale, assembly.force_noise())) return Stop::kNone;
      if (step == most) return Stop::kNoConvergence;
      if (const Stop failed = newton_step(u, tolerance); failed != Stop::kNone) return failed;
      ++newton_steps;
      const double slope = -r.dot(d);
      const double rounding = assembly.energy_noise() + 1e-13 * std::abs(value);
      BodyState trial_state;
      double trial_value = 0.0;
      for (double share = 1.0;; share *= 0.5) {
        if (share < 1e-6) {
          return std::isfinite(trial_value) ? Stop::kNoConvergence : Stop::kInversion;
        }
        trial = u;
        assembly.add_scattered(d, share, trial);
        trial_value = evaluate(gaps, trial, trial_state);
        if (!std::isfinite(trial_value)) continue;
        if (trial_value <= value + 1e-4 * share * slope + rounding) break;
        if (r.norm() <= 0.5 * norm) break;
      }
      std::swap(u, trial);
      state = trial_state;
      value = trial_value;
    }
  }

  // Finds equilibrium with the obstacle at time t; on success it becomes `now`.
  // @param roughly  within kPassingTolerance and kPassingEntry
  Stop solve(double t, bool roughly) {
    const ObstacleGaps gaps(motion(t));
    if (!checked_begin) {
      positions = core.model.mesh.nodes + now.displacement;
      if (swallows(ObstacleGaps(motion(now.t)))) return Stop::kSwallowed;
      if (mutual && mutual->detect(positions).buried > 0) return Stop::kSwallowed;
      checked_begin = true;
    }
    const Matrix3Xd positions_before = core.model.mesh.nodes + now.displacement;
    if (mutual) mutual->use(mutual->detect(positions_before));
    const Obstacle obstacle_before = motion(now.t);
    pairs.reassign_parts(gaps, obstacle_before, positions_before);
    if (with_obstacle()) {
      // All points that may touch, so that the start is the same whatever was near before.
      pairs.find(gaps, positions_before, edge);
      pairs.begin_step(gaps, obstacle_before, positions_before);
    }
    if (between_bodies()) mutual->begin_step(positions_before);
    Matrix3Xd u = start(gaps, t);
    positions = core.model.mesh.nodes + u;
    if (between_bodies()) mutual->set_predicted(positions);
    pairs.find(gaps, positions, edge);
    if (mutual) mutual->use(mutual->detect(positions));
    BodyState state;
    if (with_obstacle()) predict(gaps, u);
    const double least_tolerance = settings.tolerance * (roughly ? kPassingTolerance : 1.0);
    const double most_entry = largest_entry() * (roughly ? kPassingEntry : 1.0);
    double tolerance = std::max(kFirstTolerance, settings.tolerance);
    const int most = settings.max_updates * (rubs() ? kUpdatesWithFriction : 1);
    for (int update = 0; update < most; ++update) {
      const Stop failed = minimise(gaps, tolerance, u, state, settings.max_newton_steps);
      if (failed != Stop::kNone) return failed;
      positions = core.model.mesh.nodes + u;
      double change = update_friction(gaps);
      change = std::max(change, pairs.update_multipliers());
      if (mutual) change = std::max(change, mutual->update_multipliers());
      ++updates;
      bool all_there = pairs.find(gaps, positions, edge) == 0;
      MutualPairs::Detection detected;
      if (mutual) {
        detected = mutual->detect(positions);
        if (detected.buried > 0) return Stop::kSwallowed;
        all_there = all_there && detected.shift <= kSettled && detected.smallest_gap >= -most_entry;
      }
      if (all_there && change <= most_entry && tolerance <= least_tolerance) {
        if (swallows(gaps)) return Stop::kSwallowed;
        if (largest_movement(core.held, u) > core.model.largest_displacement) {
          return Stop::kBeyondRange;
        }
        now.smallest_mutual_gap = detected.smallest_gap;
        keep(gaps, t, std::move(u), state);
        return Stop::kNone;
      }
      if (mutual) mutual->use(std::move(detected));
      tolerance = std::max(kTighter * tolerance, settings.tolerance);
    }
    return Stop::kNoConvergence;
  }

  // With friction: estimates where the nodes would be at the end of the step without the points
  // that begin to press in it. From this follows when and where those points are touched. If the
  // estimate is near equilibrium, the step starts from it: u is set to it. A body that only the new
  // points hold has no such equilibrium; u stays.
  void predict(const ObstacleGaps& gaps, Matrix3Xd& u) {
    const std::vector<ContactPair> saved = pairs.pairs();
    const std::vector<MutualPair> between = mutual ? mutual->pairs() : std::vector<MutualPair>();
    pairs.leave_out_new(true);
    Matrix3Xd predicted = u;
    BodyState state;
    bool is_near = true;
    for (int update = 0; update < kPredictionUpdates && is_near; ++update) {
      is_near = minimise(gaps, kFirstTolerance, predicted, state, kPredictionSteps) == Stop::kNone;
      positions = core.model.mesh.nodes + predicted;
      update_friction(gaps);
      pairs.update_multipliers();
      if (mutual) mutual->update_multipliers();
    }
    pairs.set_predicted(positions);
    if (is_near) {
      u = std::move(predicted);
    } else {
      pairs.restore(saved);
      if (mutual) mutual->restore(between);
      positions = core.model.mesh.nodes + u;
    }
    pairs.leave_out_new(false);
    pairs.find(gaps, positions, edge);
    if (mutual) mutual->use(mutual->detect(positions));
  }

  // m, the largest penetration of a contact point, and change of a force over its penalty.
  [[nodiscard]] double largest_entry() const {
    return settings.largest_entry * size * (between_bodies() ? kRubbing : 1.0);
  }

  // Turns the planes of friction, and anchors points that begin to press, after a minimisation that
  // ended at `positions`. @returns how far the friction forces still change, m; 0 without friction
  double update_friction(const ObstacleGaps& gaps) {
    double change = 0.0;
    // As a movement of a node: sliding points give way far more than the stiffness that holds them
    // says. Points of two skins may share their forces in several ways, so only their slides count.
    if (with_obstacle())
      change = settings.sticking_penalty * pairs.update_friction(gaps, positions);
    if (between_bodies()) change = std::max(change, mutual->update_friction(positions));
    return change;
  }

  // Whether a part of the obstacle lies inside the body at `positions`. Contact pushes the skin out
  // of an obstacle, but not an obstacle out of the body: one that lies inside is in contact with no
  // skin, and all forces are 0. A step that is too long could end in that state.
  [[nodiscard]] bool swallows(const ObstacleGaps& gaps) const {
    const SurfaceMesh skin{positions(Eigen::all, boundary.node_of_vertex),
                           boundary.surface.triangles};
    const Eigen::AlignedBox3d box(skin.vertices.rowwise().minCoeff(),
                                  skin.vertices.rowwise().maxCoeff());
    std::optional<SurfaceDistance> distance;
    for (int part = 0; part < gaps.part_count(); ++part) {
      if (!gaps.may_reach(part, box)) continue;
      for (const Vector3d& x : gaps.core(part)) {
        if (!box.contains(x)) continue;
        if (!distance) distance.emplace(skin);
        const double inside = -distance->nearest(x).distance;
        // A capsule's axis must be outside; a surface's corner may penetrate between contact
        // points.
        const double allowed = gaps.distance(part, x) < -1e-9 ? 0.0 : spacing;
        if (inside > allowed) return true;
      }
    }
    return false;
  }

  // The start with the smallest residual: the last state, the extrapolation of the last two, or the
  // better of these after a Newton step in which points with force stay on the obstacle. Without
  // that step, an obstacle that withdraws would release the body at once from states that only the
  // obstacle keeps stable.
  Matrix3Xd start(const ObstacleGaps& gaps, double t) {
    Matrix3Xd best = now.displacement;
    double smallest = residual_at(gaps, best);
    const auto try_start = [&](Matrix3Xd u) {
      const double residual = residual_at(gaps, u);
      if (residual >= smallest) return;
      smallest = residual;
      best = std::move(u);
    };
    const double ratio = before.t == now.t ? 0.0 : (t - now.t) / (now.t - before.t);
    if (ratio > 0.0 && ratio <= 2.0) {
      try_start(now.displacement + ratio * (now.displacement - before.displacement));
    }
    if (now.touching > 0 || now.mutual_touching > 0) {
      BodyState state;
      evaluate(gaps, best, state, true);
      if (newton_step(best, kFirstTolerance) == Stop::kNone) {
        Matrix3Xd u = best;
        assembly.add_scattered(d, 1.0, u);
        try_start(std::move(u));
      }
    }
    return best;
  }

  double residual_at(const ObstacleGaps& gaps, const Matrix3Xd& u) {
    BodyState state;
    const double value = evaluate(gaps, u, state);
    return std::isfinite(value) ? r.norm() : std::numeric_limits<double>::infinity();
  }

  // Makes u the state `now`. @pre u and the pairs are in equilibrium
  void keep(const ObstacleGaps& gaps, double t, Matrix3Xd u, const BodyState& state) {
    before.displacement = std::move(now.displacement);
    before.t = now.t;
    now.displacement = std::move(u);
    now.t = t;
    now.energy = state.energy;
    now.smallest_volume_ratio = state.smallest_volume_ratio;
    now.residual = scale > 0.0 ? r.norm() / scale : 0.0;
    now.force.setZero();
    now.touching = 0;
    now.smallest_gap = now.smallest_force = std::numeric_limits<double>::infinity();
    Vector3d moment = Vector3d::Zero();
    double sum = 0.0, largest_product = 0.0;
    for (const ContactPair& pair : pairs.pairs()) {
      now.smallest_gap = std::min(now.smallest_gap, pair.gap.distance);
      now.smallest_force = std::min(now.smallest_force, pair.force);
      if (pair.force == 0.0) continue;
      ++now.touching;
      sum += pair.force;
      now.force += pair.whole_force();
      moment += pair.force * position_of(points.points[pair.point], positions);
      largest_product = std::max(largest_product, std::abs(pair.gap.distance) * pair.force);
    }
    keep_friction();
    now.centre = moment / sum;  // NaN without force
    now.complementarity = sum > 0.0 ? largest_product / (sum * size) : 0.0;
    now.entry_between = entry_between(gaps);
    now.held_entry = pairs.held_entry(gaps, positions);
    if (!mutual) return;
    now.mutual_force = mutual->force_on_components();
    now.mutual_touching =
        static_cast<int>(std::count_if(mutual->pairs().begin(), mutual->pairs().end(),
                                       [](const MutualPair& pair) { return pair.force > 0.0; }));
  }

  // What `now` states of friction; the anchors become those of the new state.
  void keep_friction() {
    now.sticking = 0;
    now.touching_area = now.sticking_area = now.cone_error = 0.0;
    double bounds = 0.0, off = 0.0;
    const auto count = [&](const auto& pair, double coefficient) {
      if (pair.force == 0.0) return;
      const double bound = coefficient * pair.force, rub = pair.friction.force.norm();
      bounds += bound;
      off += pair.friction.slips ? std::abs(rub - bound) : std::max(0.0, rub - bound);
      const double area = points.points[pair.point].area;
      now.touching_area += area;
      if (pair.friction.limit == 0.0 || pair.friction.slips) return;
      ++now.sticking;
      now.sticking_area += area;
    };
    if (with_obstacle()) {
      for (const ContactPair& pair : pairs.pairs()) {
        count(pair, settings.friction);
        if (pair.force == 0.0) now.force += pair.friction.force;
      }
      now.dissipated += pairs.end_step(positions);
    }
    if (between_bodies()) {
      for (const MutualPair& pair : mutual->pairs()) count(pair, settings.mutual_friction);
      now.dissipated += mutual->end_step(positions);
    }
    if (bounds > 0.0) now.cone_error = off / bounds;
  }

  [[nodiscard]] double entry_between(const ObstacleGaps& gaps) const {
    if (now.touching == 0) return 0.0;
    Boundary near = boundary;
    std::vector<int> triangles;
    for (int t = 0; t < boundary.surface.triangle_count(); ++t) {
      const Matrix3d corners = corners_of(t);
      const Vector3d centre = corners.rowwise().mean();
      const double radius = (corners.colwise() - centre).colwise().norm().maxCoeff();
      if (gaps.distance(centre) <= radius) triangles.push_back(t);
    }
    near.surface.triangles = boundary.surface.triangles(Eigen::all, triangles);
    double deepest = 0.0;
    for (const ContactPoint& point :
         contact_points(core.model.mesh, near, kFinerGrid * spacing).points) {
      if (pairs.is_held(point)) continue;
      const Vector3d x = position_of(point, positions);
      deepest = std::max(deepest, -gaps.distance(x));
    }
    return deepest;
  }

  [[nodiscard]] Matrix3d corners_of(int triangle) const {
    Matrix3d corners;
    for (int k = 0; k < 3; ++k) {
      corners.col(k) =
          positions.col(boundary.node_of_vertex[boundary.surface.triangles(k, triangle)]);
    }
    return corners;
  }

  // @param roughly  as for solve()
  bool advance(double t, bool roughly) {
    updates = newton_steps = cg_iterations = factors = 0;
    now.steps = 0;
    double step = t - now.t;
    int halvings = 0;
    while (now.t != t || (is_rough && !roughly)) {
      const double left = t - now.t;
      const double next = std::abs(step) >= std::abs(left) ? t : now.t + step;
      const std::vector<ContactPair> multipliers = pairs.pairs();
      const std::vector<MutualPair> between = mutual ? mutual->pairs() : std::vector<MutualPair>();
      stop = solve(next, roughly);
      if (stop == Stop::kNone) {
        ++now.steps;
        is_rough = roughly;
        if (halvings > 0) --halvings;
        step *= 2.0;
        continue;
      }
      pairs.restore(multipliers);  // forces as they were in the last good state
      if (mutual) mutual->restore(between);
      if (halvings == settings.max_halvings) break;
      ++halvings;
      step = 0.5 * (next - now.t);
    }
    now.updates = updates;
    now.newton_steps = newton_steps;
    now.cg_iterations = cg_iterations;
    now.factors = factors;
    why = stop == Stop::kNone ? "" : describe(t);
    return stop == Stop::kNone;
  }

  [[nodiscard]] std::string describe(double t) const {
    std::string reason;
    switch (stop) {
      case Stop::kInversion:
        reason = "an element would be turned inside out; mesh the body finer there";
        break;
      case Stop::kNegativeCurvature:
        reason = expansion_text(core.model.mesh, now.displacement)
                     .value_or("the body loses its stiffness there: it buckles or collapses");
        break;
      case Stop::kNoConvergence:
        reason = "Newton's method did not converge";
        break;
      case Stop::kLinearSolver:
        reason = "conjugate gradients did not converge";
        break;
      case Stop::kSwallowed:
        if (!checked_begin && mutual) {
          return "the obstacle lies inside the body where its way begins, or a body in another";
        }
        if (!checked_begin) return "the obstacle lies inside the body where its way begins";
        reason = now.held_entry > kHeldMatters
                     ? "it would get inside the body through skin that is held"
                     : "it would get inside the body through its skin; go in smaller steps";
        break;
      case Stop::kBeyondRange:
        reason = beyond_range_text(core.model.largest_displacement);
        break;
      case Stop::kNone:
        break;
    }
    return fmt::format("the obstacle was followed to {:.6g} of {:.6g}: {}", now.t, t, reason);
  }
};

ContactWalk::ContactWalk(const EquilibriumSolver& solver, ObstacleMotion motion, double begin,
                         const ContactSettings& settings, const Preloaded* preloaded)
    : work_(std::make_unique<Work>(solver, std::move(motion), begin, settings, preloaded)) {}
ContactWalk::~ContactWalk() = default;
ContactWalk::ContactWalk(ContactWalk&&) noexcept = default;
ContactWalk& ContactWalk::operator=(ContactWalk&&) noexcept = default;

bool ContactWalk::advance(double t) { return work_->advance(t, false); }
bool ContactWalk::pass(double t) { return work_->advance(t, work_->rubs()); }

void ContactWalk::set_friction(double coefficient) {
  work_->settings.friction = coefficient;
  work_->pairs.set_friction(coefficient, work_->core.model.mesh.nodes + work_->now.displacement);
}

const ContactState& ContactWalk::now() const { return work_->now; }
Stop ContactWalk::stop() const { return work_->stop; }
const std::string& ContactWalk::why_stopped() const { return work_->why; }
double ContactWalk::spacing() const { return work_->spacing; }
double ContactWalk::body_size() const { return work_->size; }

Matrix3Xd ContactWalk::nodal_forces() const {
  Matrix3Xd force = Matrix3Xd::Zero(3, work_->assembly.node_count());
  work_->pairs.add_forces(force);
  return force;
}

Matrix3Xd ContactWalk::mutual_nodal_forces() const {
  Matrix3Xd force = Matrix3Xd::Zero(3, work_->assembly.node_count());
  if (work_->mutual) work_->mutual->add_forces(force);
  return force;
}

}  // namespace palpable
