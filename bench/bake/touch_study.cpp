#include "bench/bake/touch_study.h"

#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/touch_bake/touch_scenes.h"

#include <algorithm>
#include <random>
#include <span>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Matrix3Xf;
using Eigen::Vector3d;

}  // namespace

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
  touch.advance(state, ExactObstacles(first));
  double largest = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    Rigid3 slide = Rigid3::Identity();
    slide.translation() = frame * kSlide * along;
    const ObstacleGaps gaps(moved(obstacle_at(scene, kDeep), slide));
    const Matrix3Xf before = state.u;
    touch.advance(state, ExactObstacles(gaps));
    largest =
        std::max(largest, static_cast<double>((state.u - before).colwise().norm().maxCoeff()));
  }
  return largest;
}

}  // namespace palpable
