#include "palpable/common/response/inertia.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Vector3f;

// Steps in the shortest period. With eight the force of a touch that moves at 0.2 m/s is off by
// some 3 %, with one in a frame by 18 % (seven modes of 5 to 58 Hz).
constexpr double kStepsInPeriod = 8;

// m. A body of which nothing moves by more comes to rest.
constexpr double kRests = 1e-7;

// (m) of a table's modes that are used.
std::vector<double> used_frequencies(const VibrationTable& table) {
  std::vector<double> used;
  for (const double omega : table.omega) {
    if (omega <= Inertia::kFastest) used.push_back(omega);
  }
  return used;
}

// Gives a state that has none yet its coordinates.
void make_room(VibrationState& state, std::size_t modes) {
  for (std::vector<double>* list : {&state.q, &state.velocity, &state.force}) {
    list->resize(modes, 0.0);
  }
}

}  // namespace

Inertia::Inertia(const VibrationTable& table, int nodes)
    : omega_(used_frequencies(table)),
      damping_(table.damping()),
      width_(padded(omega_.size())),
      rows_(RowsOfFloats::Zero(3 * Index{nodes}, static_cast<Index>(width_))),
      field_(3, nodes) {
  PALPABLE_EXPECT(table.shapes.cols() == 3 * Index{nodes}, "shapes of all nodes");
  const auto m = static_cast<Index>(omega_.size());
  rows_.leftCols(m) = table.shapes.topRows(m).transpose();
  for (Index k = 0; k < m; ++k) {
    double largest = 0;
    for (Index n = 0; n < nodes; ++n) {
      largest =
          std::max(largest, static_cast<double>(table.shapes.row(k).segment<3>(3 * n).norm()));
    }
    largest_.push_back(largest);
  }
  for (auto* list : {&q_, &velocity_, &began_}) list->resize(omega_.size());
  step_.resize(omega_.size());
  for (auto* list : {&p_, &r_, &d_, &of_state_}) list->resize(width_);
  set_step(0);
}

int Inertia::steps_in(double time) const {
  if (omega_.empty()) return 1;
  const double steps = std::ceil(time * kStepsInPeriod * omega_.back() / kTurn);
  return std::max(1, static_cast<int>(steps));
}

Inertia::Propagator Inertia::over(double time, double omega) const {
  const double decay = damping_ * omega, omega_d = omega * std::sqrt(1 - damping_ * damping_);
  const double left = std::exp(-decay * time);
  const double s = left * std::sin(omega_d * time), c = left * std::cos(omega_d * time);
  return {c + decay / omega_d * s, s / omega_d, c - decay / omega_d * s};
}

void Inertia::set_step(double h) {
  h_ = h;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    step_[k] = over(h, omega_[k]);
    // alpha - Omega^-2 with alpha = (1 - A) / omega^2.
    d_[k] = h > 0 ? static_cast<float>(-step_[k].a / (omega_[k] * omega_[k])) : 0.0f;
  }
}

void Inertia::ring_on(VibrationState& state, double time) {
  if (!state.moves) return;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const Propagator p = over(time, omega_[k]);
    const double square = omega_[k] * omega_[k], r = lag(state, k), v = state.velocity[k];
    state.q[k] = p.a * r + p.b * v + state.force[k] / square;
    state.velocity[k] = -square * p.b * r + p.b_rate * v;
  }
}

// r of a state.
double Inertia::lag(const VibrationState& state, std::size_t mode) const {
  if (!state.moves) return 0;
  return state.q[mode] - state.force[mode] / (omega_[mode] * omega_[mode]);
}

void Inertia::begin_step(const VibrationState& state, std::span<const VertexForce> loads) {
  const bool is_new = state.q.empty();
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    q_[k] = is_new ? 0 : state.q[k];
    velocity_[k] = is_new ? 0 : state.velocity[k];
    began_[k] = h_ > 0 ? step_[k].a * q_[k] + step_[k].b * velocity_[k] : lag(state, k);
  }
  load(loads);
}

void Inertia::load(std::span<const VertexForce> loads) {
  std::fill(p_.begin(), p_.end(), 0.0f);
  for (const VertexForce& at : loads) {
    if (!at.force.isZero(0)) add_row(at.vertex, at.force, p_);
  }
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    r_[k] = static_cast<float>(began_[k]) + d_[k] * p_[k];
  }
}

double Inertia::static_compliance_at(int vertex) const {
  double sum = 0;
  for (Index row = 3 * Index{vertex}; row < 3 * Index{vertex} + 3; ++row) {
    sum += static_compliance({rows_.row(row).data(), width_});
  }
  return sum;
}

