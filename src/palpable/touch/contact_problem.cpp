#include "palpable/touch/contact_problem.h"

#include "palpable/base/contract.h"
#include "palpable/touch/row_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMostTurning = 24;  // those with the largest force times curvature
// Force times curvature times compliance below which turning is left out: it changes the step by
// as little.
constexpr double kTurns = 0.02;
// The iteration for the turning forces must not run away: D is scaled down to this.
constexpr double kLargestTurn = 0.8;

// In place: A becomes its LU factors with the rows exchanged, B becomes A^-1 B; both row by row.
// @param columns  of B
bool solve_in_place(double* A, std::size_t n, double* B, std::size_t columns) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(A[i * n + k]) > std::abs(A[pivot * n + k])) pivot = i;
    }
    if (!(std::abs(A[pivot * n + k]) > 0)) return false;
    if (pivot != k) {
      std::swap_ranges(A + k * n, A + (k + 1) * n, A + pivot * n);
      std::swap_ranges(B + k * columns, B + (k + 1) * columns, B + pivot * columns);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] / A[k * n + k];
      if (factor == 0) continue;
      for (std::size_t j = k; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = 0; j < columns; ++j) B[k * columns + j] /= A[k * n + k];
    for (std::size_t i = 0; i < k; ++i) {
      const double factor = A[i * n + k];
      for (std::size_t j = 0; j < columns; ++j) B[i * columns + j] -= factor * B[k * columns + j];
    }
  }
  return true;
}

}  // namespace

ContactProblem::ContactProblem(int most_points, int most_vertices, int most_modes)
    : complementarity_(most_points) {
  const auto m = static_cast<std::size_t>(most_points);
  const std::size_t wide = padded(3 * static_cast<std::size_t>(most_vertices));
  const auto r = static_cast<std::size_t>(most_modes);
  G_.resize(wide * wide);
  rows_.resize(m * wide);
  field_.resize(wide);
  mode_rows_.resize(m * r);
  turned_.resize(m * r);
  blob_.resize(m);
  code_.resize(r);
  turned_code_.resize(r);
  W_.resize(m * m);
  q_.resize(m);
  f_.resize(m);
  turning_.reserve(m);
  tangent_rows_.resize(2 * kMostTurning * wide);
  Gnt_.resize(m * 2 * kMostTurning);
  for (auto* matrix : {&Gtt_, &D_, &M_, &scratch_}) matrix->resize(4 * kMostTurning * kMostTurning);
  tu_.resize(2 * kMostTurning);
  force_t_.resize(2 * kMostTurning);
}

void ContactProblem::set_vertices(int count) {
  n_ = count;
  width_ = padded(3 * static_cast<std::size_t>(count));
  PALPABLE_EXPECT(width_ * width_ <= G_.size(), "as many vertices as there is room");
  std::fill(G_.begin(),
            G_.begin() + static_cast<std::ptrdiff_t>(3 * static_cast<std::size_t>(count) * width_),
            0.0f);
}

std::span<float> ContactProblem::compliance_row(int row) {
  return {G_.data() + static_cast<std::size_t>(row) * width_, width_};
}

// direction . field at a candidate, whose field has three values a vertex.
float ContactProblem::along(const ContactCandidate& c, const Vector3f& direction,
                            const float* field) const {
  float sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float* at = field + 3 * c.local[k];
    const int i = static_cast<int>(k);
    sum += c.weights[i] * (direction[0] * at[0] + direction[1] * at[1] + direction[2] * at[2]);
  }
  return sum;
}

// rows_: what a force of 1 N at each candidate does at all vertices.
void ContactProblem::find_rows(std::span<const ContactCandidate> candidates) {
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const ContactCandidate& c = candidates[p];
    const std::span<float> row(rows_.data() + p * width_, width_);
    std::fill(row.begin(), row.end(), 0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
      const float weight = c.weights[static_cast<int>(k)];
      if (weight == 0) continue;
      for (int d = 0; d < 3; ++d) {
        best_row_kernels().add_floats(compliance_row(3 * c.local[k] + d).data(),
                                      weight * c.normal[d], row);
      }
    }
  }
}

// mode_rows_ and turned_, and code_ = H a of each blob through them.
void ContactProblem::find_mode_rows(std::span<const ContactCandidate> candidates,
                                    std::span<const VertexForce> loads,
                                    const NonlinearAnswer& answer) {
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const ContactCandidate& c = candidates[p];
    int heaviest = 0;
    c.weights.maxCoeff(&heaviest);
    const int blob = answer.blob_of(loads[c.local[static_cast<std::size_t>(heaviest)]].vertex);
    blob_[p] = blob;
    if (blob < 0) continue;
    const auto r = static_cast<std::size_t>(answer.region_of(blob).mode_count());
    const std::span<float> row(mode_rows_.data() + p * r, r);
    std::fill(row.begin(), row.end(), 0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
      const float weight = c.weights[static_cast<int>(k)];
      if (weight != 0) answer.add_mode_row(blob, loads[c.local[k]].vertex, weight * c.normal, row);
    }
    answer.times(blob, row, {turned_.data() + p * r, r});
  }
}

