#include "palpable/bake/solid/hertz_block.h"

#include "palpable/common/base/error.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kYoung = 1e5, kPoisson = 0.3;
constexpr double kBallRadius = 1.0;
constexpr double kContactRadius = 0.02;  // 2 % of the ball's radius: strains stay below 1 %
constexpr double kBlock = 8.0 * kContactRadius;

constexpr double kDepth = kContactRadius * kContactRadius / kBallRadius;
constexpr double kPlaneStrainYoung = kYoung / (1.0 - kPoisson * kPoisson);

double hertz_force() { return 4.0 / 3.0 * kPlaneStrainYoung * kContactRadius * kDepth; }

// Maps 0 .. 1 to the block's edge. Cells at 0 are a quarter of the size of even ones.
double graded(double s) { return kBlock * (0.25 * s + 0.75 * s * s * s); }

// Displacement at x of the half space z > 0 under a force F along z at the origin.
Vector3d boussinesq(const Vector3d& x, double F) {
  const double G = kYoung / (2.0 * (1.0 + kPoisson));
  const double r = x.norm(), across = std::hypot(x[0], x[1]), z = x[2];
  const double factor = F / (4.0 * std::numbers::pi * G);
  const double outwards =
      factor * (across * z / (r * r * r) - (1.0 - 2.0 * kPoisson) * across / (r * (r + z)));
  const double down = factor * (z * z / (r * r * r) + 2.0 * (1.0 - kPoisson) / r);
  const double share = across > 0.0 ? outwards / across : 0.0;
  return {share * x[0], share * x[1], down};
}

// z points into the block.
SolidModel quarter_block(int cells) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {1, 1, 1}, cells, cells, cells);
  model.mesh.nodes = model.mesh.nodes.unaryExpr(&graded);
  model.material = material_from_young("neo-hookean", kYoung, kPoisson);
  std::vector<Vector3d> far;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Vector3d X = model.mesh.nodes.col(n);
    if (X.maxCoeff() > 0.999 * kBlock) {
      model.fixed_nodes.push_back(n);
      far.push_back(boussinesq(X, hertz_force()));
    } else if (X[0] == 0.0 || X[1] == 0.0) {
      model.supports.push_back({.node = n, .held = {X[0] == 0.0, X[1] == 0.0, false}});
    }
  }
  model.fixed_displacement.resize(3, static_cast<Eigen::Index>(far.size()));
  for (std::size_t i = 0; i < far.size(); ++i) {
    model.fixed_displacement.col(static_cast<Eigen::Index>(i)) = far[i];
  }
  return model;
}

}  // namespace

HertzResult press_hertz_block(int cells) {
  const EquilibriumSolver solver(quarter_block(cells), {.tolerance = 1e-10});
  const TetMesh& mesh = solver.model().mesh;
  const Matrix3Xd none = Matrix3Xd::Zero(3, mesh.node_count());
  const PathResult moved = solver.solve_path(none, std::array{1.0});
  if (!moved.complete) throw Error("Hertz's block: " + moved.why_stopped);
  const Preloaded preloaded{none, moved.steps.back().displacement};
  const auto way = [](double t) {
    return Obstacle{.capsules = {ball({0, 0, t * kDepth - kBallRadius}, kBallRadius)}};
  };
  ContactWalk walk(solver, way, 0.0, {.largest_entry = 1e-8}, &preloaded);
  for (const double t : {0.25, 0.5, 0.75, 1.0}) {
    if (!walk.advance(t)) throw Error("Hertz's block: " + walk.why_stopped());
  }

  const Matrix3Xd forces = walk.nodal_forces();
  double sum = 0.0, second_moment = 0.0;
  for (int n = 0; n < mesh.node_count(); ++n) {
    sum += forces(2, n);
    second_moment += forces(2, n) * mesh.nodes.col(n).head<2>().squaredNorm();
  }
  const double force = 4.0 * sum;  // of the whole block
  const double radius = std::sqrt(2.5 * second_moment / sum);
  const double relative_radius = radius / kContactRadius, relative_force = force / hertz_force();
  return {.cell = graded(1.0 / cells) / kContactRadius,
          .nodes = mesh.node_count(),
          .force_error = relative_force - 1.0,
          .radius_error = relative_radius - 1.0,
          .pressure_error = relative_force / (relative_radius * relative_radius) - 1.0,
          .state = walk.now()};
}

}  // namespace palpable
