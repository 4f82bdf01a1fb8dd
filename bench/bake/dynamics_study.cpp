#include "bench/bake/dynamics_study.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/response/inertia.h"
#include "palpable/common/response/touch_solver.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd omega_of(const VibrationTable& modes) {
  return Eigen::Map<const VectorXd>(modes.omega.data(), modes.mode_count());
}

// The extreme of the parabola through three samples, or the middle one of a line.
double vertex_of_parabola(double before, double middle, double after) {
  const double bend = before - 2 * middle + after;
  if (bend == 0) return middle;
  const double slope = 0.5 * (after - before);
  return middle - 0.5 * slope * slope / bend;
}

}  // namespace

PluckedPlace softest_place(const SkinResponse& skin, const VibrationTable& modes) {
  PluckedPlace place;
  double softest = 0;
  const VectorXd inverse = omega_of(modes).cwiseInverse();
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if (skin.fixed()[v] != 0) continue;
    const MatrixXd scaled =
        inverse.asDiagonal() * modes.shapes.middleCols(3 * Index{v}, 3).cast<double>();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(Matrix3d(scaled.transpose() * scaled));
    if (solver.eigenvalues()[2] <= softest) continue;
    softest = solver.eigenvalues()[2];
    place = {v, solver.eigenvectors().col(2)};
  }
  // Eigenvectors have any sign: outwards.
  if (place.direction.dot(skin.normals().col(place.vertex)) < 0) place.direction *= -1;
  return place;
}

Matrix3Xd unit_pull(const SkinResponse& skin, const PluckedPlace& place) {
  Matrix3Xd load = Matrix3Xd::Zero(3, skin.body().model().mesh.node_count());
  load.col(skin.node_of(place.vertex)) = place.direction;
  return load;
}

FullRing ring_in_full(ImplicitDynamics& dynamics, const SkinResponse& skin,
                      const PluckedPlace& place, const Matrix3Xd& start, double time_step,
                      int crossings, double longest) {
  const int node = skin.node_of(place.vertex);
  const Matrix3Xd nothing = Matrix3Xd::Zero(3, start.cols());
  const auto motion = [&] {
    return place.direction.dot(dynamics.displacement().col(node) - dynamics.rest().col(node));
  };
  FullRing full;
  full.ring.time_step = time_step;
  dynamics.start(dynamics.rest(), nothing);
  const double at_rest = dynamics.energy().elastic;
  dynamics.start(start, nothing);
  const double begin = dynamics.energy().balance();
  double least = begin;
  full.energy = begin - at_rest;
  full.ring.motion.push_back(motion());
  int passed = 0;
  while (passed < crossings && dynamics.time() < longest) {
    dynamics.step(nothing);
    full.ring.motion.push_back(motion());
    const auto& all = full.ring.motion;
    if (all[all.size() - 2] * all.back() <= 0) ++passed;
    const DynamicEnergy& energy = dynamics.energy();
    full.energy_rise = std::max(full.energy_rise, energy.kinetic + energy.elastic - least);
    least = std::min(least, energy.kinetic + energy.elastic);
    full.balance_error = std::max(full.balance_error, std::abs(energy.balance() - begin));
  }
  full.steps = static_cast<int>(full.ring.motion.size()) - 1;
  full.newton_steps = dynamics.newton_steps();
  full.cg_iterations = dynamics.cg_iterations();
  return full;
}

Ring ring_of_modes(const VibrationTable& modes, const PluckedPlace& place, double load,
                   double time_step, int samples) {
  Inertia inertia(modes, static_cast<int>(modes.shapes.cols() / 3));
  const VertexForce pull{place.vertex, (load * place.direction).cast<float>()};
  VibrationState state;
  inertia.rest(state, {&pull, 1});
  // The force is gone, and the modes are where it held them.
  std::fill(state.force.begin(), state.force.end(), 0.0);
  state.moves = true;
  inertia.set_step(time_step);
  Ring ring{time_step, {}};
  for (int n = 0; n < samples; ++n) {
    const Vector3d u = inertia.field(state).col(place.vertex).cast<double>();
    ring.motion.push_back(place.direction.dot(u));
    inertia.begin_step(state, {});
    inertia.end_step(state, false);
  }
  return ring;
}

std::vector<double> zero_crossings(const Ring& ring) {
  std::vector<double> times;
  for (std::size_t n = 1; n < ring.motion.size(); ++n) {
    const double before = ring.motion[n - 1], after = ring.motion[n];
    if (before * after > 0 || before == 0) continue;
    times.push_back(ring.time_step * (static_cast<double>(n - 1) + before / (before - after)));
  }
  return times;
}

std::vector<double> swings(const Ring& ring) {
  const std::vector<double> times = zero_crossings(ring);
  std::vector<double> extremes;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    const auto first = static_cast<std::size_t>(times[k] / ring.time_step) + 1;
    const auto last = static_cast<std::size_t>(times[k + 1] / ring.time_step);
    std::size_t most = first;
    for (std::size_t n = first; n <= last; ++n) {
      if (std::abs(ring.motion[n]) > std::abs(ring.motion[most])) most = n;
    }
    extremes.push_back(
        vertex_of_parabola(ring.motion[most - 1], ring.motion[most], ring.motion[most + 1]));
  }
  return extremes;
}