// q_: the gaps if no force acted, by the tangent of the present state: g - N J f.
void ContactProblem::find_expected_gaps(std::span<const ContactCandidate> candidates,
                                        std::span<const VertexForce> loads,
                                        const NonlinearAnswer* answer, double shift) {
  const std::span<float> field(field_.data(), width_);
  std::fill(field.begin(), field.end(), 0.0f);
  for (int v = 0; v < n_; ++v) {
    for (int d = 0; d < 3; ++d) {
      const float force = loads[v].force[d];
      if (force != 0) best_row_kernels().add_floats(compliance_row(3 * v + d).data(), force, field);
    }
  }
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    q_[p] = static_cast<double>(candidates[p].distance) + shift -
            static_cast<double>(along(candidates[p], candidates[p].normal, field.data()));
  }
  if (answer == nullptr) return;
  for (int blob = 0; blob < answer->blob_count(); ++blob) {
    const auto r = static_cast<std::size_t>(answer->region_of(blob).mode_count());
    const std::span<float> code(code_.data(), r), turned(turned_code_.data(), r);
    std::fill(code.begin(), code.end(), 0.0f);
    for (const VertexForce& load : loads) {
      if (answer->blob_of(load.vertex) == blob) {
        answer->add_mode_row(blob, load.vertex, load.force, code);
      }
    }
    answer->times(blob, code, turned);
    for (std::size_t p = 0; p < candidates.size(); ++p) {
      if (blob_[p] != blob) continue;
      float sum = 0;
      best_row_kernels().dots_floats(mode_rows_.data() + p * r, 1, turned, &sum);
      q_[p] -= static_cast<double>(sum);
    }
  }
}

void ContactProblem::assemble(std::span<const ContactCandidate> candidates,
                              const NonlinearAnswer* answer) {
  const std::size_t m = candidates.size();
  for (std::size_t p = 0; p < m; ++p) {
    for (std::size_t other = 0; other <= p; ++other) {
      double value = static_cast<double>(
          along(candidates[other], candidates[other].normal, rows_.data() + p * width_));
      if (answer != nullptr && blob_[p] >= 0 && blob_[p] == blob_[other]) {
        const auto r = static_cast<std::size_t>(answer->region_of(blob_[p]).mode_count());
        float sum = 0;
        best_row_kernels().dots_floats(mode_rows_.data() + p * r, 1,
                                       {turned_.data() + other * r, r}, &sum);
        value += static_cast<double>(sum);
      }
      W_[p * m + other] = value;
    }
  }
}

// Which candidates press something round, hard enough to matter.
void ContactProblem::find_turning(std::span<const ContactCandidate> candidates) {
  turning_.clear();
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const ContactCandidate& c = candidates[p];
    const double turn = c.pressing * static_cast<double>(c.curvature.trace());
    if (turn * W_[p * candidates.size() + p] < kTurns) continue;
    Turning t{static_cast<int>(p), c.normal.unitOrthogonal(), {}};
    t.t2 = c.normal.cross(t.t1);
    turning_.push_back(t);
  }
  if (turning_.size() <= kMostTurning) return;
  const auto weight = [&](const Turning& t) {
    const ContactCandidate& c = candidates[static_cast<std::size_t>(t.candidate)];
    return c.pressing * static_cast<double>(c.curvature.trace());
  };
  std::nth_element(turning_.begin(), turning_.begin() + kMostTurning, turning_.end(),
                   [&](const Turning& a, const Turning& b) { return weight(a) > weight(b); });
  turning_.resize(kMostTurning);
}

