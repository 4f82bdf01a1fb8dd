#include "palpable/common/response/followed_loads.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr float kLeastForce = 1e-6f;  // N, of a load that is still followed

// s, the time in which the load of a vertex is followed. @param vertex  in the cache
float time_at(int vertex, const Inertia& inertia, const ComplianceCache& cache) {
  const int slot = 3 * cache.slot_of(vertex);
  float all = 0;
  for (int c = 0; c < 3; ++c) all += cache.blocks()(slot + c, slot + c);
  const auto of_modes = static_cast<float>(inertia.static_compliance_at(vertex));
  const float share = all > 0 ? std::clamp(of_modes / all, 0.0f, 1.0f) : 1.0f;
  return share * static_cast<float>(inertia.slowest_period());
}

}  // namespace

FollowedLoads::FollowedLoads(int vertices, int most_vertices)
    : number_(static_cast<std::size_t>(vertices), -1) {
  const std::size_t most = 2 * static_cast<std::size_t>(most_vertices);
  followed_.reserve(most);
  for (auto* list : {&begun_, &evaluated_}) list->reserve(most);
  vertices_.reserve(most);
  weights_.reserve(most);
}

void FollowedLoads::begin_step(const Inertia& inertia, const ComplianceCache& cache,
                               const VibrationState& state, std::span<const VertexForce> loads,
                               std::span<const float> weights, std::span<const int> regions,
                               NonlinearResponse& nonlinear) {
  time_ = inertia.step();
  for (const FollowedLoad& one : followed_) number_[static_cast<std::size_t>(one.vertex)] = -1;
  followed_.clear();
  vertices_.clear();
  weights_.assign(weights.begin(), weights.end());
  begun_.assign(loads.begin(), loads.end());
  const auto add = [this](const FollowedLoad& one) {
    number_[static_cast<std::size_t>(one.vertex)] = static_cast<int>(followed_.size());
    followed_.push_back(one);
    vertices_.push_back(one.vertex);
  };
  for (const VertexForce& load : loads) {
    add({load.vertex, Vector3f::Zero(), time_at(load.vertex, inertia, cache)});
  }
  for (const FollowedLoad& one : state.followed) {
    const int number = number_[static_cast<std::size_t>(one.vertex)];
    if (number >= 0) {
      followed_[static_cast<std::size_t>(number)].force = one.force;
      weights_[static_cast<std::size_t>(number)] += one.force.norm();
    } else if (followed_.size() < followed_.capacity()) {
      add(one);
      weights_.push_back(one.force.norm());
    }
  }
  nonlinear.choose_patches(vertices_, weights_, regions);
  evaluate(loads, CrossTerms::kAnew, nonlinear);
}

void FollowedLoads::evaluate(std::span<const VertexForce> loads, CrossTerms cross,
                             NonlinearResponse& nonlinear) {
  evaluated_.clear();
  for (const FollowedLoad& one : followed_) evaluated_.push_back({one.vertex, one.force});
  if (!(time_ > 0)) {
    for (std::size_t k = 0; k < loads.size(); ++k) {
      evaluated_[k].force += loads[k].force - begun_[k].force;
    }
  }
  nonlinear.evaluate(evaluated_, cross);
}

void FollowedLoads::end_step(std::span<const VertexForce> loads, VibrationState& state) {
  state.followed.clear();
  for (std::size_t k = 0; k < followed_.size(); ++k) {
    FollowedLoad& one = followed_[k];
    const bool is_of_step = k < loads.size();
    const Vector3f now = is_of_step ? loads[k].force : Vector3f(Vector3f::Zero());
    if (time_ > 0) {
      one.force += (1 - std::exp(-static_cast<float>(time_) / one.time)) * (now - one.force);
    } else if (is_of_step) {
      one.force += now - begun_[k].force;
    }
    if (one.force.squaredNorm() > kLeastForce * kLeastForce) state.followed.push_back(one);
  }
}

void FollowedLoads::rest(std::span<const VertexForce> loads, VibrationState& state) {
  state.followed.clear();
  for (const VertexForce& load : loads) {
    if (!load.force.isZero(0)) state.followed.push_back({load.vertex, load.force, 0});
  }
}

}  // namespace palpable
