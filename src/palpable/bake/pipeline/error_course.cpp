#include "palpable/bake/pipeline/error_course.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Eigen::VectorXf;
using Eigen::VectorXi;

constexpr double kMostErrors = 1e6;  // 4 MB of a body file

std::span<float> span_of(VectorXf& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

}  // namespace

VectorXi some_of(int most, int count) {
  PALPABLE_EXPECT(most >= 1 && count >= 2, "two ends");
  if (most <= count) return VectorXi::LinSpaced(most, 1, most);
  std::vector<int> some{1};
  for (int left = count - 1; left > 0; --left) {
    // The ratio that would reach `most` in the steps that are left; at least one mode more.
    const double ratio = std::pow(static_cast<double>(most) / some.back(), 1.0 / left);
    some.push_back(std::max(some.back() + 1, static_cast<int>(std::lround(some.back() * ratio))));
  }
  some.back() = most;
  return Eigen::Map<const VectorXi>(some.data(), static_cast<Index>(some.size()));
}

ErrorCourse course_of(const Reduction& reduction) {
  const Index m = reduction.course.rows(), K = reduction.course.cols();
  const auto count = static_cast<int>(
      std::min(static_cast<double>(m), std::max(8.0, kMostErrors / static_cast<double>(K))));
  ErrorCourse course;
  course.modes = some_of(static_cast<int>(m), std::max(2, count));
  course.pooled.resize(course.modes.size());
  course.snapshots.resize(K, course.modes.size());
  for (Index i = 0; i < course.modes.size(); ++i) {
    course.pooled[i] = reduction.pooled_course[course.modes[i] - 1];
    course.snapshots.col(i) = reduction.course.row(course.modes[i] - 1).transpose().cast<float>();
  }
  return course;
}

VonMisesCourse::VonMisesCourse(const SeparatedField& stress, VectorXd areas, Index snapshots)
    : stress_(stress),
      areas_(std::move(areas)),
      modes_(some_of(stress.largest_block(), 12)),
      lost_(MatrixXd::Zero(snapshots, modes_.size())),
      whole_(VectorXd::Zero(snapshots)),
      weights_(stress.mode_count()),
      sigma_(stress.value_count()),
      vm_(areas_.size()),
      vm_truth_(areas_.size()) {
  PALPABLE_EXPECT(stress.value_count() == 6 * areas_.size(), "six components for each vertex");
}

double VonMisesCourse::integral(const VectorXf& of_square) const {
  return of_square.cast<double>().cwiseAbs2().dot(areas_);
}

void VonMisesCourse::add(Index k, std::span<const double> mu, const VectorXf& truth) {
  VectorXf six = truth;
  von_mises(span_of(six), span_of(vm_truth_));
  whole_[k] = integral(vm_truth_);
  stress_.weights(mu, span_of(weights_));
  const auto [first, second] = stress_.block(0, static_cast<Index>(mu[0]));
  sigma_.setZero();
  int summed = 0;
  for (Index q = 0; q < modes_.size(); ++q) {
    const int wanted = std::min(modes_[q], second - first);
    if (q > 0 && wanted == summed) {  // this site has no further modes
      lost_(k, q) = lost_(k, q - 1);
      continue;
    }
    for (; summed < wanted; ++summed) {
      sigma_ += weights_[first + summed] * stress_.modes().col(first + summed);
    }
    von_mises(span_of(sigma_), span_of(vm_));
    vm_ -= vm_truth_;
    lost_(k, q) = integral(vm_);
  }
}

ErrorCourse VonMisesCourse::result() const {
  ErrorCourse course{modes_, VectorXd::Zero(modes_.size()),
                     Eigen::MatrixXf::Zero(whole_.size(), modes_.size())};
  const double whole = whole_.sum();
  for (Index q = 0; q < modes_.size(); ++q) {
    if (whole > 0.0) course.pooled[q] = std::sqrt(lost_.col(q).sum() / whole);
    for (Index k = 0; k < whole_.size(); ++k) {
      if (whole_[k] > 0.0) {
        course.snapshots(k, q) = static_cast<float>(std::sqrt(lost_(k, q) / whole_[k]));
      }
    }
  }
  return course;
}

}  // namespace palpable