RingDifference ring_difference(const Ring& ring, const Ring& truth) {
  PALPABLE_EXPECT(ring.time_step == truth.time_step, "rings of one time step");
  const std::vector<double> times = zero_crossings(ring), true_times = zero_crossings(truth);
  if (std::min(times.size(), true_times.size()) < kComparedCrossings) {
    throw Error(fmt::format("the rings pass 0 {} and {} times: fewer than {}", times.size(),
                            true_times.size(), kComparedCrossings));
  }
  constexpr std::size_t kLast = kComparedCrossings - 1;
  RingDifference difference;
  const std::vector<double> sizes = swings(ring), true_sizes = swings(truth);
  for (std::size_t k = 0; k < kLast; ++k) {
    difference.amplitudes.push_back(sizes[k] / true_sizes[k] - 1);
    difference.amplitude = std::max(difference.amplitude, std::abs(difference.amplitudes.back()));
  }
  difference.period = 2 * (true_times[kLast] - true_times[0]) / static_cast<double>(kLast);
  difference.phase =
      (times[kPhaseCrossing - 1] - true_times[kPhaseCrossing - 1]) / difference.period;
  const auto first = static_cast<std::size_t>(true_times[0] / truth.time_step) + 1;
  const auto last = static_cast<std::size_t>(true_times[kLast] / truth.time_step);
  double squares = 0, true_squares = 0;
  for (std::size_t n = first; n <= std::min(last, ring.motion.size() - 1); ++n) {
    squares += std::pow(ring.motion[n] - truth.motion[n], 2);
    true_squares += truth.motion[n] * truth.motion[n];
  }
  difference.trace = std::sqrt(squares / true_squares);
  return difference;
}

Obstacle obstacle_of(const Hit& hit, double t) {
  return obstacle_at(hit.scene, std::clamp(hit.speed * t, 0.0, hit.depth));
}

std::vector<Vector3d> hit_in_full(ImplicitDynamics& dynamics, const Hit& hit, double spacing,
                                  int samples) {
  const Matrix3Xd nothing = Matrix3Xd::Zero(3, dynamics.rest().cols());
  dynamics.start(dynamics.rest(), nothing);
  dynamics.set_obstacle([&hit](double t) { return obstacle_of(hit, t); }, {.spacing = spacing});
  std::vector<Vector3d> forces;
  for (int n = 0; n < samples; ++n) {
    dynamics.step(nothing);
    forces.push_back(dynamics.contact_force());
  }
  return forces;
}

std::vector<Vector3d> hit_live(const TouchableBody& body, const Hit& hit, double frame,
                               int frames) {
  TouchSolver solver(body.body.surface, body.body.fixed, *body.touch, {.friction = 0.0});
  TouchState state;
  CapsuleObstacles obstacles;
  std::vector<Capsule> before;
  std::vector<Vector3d> forces;
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  for (int n = 0; n <= frames; ++n) {
    const std::vector<Capsule> now = obstacle_of(hit, n * frame).capsules;
    std::vector<int> become(before.size());
    std::iota(become.begin(), become.end(), 0);
    obstacles.set(now);
    obstacles.set_friction(std::vector<float>(now.size(), kFrictionOfBody), before, become);
    solver.advance(state, obstacles, kNoLimit, n > 0 ? frame : 0.0);
    before = now;
    if (n == 0) continue;
    Vector3d sum = Vector3d::Zero();
    for (const PointForce& at : state.forces) sum += at.force.cast<double>();
    forces.push_back(sum);
  }
  return forces;
}

std::vector<Vector3d> means_of_groups(const std::vector<Vector3d>& forces, int count) {
  PALPABLE_EXPECT(count >= 1, "a group has a sample");
  std::vector<Vector3d> means;
  const auto size = static_cast<std::size_t>(count);
  for (std::size_t first = 0; first + size <= forces.size(); first += size) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t n = first; n < first + size; ++n) sum += forces[n];
    means.emplace_back(sum / count);
  }
  return means;
}

double peak_of(const std::vector<Vector3d>& forces) {
  double largest = 0;
  for (const Vector3d& force : forces) largest = std::max(largest, force.norm());
  return largest;
}

double difference_of(const std::vector<Vector3d>& forces, const std::vector<Vector3d>& truth) {
  PALPABLE_EXPECT(forces.size() == truth.size(), "forces at the same times");
  double apart = 0, all = 0;
  for (std::size_t n = 0; n < truth.size(); ++n) {
    apart += (forces[n] - truth[n]).squaredNorm();
    all += truth[n].squaredNorm();
  }
  return all > 0 ? std::sqrt(apart / all) : 0.0;
}

}  // namespace palpable