double Inertia::slowest_period() const { return omega_.empty() ? 0 : kTurn / omega_.front(); }

Vector3f Inertia::displacement_at(int vertex) const {
  Vector3f u;
  best_row_kernels().dots_floats(rows_.row(3 * Index{vertex}).data(), 3, r_, u.data());
  return u;
}

void Inertia::fill(std::span<const float> r, Index nodes) {
  best_row_kernels().dots_floats(rows_.data(), static_cast<std::size_t>(3 * nodes), r,
                                 field_.data());
}

const Eigen::Matrix3Xf& Inertia::field(Index nodes) {
  fill(r_, nodes);
  return field_;
}

const Eigen::Matrix3Xf& Inertia::field(const VibrationState& state) {
  for (std::size_t k = 0; k < omega_.size(); ++k) of_state_[k] = static_cast<float>(lag(state, k));
  fill(of_state_, field_.cols());
  return field_;
}

void Inertia::add_row(int vertex, const Vector3f& force, std::span<float> row) const {
  best_row_kernels().add_float_rows(rows_.row(3 * Index{vertex}).data(), width_, {force.data(), 3},
                                    row);
}

void Inertia::times(std::span<const float> row, std::span<float> result) const {
  for (std::size_t k = 0; k < width_; ++k) result[k] = d_[k] * row[k];
}

double Inertia::static_compliance(std::span<const float> row) const {
  double sum = 0;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const double y = static_cast<double>(row[k]) / omega_[k];
    sum += y * y;
  }
  return sum;
}

void Inertia::rest(VibrationState& state, std::span<const VertexForce> loads) {
  load(loads);
  make_room(state, omega_.size());
  state.moves = false;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    state.force[k] = static_cast<double>(p_[k]);
    state.q[k] = state.force[k] / (omega_[k] * omega_[k]);
    state.velocity[k] = 0;
  }
}

void Inertia::end_step(VibrationState& state, bool may_rest) const {
  make_room(state, omega_.size());
  state.moves = true;
  bool is_loaded = false;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const double square = omega_[k] * omega_[k];
    const auto p = static_cast<double>(p_[k]);
    is_loaded |= p != 0;
    state.force[k] = p;
    if (h_ > 0) {
      const Propagator& step = step_[k];
      state.q[k] = step.a * q_[k] + step.b * velocity_[k] + (1 - step.a) / square * p;
      state.velocity[k] = -square * step.b * q_[k] + step.b_rate * velocity_[k] + step.b * p;
    } else {
      state.q[k] = began_[k] + p / square;
      state.velocity[k] = velocity_[k];
    }
  }
  if (may_rest && !is_loaded && amplitude(state) < kRests) {
    state.moves = false;
    std::fill(state.q.begin(), state.q.end(), 0.0);
    std::fill(state.velocity.begin(), state.velocity.end(), 0.0);
  }
}

void Inertia::limit_step(VibrationState& state, const VibrationState& began, double share) const {
  const auto mix = [share](double before, double& now) { now = before + share * (now - before); };
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    mix(began.q[k], state.q[k]);
    mix(began.velocity[k], state.velocity[k]);
    mix(began.force[k], state.force[k]);
  }
  state.moves |= began.moves;
}

double Inertia::energy(const VibrationState& state) const {
  if (!state.moves) return 0;
  double energy = 0;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const double v = state.velocity[k], r = omega_[k] * lag(state, k);
    energy += (v * v + r * r) / 2;
  }
  return energy;
}

double Inertia::largest_speed(const VibrationState& state) const {
  if (!state.moves) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < omega_.size(); ++k) sum += largest_[k] * std::abs(state.velocity[k]);
  return sum;
}

double Inertia::largest_way(std::span<const double> since, const VibrationState& now,
                            std::span<const int> vertices) {
  const auto at = [](std::span<const double> q, std::size_t k) { return q.empty() ? 0.0 : q[k]; };
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    of_state_[k] = static_cast<float>(at(now.q, k) - at(since, k));
  }
  float farthest = 0;
  for (const int vertex : vertices) {
    Vector3f u;
    best_row_kernels().dots_floats(rows_.row(3 * Index{vertex}).data(), 3, of_state_, u.data());
    farthest = std::max(farthest, u.squaredNorm());
  }
  return std::sqrt(static_cast<double>(farthest));
}

double Inertia::amplitude(const VibrationState& state) const {
  if (!state.moves) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < omega_.size(); ++k) {
    const double v = state.velocity[k] / omega_[k];
    sum += largest_[k] * std::hypot(v, lag(state, k));
  }
  return sum;
}

}  // namespace palpable
