#include "bench/bake/friction_study.h"

#include "palpable/bake/touch_bake/touch_difference.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kStep = 0.625e-3;  // m
constexpr double kDepth = 5e-3;     // m, also of the drag
constexpr std::array kLooks{2.5e-3, 5e-3, 7.5e-3, 10e-3};

// The scene's obstacle after a path of `t` m: down, then aside.
Obstacle after(const TouchScene& scene, double t) {
  const double aside = std::max(0.0, t - kDepth);
  Rigid3 drag = Rigid3::Identity();
  drag.translation() = aside * scene.way.unitOrthogonal();
  return moved(obstacle_at(scene, std::min(t, kDepth)), drag);
}

double change_between(const SkinResponse& skin, const ContactState& one,
                      const ContactState& other) {
  const Matrix3Xd a = true_displacement(skin, one.displacement);
  const Matrix3Xd b = true_displacement(skin, other.displacement);
  return (a - b).norm() / std::max(a.norm(), b.norm());
}

FrictionDifference friction_difference(const SkinResponse& skin, const ContactState& without,
                                       const ContactState& with) {
  const Matrix3Xd u = true_displacement(skin, with.displacement);
  const Matrix3Xd apart = true_displacement(skin, without.displacement) - u;
  const Eigen::VectorXd stress = true_von_mises(skin, with.displacement);
  FrictionDifference d;
  d.displacement = apart.norm() / u.norm();
  d.worst_vertex = apart.colwise().norm().maxCoeff();
  d.force = (without.force - with.force).norm() / with.force.norm();
  d.angle = std::atan2(without.force.cross(with.force).norm(), without.force.dot(with.force));
  d.von_mises = (true_von_mises(skin, without.displacement) - stress).cwiseAbs().maxCoeff() /
                stress.maxCoeff();
  return d;
}

}  // namespace

std::string compare_friction(const EquilibriumSolver& solver, const SkinResponse& skin,
                             const Preloaded* preloaded, double point_spacing,
                             const TouchScene& scene, double coefficient,
                             const std::function<void(const FrictionDifference&)>& found) {
  ContactSettings settings;
  settings.spacing = point_spacing;
  const auto way = [&scene](double t) { return after(scene, t); };
  ContactWalk without(solver, way, -1e-4, settings, preloaded);
  settings.friction = coefficient;
  ContactWalk with(solver, way, -1e-4, settings, preloaded);
  ContactWalk finer(solver, way, -1e-4, settings, preloaded);
  double t = 0;
  for (const double look : kLooks) {
    while (t < look) {
      const double before = t;
      t = std::min(t + kStep, look);
      if (!finer.advance(0.5 * (before + t)) || !finer.advance(t)) {
        return "with half the steps " + finer.why_stopped();
      }
      if (!without.advance(t)) return "without friction " + without.why_stopped();
      if (!with.advance(t)) return "with friction " + with.why_stopped();
    }
    // When the obstacle was dragged off the body there is nothing to compare.
    if (with.now().touching == 0 || without.now().touching == 0) return {};
    FrictionDifference d = friction_difference(skin, without.now(), with.now());
    d.half_step = change_between(skin, with.now(), finer.now());
    d.thing = scene.thing;
    d.depth = std::min(t, kDepth);
    d.dragged = std::max(0.0, t - kDepth);
    found(d);
  }
  return {};
}

std::optional<double> change_of_press(const EquilibriumSolver& solver, const SkinResponse& skin,
                                      const Preloaded* preloaded, double point_spacing,
                                      const TouchScene& scene, double coefficient) {
  ContactSettings settings;
  settings.spacing = point_spacing;
  settings.friction = coefficient;
  const auto way = [&scene](double depth) { return obstacle_at(scene, depth); };
  ContactWalk coarse(solver, way, -1e-4, settings, preloaded);
  ContactWalk fine(solver, way, -1e-4, settings, preloaded);
  const int steps = static_cast<int>(std::round(kDepth / kStep));
  for (int k = 1; k <= steps; ++k) {
    const double depth = kDepth * k / steps;
    if (!coarse.advance(depth)) return std::nullopt;
    if (!fine.advance(depth - 0.5 * kDepth / steps) || !fine.advance(depth)) return std::nullopt;
    if (fine.now().held_entry > kHeldMatters) return std::nullopt;
  }
  return change_between(skin, coarse.now(), fine.now());
}

}  // namespace palpable
