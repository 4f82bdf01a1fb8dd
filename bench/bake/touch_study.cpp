#include "bench/bake/touch_study.h"

#include "palpable/solid/stress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <span>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

constexpr double kFrame = 1.25e-3;  // m that a thing goes on in a frame
constexpr double kLookedAt[] = {2.5e-3, 5e-3, 10e-3};

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

bool is_looked_at(double depth) {
  return std::any_of(std::begin(kLookedAt), std::end(kLookedAt),
                     [&](double d) { return std::abs(d - depth) < 0.1 * kFrame; });
}

// |F_a - F_b| / |F_b| of the resultants; of two things that press against each other, whose
// resultants cancel, of the sums of norms.
double force_difference(const TouchState& state, const Matrix3Xd& truth, bool squeeze) {
  Vector3d sum = Vector3d::Zero();
  double norms = 0;
  for (const PointForce& force : state.forces) {
    sum += force.force.cast<double>();
    norms += static_cast<double>(force.force.norm());
  }
  const double true_norms = truth.colwise().norm().sum();
  if (squeeze) return std::abs(norms - true_norms) / true_norms;
  const Vector3d true_sum = truth.rowwise().sum();
  return (sum - true_sum).norm() / true_sum.norm();
}

// (V) Pa, as the full solver recovers it.
Eigen::VectorXd true_von_mises(const SkinResponse& skin, const Matrix3Xd& displacement) {
  const Eigen::VectorXd nodal =
      von_mises(nodal_cauchy_stress(skin.body().model(), displacement, skin.recovery()));
  return nodal(std::span(skin.shell_nodes()).first(static_cast<std::size_t>(skin.vertex_count())));
}

}  // namespace

GapQuery gaps_to(const ObstacleGaps& gaps) {
  return [&gaps](const Eigen::Vector3f& place, SurfaceGap& gap) {
    const Vector3d x = place.cast<double>();
    double nearest = static_cast<double>(kGapReach);
    int part = -1;
    for (int p = 0; p < gaps.part_count(); ++p) {
      const double distance = gaps.distance(p, x);
      if (distance >= nearest) continue;
      nearest = distance;
      part = p;
    }
    if (part < 0) return false;
    const Gap found = gaps.gap(part, x);
    gap.distance = static_cast<float>(found.distance);
    gap.normal = found.normal.cast<float>();
    gap.curvature = found.curvature.cast<float>();
    return true;
  };
}

std::vector<TouchDifference> compare_touch(const EquilibriumSolver& solver,
                                           const SkinResponse& skin, const Preloaded* preloaded,
                                           TouchSolver& touch, double point_spacing,
                                           const TouchScene& scene, double deepest,
                                           std::string& stopped) {
  ContactSettings settings;
  settings.spacing = point_spacing;
  ContactWalk walk(
      solver, [&scene](double depth) { return obstacle_at(scene, depth); }, -1e-4, settings,
      preloaded);
  const Matrix3Xd rest = skin.body().rest();
  TouchState state;
  std::vector<TouchDifference> differences;
  for (int frame = 1; frame * kFrame < deepest + 0.1 * kFrame; ++frame) {
    const double depth = frame * kFrame;
    if (!walk.advance(depth)) {
      stopped = walk.why_stopped();
      break;
    }
    const ObstacleGaps gaps(obstacle_at(scene, depth));
    const auto begin = std::chrono::steady_clock::now();
    const TouchReport report = touch.advance(state, gaps_to(gaps));
    const double took = milliseconds_since(begin);
    if (!is_looked_at(depth)) continue;
    const Matrix3Xd moved = walk.now().displacement - rest;
    const Matrix3Xd u = skin.on_skin(moved.reshaped()).reshaped(3, skin.vertex_count());
    const Matrix3Xd difference = state.u.leftCols(u.cols()).cast<double>() - u;
    std::vector<float> stress(static_cast<std::size_t>(u.cols()));
    const auto stress_begin = std::chrono::steady_clock::now();
    touch.stress(state, stress);
    const double stress_took = milliseconds_since(stress_begin);
    const Eigen::VectorXd true_stress = true_von_mises(skin, walk.now().displacement);
    TouchDifference d;
    d.thing = scene.thing;
    d.depth = depth;
    d.displacement = difference.norm() / u.norm();
    d.worst_vertex = difference.colwise().norm().maxCoeff();
    d.force = force_difference(state, walk.nodal_forces(), scene.thing == PressingThing::kSqueeze);
    const Eigen::Map<const Eigen::VectorXf> shown(stress.data(), u.cols());
    d.von_mises =
        (shown.cast<double>() - true_stress).cwiseAbs().maxCoeff() / true_stress.maxCoeff();
    d.penetration = report.penetration;
    d.candidates = report.candidates;
    d.milliseconds = took;
    d.stress_milliseconds = stress_took;
    differences.push_back(d);
  }
  return differences;
}