// W and q with the turning of normals; M_, tu_ and Gnt_ for the forces afterwards.
bool ContactProblem::add_turning(std::span<const ContactCandidate> candidates) {
  const std::size_t m = candidates.size(), t = 2 * turning_.size();
  if (t == 0) return true;
  const auto direction = [&](std::size_t i) -> const Vector3f& {
    return i % 2 == 0 ? turning_[i / 2].t1 : turning_[i / 2].t2;
  };
  const auto at = [&](std::size_t i) -> const ContactCandidate& {
    return candidates[static_cast<std::size_t>(turning_[i / 2].candidate)];
  };
  for (std::size_t i = 0; i < t; ++i) {
    const std::span<float> row(tangent_rows_.data() + i * width_, width_);
    std::fill(row.begin(), row.end(), 0.0f);
    for (std::size_t k = 0; k < 3; ++k) {
      const float weight = at(i).weights[static_cast<int>(k)];
      for (int d = 0; d < 3; ++d) {
        best_row_kernels().add_floats(compliance_row(3 * at(i).local[k] + d).data(),
                                      weight * direction(i)[d], row);
      }
    }
    for (std::size_t p = 0; p < m; ++p) {
      Gnt_[p * t + i] = static_cast<double>(along(candidates[p], candidates[p].normal, row.data()));
    }
    for (std::size_t j = 0; j < t; ++j) {
      Gtt_[i * t + j] = static_cast<double>(along(at(j), direction(j), row.data()));
      const bool same = i / 2 == j / 2;
      D_[i * t + j] = same ? at(i).pressing * static_cast<double>(
                                                  direction(i).dot(at(i).curvature * direction(j)))
                           : 0.0;
    }
    tu_[i] = static_cast<double>(along(at(i), direction(i), field_.data()));
  }
  // The largest eigenvalue of G_tt D, roughly: a few steps of the power method.
  std::vector<double>&x = force_t_, &y = scratch_;
  std::fill(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(t), 1.0);
  double largest = 0;
  for (int step = 0; step < 8; ++step) {
    double norm = 0;
    for (std::size_t i = 0; i < t; ++i) {
      const std::size_t pair = i / 2 * 2;
      y[i] = D_[i * t + pair] * x[pair] + D_[i * t + pair + 1] * x[pair + 1];
    }
    for (std::size_t i = 0; i < t; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < t; ++j) sum += Gtt_[i * t + j] * y[j];
      x[i] = sum;
      norm += sum * sum;
    }
    largest = std::sqrt(norm);
    if (!(largest > 0)) break;
    for (std::size_t i = 0; i < t; ++i) x[i] /= largest;
  }
  const double scale = largest > kLargestTurn ? kLargestTurn / largest : 1.0;
  for (std::size_t i = 0; i < t * t; ++i) D_[i] *= scale;
  // M = (1 - D G_tt)^-1 D
  for (std::size_t i = 0; i < t; ++i) {
    const std::size_t pair = i / 2 * 2;
    for (std::size_t j = 0; j < t; ++j) {
      scratch_[i * t + j] = (i == j ? 1.0 : 0.0) - D_[i * t + pair] * Gtt_[pair * t + j] -
                            D_[i * t + pair + 1] * Gtt_[(pair + 1) * t + j];
      M_[i * t + j] = D_[i * t + j];
    }
  }
  if (!solve_in_place(scratch_.data(), t, M_.data(), t)) return false;
  // Rows of Gnt M, and of it times Gnt^T, t numbers at a time: Eigen's sums are vectorised.
  const auto numbers = [](const std::vector<double>& from, std::size_t first, std::size_t count) {
    return Eigen::Map<const Eigen::VectorXd>(from.data() + first, static_cast<Eigen::Index>(count));
  };
  for (std::size_t p = 0; p < m; ++p) {
    Eigen::Map<Eigen::VectorXd> row(force_t_.data(), static_cast<Eigen::Index>(t));
    row.setZero();
    for (std::size_t j = 0; j < t; ++j) row += Gnt_[p * t + j] * numbers(M_, j * t, t);
    q_[p] -= row.dot(numbers(tu_, 0, t));
    for (std::size_t other = 0; other <= p; ++other) {
      W_[p * m + other] += row.dot(numbers(Gnt_, other * t, t));
    }
  }
  return true;
}

bool ContactProblem::solve(std::span<ContactCandidate> candidates,
                           std::span<const VertexForce> loads, const NonlinearAnswer* answer,
                           const ContactStep& step) {
  const std::size_t m = candidates.size();
  const std::span<double> W(W_.data(), m * m), q(q_.data(), m), f(f_.data(), m);
  find_rows(candidates);
  if (answer != nullptr) find_mode_rows(candidates, loads, *answer);
  find_expected_gaps(candidates, loads, answer, step.shift);
  assemble(candidates, answer);
  turning_.clear();
  if (step.turning) find_turning(candidates);
  double mean = 0;
  for (std::size_t p = 0; p < m; ++p) mean += W[p * m + p] / static_cast<double>(m);
  if (!add_turning(candidates)) return false;
  for (std::size_t p = 0; p < m; ++p) {
    W[p * m + p] += (step.softness + static_cast<double>(candidates[p].softness)) * mean;
  }
  for (std::size_t p = 0; p < m; ++p) f[p] = candidates[p].pressing;
  if (!complementarity_.solve(W, q, f)) return false;

  const std::size_t t = 2 * turning_.size();
  for (std::size_t i = 0; i < t; ++i) {
    double slide = -tu_[i];
    for (std::size_t p = 0; p < m; ++p) slide += Gnt_[p * t + i] * f[p];
    scratch_[i] = slide;
  }
  for (std::size_t p = 0; p < m; ++p) {
    candidates[p].pressing = f[p];
    candidates[p].force = static_cast<float>(f[p]) * candidates[p].normal;
  }
  for (std::size_t i = 0; i < t; ++i) {
    double force = 0;
    for (std::size_t j = 0; j < t; ++j) force += M_[i * t + j] * scratch_[j];
    ContactCandidate& c = candidates[static_cast<std::size_t>(turning_[i / 2].candidate)];
    c.force += static_cast<float>(force) * (i % 2 == 0 ? turning_[i / 2].t1 : turning_[i / 2].t2);
  }
  return true;
}

}  // namespace palpable
