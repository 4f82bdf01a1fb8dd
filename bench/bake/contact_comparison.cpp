#include "bench/bake/contact_comparison.h"

#include "palpable/bake/calculix/calculix.h"
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kSide = 0.1, kYoung = 60e3, kPoisson = 0.3;
constexpr double kDown = 8e-3, kAside = 4e-3;  // m
constexpr double kTilt = 6.0 * std::numbers::pi / 180.0;

SolidModel block(int cells) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, Vector3d::Constant(kSide), cells, cells, cells);
  model.material = material_from_young("neo-hooke-abaqus", kYoung, kPoisson);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-9);
  return model;
}

// At level 0 the lid touches one edge of the top.
Vector3d lid_normal() { return {std::sin(kTilt), 0.0, -std::cos(kTilt)}; }
Vector3d lid_place(double level, double aside) {
  return {level * aside, 0.5 * kSide, kSide - level * kDown};
}

// N, sum of the internal forces at free nodes, which equals the lid's force.
Vector3d force_of(const EquilibriumSolver& solver, const Matrix3Xd& u) {
  Matrix3Xd force = solver.internal_force(u);
  for (const int node : solver.model().fixed_nodes) force.col(node).setZero();
  return force.rowwise().sum();
}

}  // namespace

std::vector<ContactDifference> compare_contact(int cells, const std::vector<double>& stiffnesses,
                                               double friction) {
  const EquilibriumSolver solver(block(cells));
  const double aside = friction > 0.0 ? kAside : 0.0;
  const int steps = friction > 0.0 ? 20 : 4;
  const auto way = [aside](double t) {
    return Obstacle{.half_spaces = {{lid_place(t, aside), lid_normal()}}};
  };
  // With this spacing the corners of the skin are the only contact points.
  ContactWalk walk(solver, way, 0.0, {.spacing = kSide, .friction = friction});
  std::vector<double> levels;
  for (int k = 1; k <= steps; ++k) {
    levels.push_back(static_cast<double>(k) / steps);
    if (!walk.advance(levels.back())) throw Error("our contact: " + walk.why_stopped());
  }
  const Matrix3Xd& ours = walk.now().displacement;

  std::vector<ContactDifference> differences;
  for (const double stiffness : stiffnesses) {
    CalculixSettings settings;
    settings.tolerance = 1e-6;
    const double pascals = stiffness * kYoung / (kSide / cells);
    settings.lid = CalculixLid{.middle = lid_place(0.0, aside),
                               .normal = lid_normal(),
                               .side = 4.0 * kSide,
                               .way = lid_place(1.0, aside) - lid_place(0.0, aside),
                               .stiffness = pascals,
                               .friction = friction,
                               .sticking = 0.1 * pascals};
    const Matrix3Xd none = Matrix3Xd::Zero(3, solver.model().mesh.node_count());
    const CalculixRun run = solve_with_calculix(solver.model(), none, levels, settings);
    if (!run.complete) throw Error("CalculiX' contact: " + run.why_stopped);
    const Matrix3Xd& theirs = run.states.back().displacement;
    const Vector3d force = force_of(solver, theirs);
    differences.push_back(
        {stiffness, (theirs - ours).colwise().norm().maxCoeff() / ours.colwise().norm().maxCoeff(),
         (force - walk.now().force).norm() / walk.now().force.norm()});
  }
  return differences;
}

}  // namespace palpable