std::vector<double> compliance_errors(const SkinResponse& skin, const Compliance& compliance,
                                      int count, std::uint64_t seed) {
  constexpr double kRadius = 0.008;  // m
  const int V = skin.vertex_count(), C = compliance.clusters();
  const std::size_t k = compliance.rank();
  const auto of = [k](std::vector<float>& numbers, int cluster) {
    return std::span<float>(numbers.data() + static_cast<std::size_t>(cluster) * k, k);
  };
  std::mt19937_64 random(seed);
  std::vector<double> errors;
  while (static_cast<int>(errors.size()) < count) {
    const int middle = static_cast<int>(random() % static_cast<std::uint64_t>(V));
    if (skin.fixed()[middle] != 0) continue;
    const Vector3d in = -skin.mean_normal(middle, kRadius);
    Matrix3Xd load = Matrix3Xd::Zero(3, V);
    std::vector<float> sources(static_cast<std::size_t>(C) * k, 0.0f), targets = sources;
    for (int v = 0; v < V; ++v) {
      const double r = skin.distance(v, middle) / kRadius;
      if (r >= 1 || skin.fixed()[v] != 0) continue;
      load.col(v) = (1 - r * r) * in;
      compliance.add_source(v, load.col(v).cast<float>(), of(sources, compliance.cluster_of(v)));
    }
    for (int from = 0; from < C; ++from) {
      for (int to = 0; to < C; ++to) {
        if (!compliance.are_far(from, to)) continue;
        compliance.add_target(from, of(sources, from), to, of(targets, to));
      }
    }
    Matrix3Xf u(3, V);
    compliance.everywhere(targets, u);
    for (int v = 0; v < V; ++v) {
      if (!load.col(v).isZero(0)) compliance.add_near(v, load.col(v).cast<float>(), u);
    }
    const Eigen::MatrixXd exact =
        skin.on_skin(skin.body().linear(skin.at_nodes(load.reshaped(3 * V, 1))));
    errors.push_back((u.reshaped().cast<double>() - exact.col(0)).norm() / exact.norm());
  }
  return errors;
}

double largest_slide_jump(const SkinResponse& skin, TouchSolver& touch, std::uint64_t seed) {
  constexpr double kDeep = 0.004, kSlide = 0.0005;  // m
  constexpr int kFrames = 80;
  const std::vector<TouchScene> scenes = touch_scenes(skin, PressingThing::kFinger, 1, seed);
  if (scenes.empty()) return 0.0;
  const TouchScene& scene = scenes.front();
  const Vector3d along = scene.way.unitOrthogonal();
  TouchState state;
  const ObstacleGaps first(obstacle_at(scene, kDeep));
  touch.advance(state, gaps_to(first));
  double largest = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    Rigid3 slide = Rigid3::Identity();
    slide.translation() = frame * kSlide * along;
    const ObstacleGaps gaps(moved(obstacle_at(scene, kDeep), slide));
    const Matrix3Xf before = state.u;
    touch.advance(state, gaps_to(gaps));
    largest =
        std::max(largest, static_cast<double>((state.u - before).colwise().norm().maxCoeff()));
  }
  return largest;
}

}  // namespace palpable
