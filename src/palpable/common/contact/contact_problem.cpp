#include "palpable/common/contact/contact_problem.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/response/row_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMostTurning =
    16;  // a multiple of 8: those with the largest force times curvature
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

// direction . field at a candidate, whose field has three values a slot.
float along(const ContactCandidate& c, const Vector3f& direction, const float* field) {
  float sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float* at = field + 3 * c.slots[k];
    const int i = static_cast<int>(k);
    sum += c.weights[i] * (direction[0] * at[0] + direction[1] * at[1] + direction[2] * at[2]);
  }
  return sum;
}

}  // namespace

ContactProblem::ContactProblem(const Eigen::MatrixXf& compliance, int most_points, int most_modes)
    : G_(compliance),
      complementarity_(most_points),
      width_(static_cast<std::size_t>(compliance.rows())),
      most_modes_(static_cast<std::size_t>(most_modes)) {
  PALPABLE_EXPECT(compliance.cols() == compliance.rows() && width_ == padded(width_),
                  "a compliance is symmetric, and has whole rows' steps");
  const auto m = static_cast<std::size_t>(most_points);
  rows_.resize(m * width_);
  mode_rows_.resize(m * most_modes_);
  turned_.resize(m * most_modes_);
  order_.resize(m);
  blobs_.reserve(NonlinearAnswer::kMostBlobs);
  blob_.resize(m);
  turned_code_.resize(most_modes_);
  sums_.resize(m);
  W_.resize(m * m);
  q_.resize(m);
  f_.resize(m);
  turning_.reserve(m);
  tangent_row_.resize(width_);
  constexpr std::size_t t = 2 * kMostTurning;
  Gnt_.resize(m * padded(t));
  M_.resize(t * padded(t));
  for (auto* matrix : {&Gtt_, &D_, &scratch_, &solved_}) matrix->resize(t * t);
  for (auto* vector : {&tu_, &x_, &y_}) vector->resize(t);
  yielding_.reserve(m);
  of_yielding_.reserve(m);
  yield_.resize(m * m);
}

// row = G times a force of 1 N at a candidate.
void ContactProblem::add_row(const ContactCandidate& c, const Vector3f& direction,
                             std::span<float> row) const {
  std::fill(row.begin(), row.end(), 0.0f);
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight = c.weights[static_cast<int>(k)];
    if (weight == 0) continue;
    const Vector3f force = weight * direction;
    best_row_kernels().add_float_rows(G_.data() + static_cast<std::size_t>(3 * c.slots[k]) * width_,
                                      width_, {force.data(), 3}, row);
  }
}

// mode_rows_ and turned_ of the candidates, blob by blob.
void ContactProblem::find_mode_rows(std::span<const ContactCandidate> candidates,
                                    const NonlinearAnswer& answer) {
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    const ContactCandidate& c = candidates[p];
    int heaviest = 0;
    c.weights.maxCoeff(&heaviest);
    blob_[p] = answer.blob_of(c.vertices[static_cast<std::size_t>(heaviest)]);
  }
  blobs_.clear();
  std::size_t next = 0;
  for (int blob = 0; blob < answer.blob_count(); ++blob) {
    const auto r = static_cast<std::size_t>(answer.region_of(blob).mode_count());
    BlobRows rows{next, next, next * most_modes_};
    for (std::size_t p = 0; p < candidates.size(); ++p) {
      if (blob_[p] != blob) continue;
      const ContactCandidate& c = candidates[p];
      const std::size_t at = rows.at + (next - rows.first) * r;
      const std::span<float> row(mode_rows_.data() + at, r);
      std::fill(row.begin(), row.end(), 0.0f);
      for (std::size_t k = 0; k < 3; ++k) {
        const float weight = c.weights[static_cast<int>(k)];
        if (weight != 0) answer.add_mode_row(blob, c.vertices[k], weight * c.normal, row);
      }
      answer.times(blob, row, {turned_.data() + at, r});
      order_[next++] = p;
    }
    rows.last = next;
    blobs_.push_back(rows);
  }
}

// q_: the gaps if no force acted, by the tangent of the present state: g - N J f.
void ContactProblem::find_expected_gaps(std::span<const ContactCandidate> candidates,
                                        std::span<const float> field, const NonlinearAnswer* answer,
                                        double shift) {
  for (std::size_t p = 0; p < candidates.size(); ++p) {
    q_[p] = static_cast<double>(candidates[p].distance) + shift -
            static_cast<double>(along(candidates[p], candidates[p].normal, field.data()));
  }
  if (answer == nullptr) return;
  for (int blob = 0; blob < answer->blob_count(); ++blob) {
    const BlobRows& rows = blobs_[static_cast<std::size_t>(blob)];
    const std::span<const float> code = answer->code(blob);
    const std::span<float> turned(turned_code_.data(), code.size());
    answer->times(blob, code, turned);
    best_row_kernels().dots_floats(mode_rows_.data() + rows.at, rows.last - rows.first, turned,
                                   sums_.data());
    for (std::size_t i = rows.first; i < rows.last; ++i)
      q_[order_[i]] -= static_cast<double>(sums_[i - rows.first]);
  }
}

void ContactProblem::assemble(std::span<const ContactCandidate> candidates,
                              const NonlinearAnswer* answer) {
  const std::size_t m = candidates.size();
  for (std::size_t p = 0; p < m; ++p) {
    const float* row = rows_.data() + p * width_;
    for (std::size_t other = 0; other <= p; ++other) {
      W_[p * m + other] =
          static_cast<double>(along(candidates[other], candidates[other].normal, row));
    }
  }
  if (answer == nullptr) return;
  for (int blob = 0; blob < answer->blob_count(); ++blob) {
    const BlobRows& rows = blobs_[static_cast<std::size_t>(blob)];
    const auto r = static_cast<std::size_t>(answer->region_of(blob).mode_count());
    for (std::size_t i = 0; i < rows.last - rows.first; ++i) {
      best_row_kernels().dots_floats(mode_rows_.data() + rows.at, i + 1,
                                     {turned_.data() + rows.at + i * r, r}, sums_.data());
      double* row = W_.data() + order_[rows.first + i] * m;
      for (std::size_t j = 0; j <= i; ++j)
        row[order_[rows.first + j]] += static_cast<double>(sums_[j]);
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

// Brings D_ down to where the iteration for the turning forces does not run away: the largest
// eigenvalue of G_tt D, roughly, by a few steps of the power method.
void ContactProblem::bound_turning(std::size_t t) {
  const auto size = static_cast<Eigen::Index>(t);
  const Eigen::Map<const Eigen::MatrixXd> Gtt(Gtt_.data(), size, size);
  Eigen::Map<Eigen::VectorXd> x(x_.data(), size), y(y_.data(), size);
  x.setOnes();
  double largest = 0;
  for (int step = 0; step < 8; ++step) {
    for (std::size_t i = 0; i < t; ++i) {
      const std::size_t pair = i / 2 * 2;
      y_[i] = D_[i * t + pair] * x_[pair] + D_[i * t + pair + 1] * x_[pair + 1];
    }
    x.setZero();
    for (Eigen::Index j = 0; j < size; ++j) x += y[j] * Gtt.col(j);
    largest = x.norm();
    if (!(largest > 0)) break;
    x /= largest;
  }
  if (!(largest > kLargestTurn)) return;
  for (std::size_t i = 0; i < t * t; ++i) D_[i] *= kLargestTurn / largest;
}

// W and q with the turning of normals; M_, tu_ and Gnt_ for the forces afterwards.
bool ContactProblem::add_turning(std::span<const ContactCandidate> candidates,
                                 std::span<const float> field) {
  const std::size_t m = candidates.size(), t = 2 * turning_.size(), wide = padded(t);
  if (t == 0) return true;
  const auto direction = [&](std::size_t i) -> const Vector3f& {
    return i % 2 == 0 ? turning_[i / 2].t1 : turning_[i / 2].t2;
  };
  const auto at = [&](std::size_t i) -> const ContactCandidate& {
    return candidates[static_cast<std::size_t>(turning_[i / 2].candidate)];
  };
  for (std::size_t p = 0; p < m; ++p) {
    float* row = Gnt_.data() + p * wide;
    std::fill(row, row + wide, 0.0f);
    for (std::size_t i = 0; i < t; ++i)
      row[i] = along(at(i), direction(i), rows_.data() + p * width_);
  }
  for (std::size_t i = 0; i < t; ++i) {
    add_row(at(i), direction(i), tangent_row_);
    for (std::size_t j = 0; j <= i; ++j) {
      const auto value = static_cast<double>(along(at(j), direction(j), tangent_row_.data()));
      Gtt_[i * t + j] = value;
      Gtt_[j * t + i] = value;
    }
    for (std::size_t j = 0; j < t; ++j) {
      const bool same = i / 2 == j / 2;
      D_[i * t + j] = same ? at(i).pressing * static_cast<double>(
                                                  direction(i).dot(at(i).curvature * direction(j)))
                           : 0.0;
    }
    tu_[i] = static_cast<double>(along(at(i), direction(i), field.data()));
  }
  bound_turning(t);
  // M = (1 - D G_tt)^-1 D
  for (std::size_t i = 0; i < t; ++i) {
    const std::size_t pair = i / 2 * 2;
    for (std::size_t j = 0; j < t; ++j) {
      scratch_[i * t + j] = (i == j ? 1.0 : 0.0) - D_[i * t + pair] * Gtt_[pair * t + j] -
                            D_[i * t + pair + 1] * Gtt_[(pair + 1) * t + j];
      solved_[i * t + j] = D_[i * t + j];
    }
  }
  if (!solve_in_place(scratch_.data(), t, solved_.data(), t)) return false;
  for (std::size_t i = 0; i < t; ++i) {
    float* row = M_.data() + i * wide;
    std::fill(row, row + wide, 0.0f);
    for (std::size_t j = 0; j < t; ++j) row[j] = static_cast<float>(solved_[i * t + j]);
  }
  // Rows of Gnt M, and of it times Gnt^T.
  std::array<float, 2 * kMostTurning> turned;
  const std::span<float> row(turned.data(), wide);
  for (std::size_t p = 0; p < m; ++p) {
    std::fill(row.begin(), row.end(), 0.0f);
    best_row_kernels().add_float_rows(M_.data(), wide, {Gnt_.data() + p * wide, t}, row);
    for (std::size_t i = 0; i < t; ++i) q_[p] -= static_cast<double>(row[i]) * tu_[i];
    best_row_kernels().dots_floats(Gnt_.data(), p + 1, row, sums_.data());
    for (std::size_t other = 0; other <= p; ++other)
      W_[p * m + other] += static_cast<double>(sums_[other]);
  }
  return true;
}

// What other bodies give way by, on the way from where they would be without these forces.
void ContactProblem::add_yielding(std::span<const ContactCandidate> candidates,
                                  const Obstacles& obstacles) {
  const std::size_t m = candidates.size();
  yielding_.clear();
  of_yielding_.clear();
  for (std::size_t p = 0; p < m; ++p) {
    if (candidates[p].on.body < 0) continue;
    yielding_.push_back({candidates[p].on, candidates[p].normal});
    of_yielding_.push_back(p);
  }
  const std::size_t y = yielding_.size();
  if (y == 0) return;
  const std::span<double> more(yield_.data(), y * y);
  std::fill(more.begin(), more.end(), 0.0);
  obstacles.add_compliance(yielding_, more);
  for (std::size_t i = 0; i < y; ++i) {
    double* row = W_.data() + of_yielding_[i] * m;
    for (std::size_t j = 0; j <= i; ++j) row[of_yielding_[j]] += more[i * y + j];
    q_[of_yielding_[i]] -= static_cast<double>(yielding_[i].on.given_way);
  }
}

// The problem of the candidates behind the first ones, under the forces of those: W_ becomes
// smaller.
void ContactProblem::take_out_given(std::span<const ContactCandidate> candidates,
                                    std::size_t given) {
  const std::size_t m = candidates.size(), n = m - given;
  for (std::size_t p = given; p < m; ++p) {
    const double* row = W_.data() + p * m;
    for (std::size_t g = 0; g < given; ++g) q_[p] += row[g] * candidates[g].pressing;
    std::copy(row + given, row + p + 1, W_.data() + (p - given) * n);
  }
}

bool ContactProblem::solve(std::span<ContactCandidate> candidates, std::span<const float> field,
                           const NonlinearAnswer* answer, const ContactStep& step) {
  const std::size_t m = candidates.size();
  const std::span<double> W(W_.data(), m * m), q(q_.data(), m), f(f_.data(), m);
  for (std::size_t p = 0; p < m; ++p)
    add_row(candidates[p], candidates[p].normal, {rows_.data() + p * width_, width_});
  if (answer != nullptr) find_mode_rows(candidates, *answer);
  find_expected_gaps(candidates, field, answer, step.shift);
  assemble(candidates, answer);
  turning_.clear();
  if (step.turning) find_turning(candidates);
  double mean = 0;
  const std::size_t given = step.given, n = m - given;
  for (std::size_t p = given; p < m; ++p) mean += W[p * m + p] / static_cast<double>(n);
  if (!add_turning(candidates, field)) return false;
  for (std::size_t p = given; p < m; ++p) {
    W[p * m + p] += (step.softness + static_cast<double>(candidates[p].softness)) * mean;
  }
  add_yielding(candidates, step.obstacles);
  for (std::size_t p = 0; p < m; ++p) f[p] = candidates[p].pressing;
  if (given > 0) take_out_given(candidates, given);
  if (!complementarity_.solve(W.first(n * n), q.subspan(given), f.subspan(given))) return false;

  const std::size_t t = 2 * turning_.size(), wide = padded(t);
  for (std::size_t i = 0; i < t; ++i) {
    double slide = -tu_[i];
    for (std::size_t p = 0; p < m; ++p) slide += static_cast<double>(Gnt_[p * wide + i]) * f[p];
    x_[i] = slide;
  }
  for (std::size_t p = given; p < m; ++p) {
    candidates[p].pressing = f[p];
    candidates[p].force = static_cast<float>(f[p]) * candidates[p].normal;
  }
  for (std::size_t i = 0; i < t; ++i) {
    double force = 0;
    for (std::size_t j = 0; j < t; ++j) force += static_cast<double>(M_[i * wide + j]) * x_[j];
    ContactCandidate& c = candidates[static_cast<std::size_t>(turning_[i / 2].candidate)];
    c.force += static_cast<float>(force) * (i % 2 == 0 ? turning_[i / 2].t1 : turning_[i / 2].t2);
  }
  return true;
}

}  // namespace palpable
