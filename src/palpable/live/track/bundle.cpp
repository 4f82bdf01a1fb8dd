#include "palpable/live/track/bundle.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

constexpr double kNearest = 1e-3;  // m; points with a smaller Z are left out
constexpr double kFirstDamping = 1e-4;
constexpr double kLargestDamping = 1e6;
// Added to the diagonal of a point's 3 x 3 block, 1/m^2, as if its position were known to 1 km.
// Without it, the block of a point that was seen once and without disparity is singular.
constexpr double kPrior = 1e-6;
// Share of the disparities' information on their error that must remain after the elimination;
// less may be rounding.
constexpr double kLeastInformation = 1e-9;

using Matrix63 = Eigen::Matrix<double, 6, 3>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// A sighting's term of the normal equations that couples its pose and its point.
struct Term {
  int free = -1;  // index among the free poses; -1: its pose is fixed, or it is left out
  Matrix63 W = Matrix63::Zero();
};

class Adjuster {
 public:
  Adjuster(BundleProblem& problem, const BundleSettings& settings)
      : p_(problem), settings_(settings), free_of_(problem.fixed.size(), -1) {
    for (std::size_t i = 0; i < p_.fixed.size(); ++i) {
      if (p_.fixed[i] == 0) free_of_[i] = free_count_++;
    }
    terms_.resize(p_.sightings.size());
    begin_.assign(p_.x_in_world.size() + 1, 0);
    for (const BundleSighting& s : p_.sightings) ++begin_[s.point + 1];
    for (std::size_t j = 1; j < begin_.size(); ++j) begin_[j] += begin_[j - 1];
    point_H_.resize(p_.x_in_world.size());
    point_b_.resize(p_.x_in_world.size());
  }

  BundleResult run() {
    BundleResult result;
    double cost = cost_of(p_.camera_from_world, p_.x_in_world);
    result.first_cost = result.last_cost = cost;
    double damping = kFirstDamping;
    for (int step = 0; step < settings_.steps && damping < kLargestDamping; ++step) {
      linearise();
      bool lower = false;
      while (!lower && damping < kLargestDamping) {
        const double candidate = try_step(damping);
        lower = candidate < cost;
        if (!lower) {
          damping *= 8;
          continue;
        }
        const double decrease = (cost - candidate) / cost;
        p_.camera_from_world.swap(new_poses_);
        p_.x_in_world.swap(new_points_);
        cost = candidate;
        damping = std::max(damping / 8, 1e-9);
        ++result.steps;
        if (decrease < settings_.converged) step = settings_.steps;
      }
    }
    result.last_cost = cost;
    if (settings_.measure_disparity_error) measure_disparity_error(result);
    return result;
  }

 private:
  [[nodiscard]] double rho(double squared) const {
    const double c2 = settings_.cauchy * settings_.cauchy;
    return 0.5 * c2 * std::log1p(squared / c2);
  }
  [[nodiscard]] double weight(double squared) const {
    return 1 / (1 + squared / (settings_.cauchy * settings_.cauchy));
  }

  [[nodiscard]] double cost_of(const std::vector<Rigid3>& poses,
                               const std::vector<Eigen::Vector3d>& points) const {
    double cost = 0;
    for (const BundleSighting& s : p_.sightings) {
      const Eigen::Vector3d x = poses[s.pose] * points[s.point];
      if (x.z() < kNearest) {
        cost += rho(1e4);
        continue;
      }
      const Eigen::Vector3d r = p_.camera.see(x) - s.seen.uvd;
      cost += rho(r.head<2>().squaredNorm() / (s.seen.sigma * s.seen.sigma));
      if (s.seen.has_disparity()) {
        cost += rho(r.z() * r.z() / (s.seen.sigma_d * s.seen.sigma_d));
      }
    }
    return cost;
  }

  void linearise() {
    pose_H_.assign(free_count_, Matrix6::Zero());
    pose_b_.assign(free_count_, Twist::Zero());
    std::fill(point_H_.begin(), point_H_.end(),
              Eigen::Matrix3d(kPrior * Eigen::Matrix3d::Identity()));
    std::fill(point_b_.begin(), point_b_.end(), Eigen::Vector3d(Eigen::Vector3d::Zero()));
    for (std::size_t k = 0; k < p_.sightings.size(); ++k) {
      const BundleSighting& s = p_.sightings[k];
      const int i = s.pose, j = s.point;
      Term& term = terms_[k];
      term.free = -1;
      const Rigid3& pose = p_.camera_from_world[i];
      const Eigen::Vector3d x = pose * p_.x_in_world[j];
      if (x.z() < kNearest) continue;
      const Eigen::Vector3d r = p_.camera.see(x) - s.seen.uvd;
      const double s2 = s.seen.sigma * s.seen.sigma;
      const double uv = weight(r.head<2>().squaredNorm() / s2) / s2;
      Eigen::Vector3d w(uv, uv, 0);
      if (s.seen.has_disparity()) {
        const double sd2 = s.seen.sigma_d * s.seen.sigma_d;
        w.z() = weight(r.z() * r.z() / sd2) / sd2;
      }
      const Eigen::Vector3d rw = w.z() > 0 ? Eigen::Vector3d(w.cwiseProduct(r))
                                           : Eigen::Vector3d(w.x() * r.x(), w.y() * r.y(), 0);
      const Eigen::Matrix3d D = p_.camera.derivative(x);
      const Eigen::Matrix3d J_point = D * pose.linear();
      const Eigen::Matrix3d weighted = w.asDiagonal() * J_point;
      point_H_[j].noalias() += J_point.transpose() * weighted;
      point_b_[j].noalias() += J_point.transpose() * rw;
      const int f = free_of_[i];
      if (f < 0) continue;
      const Eigen::Matrix<double, 3, 6> J_pose = pose_derivative(D, x);
      pose_H_[f].noalias() += J_pose.transpose() * w.asDiagonal() * J_pose;
      pose_b_[f].noalias() += J_pose.transpose() * rw;
      term.free = f;
      term.W.noalias() = J_pose.transpose() * weighted;
    }
  }

  // Eliminates the points from the normal equations:  S_ (steps of the free poses) = g_.
  void eliminate_points(double damping) {
    const Eigen::Index n = 6 * free_count_;
    S_.setZero(n, n);
    g_.setZero(n);
    for (int f = 0; f < free_count_; ++f) {
      Matrix6 H = pose_H_[f];
      H.diagonal() *= 1 + damping;
      S_.block<6, 6>(6 * f, 6 * f) = H;
      g_.segment<6>(6 * f) = -pose_b_[f];
    }
    inverse_.resize(p_.x_in_world.size());
    for (std::size_t j = 0; j < p_.x_in_world.size(); ++j) {
      Eigen::Matrix3d H = point_H_[j];
      H.diagonal() *= 1 + damping;
      inverse_[j] = H.inverse();
      for (std::size_t a = begin_[j]; a < begin_[j + 1]; ++a) {
        if (terms_[a].free < 0) continue;
        // S_ab -= W_a H^-1 W_b^T,   g_a += W_a H^-1 b
        const Matrix63 WH = terms_[a].W * inverse_[j];
        g_.segment<6>(6 * terms_[a].free).noalias() += WH * point_b_[j];
        for (std::size_t b = begin_[j]; b < begin_[j + 1]; ++b) {
          if (terms_[b].free < 0 || terms_[b].free > terms_[a].free) continue;
          S_.block<6, 6>(6 * terms_[a].free, 6 * terms_[b].free).noalias() -=
              WH * terms_[b].W.transpose();
        }
      }
    }
  }

  // Solves the normal equations with `damping`, and fills new_poses_ and new_points_.
  // @return their cost
  double try_step(double damping) {
    eliminate_points(damping);
    const Eigen::Index n = 6 * free_count_;
    Eigen::VectorXd steps = Eigen::VectorXd::Zero(n);
    if (n > 0) steps = S_.selfadjointView<Eigen::Lower>().ldlt().solve(g_);
    if (!steps.allFinite()) return std::numeric_limits<double>::infinity();

    new_poses_ = p_.camera_from_world;
    for (std::size_t i = 0; i < free_of_.size(); ++i) {
      if (free_of_[i] < 0) continue;
      new_poses_[i] = moved_by(steps.segment<6>(6 * free_of_[i]), p_.camera_from_world[i]);
    }
    new_points_ = p_.x_in_world;
    for (std::size_t j = 0; j < p_.x_in_world.size(); ++j) {
      Eigen::Vector3d rhs = -point_b_[j];
      for (std::size_t a = begin_[j]; a < begin_[j + 1]; ++a) {
        if (terms_[a].free < 0) continue;
        rhs.noalias() -= terms_[a].W.transpose() * steps.segment<6>(6 * terms_[a].free);
      }
      new_points_[j] += inverse_[j] * rhs;
    }
    return cost_of(new_poses_, new_points_);
  }

  // The disparity error e as one more unknown, with the points and then the poses eliminated:
  //
  //     h e = -b,   h = sum w - sum v^T H^-1 v - c^T S^-1 c,   and b alike from the residuals,
  //
  // with v the coupling of e to a point, c that to the free poses. Where depths and motion leave e
  // undetermined (a camera that stands), h is 0 up to rounding.
  void measure_disparity_error(BundleResult& result) {
    linearise();
    eliminate_points(0);
    Eigen::VectorXd c = Eigen::VectorXd::Zero(6 * free_count_);
    double all = 0, h = 0, b = 0;
    for (std::size_t j = 0; j < p_.x_in_world.size(); ++j) {
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      for (std::size_t k = begin_[j]; k < begin_[j + 1]; ++k) {
        const BundleSighting& s = p_.sightings[k];
        const Eigen::Vector3d x = p_.camera_from_world[s.pose] * p_.x_in_world[j];
        if (x.z() < kNearest || !s.seen.has_disparity()) continue;
        const double r = p_.camera.disparity_at(x.z()) - s.seen.uvd.z();
        const double s2 = s.seen.sigma_d * s.seen.sigma_d;
        const double w = weight(r * r / s2) / s2;
        const Eigen::Matrix3d D = p_.camera.derivative(x);
        v += w * (D.row(2) * p_.camera_from_world[s.pose].linear()).transpose();
        if (terms_[k].free >= 0) {
          c.segment<6>(6 * terms_[k].free) += w * pose_derivative(D, x).row(2).transpose();
        }
        all += w;
        b += w * r;
      }
      const Eigen::Vector3d Hv = inverse_[j] * v;
      h -= v.dot(Hv);
      b -= point_b_[j].dot(Hv);
      for (std::size_t k = begin_[j]; k < begin_[j + 1]; ++k) {
        if (terms_[k].free >= 0) c.segment<6>(6 * terms_[k].free) -= terms_[k].W * Hv;
      }
    }
    h += all;
    if (free_count_ > 0) {
      const Eigen::VectorXd solved = S_.selfadjointView<Eigen::Lower>().ldlt().solve(c);
      h -= c.dot(solved);
      b += g_.dot(solved);
    }
    if (!(h > kLeastInformation * all) || !std::isfinite(b)) return;
    result.disparity_error_px = p_.camera.disparity_error_px - b / h;
    result.disparity_information = h;
  }

  BundleProblem& p_;
  BundleSettings settings_;
  std::vector<int> free_of_;
  int free_count_ = 0;
  std::vector<std::size_t> begin_;  // (L + 1) index of each point's first sighting
  std::vector<Term> terms_;         // (M)
  std::vector<Matrix6> pose_H_;
  std::vector<Twist> pose_b_;
  std::vector<Eigen::Matrix3d> point_H_;
  std::vector<Eigen::Vector3d> point_b_;
  std::vector<Eigen::Matrix3d> inverse_;
  Eigen::MatrixXd S_;
  Eigen::VectorXd g_;
  std::vector<Rigid3> new_poses_;
  std::vector<Eigen::Vector3d> new_points_;
};

}  // namespace

double squared_residual(const BundleProblem& problem, const BundleSighting& sighting) {
  const Eigen::Vector3d x =
      problem.camera_from_world[sighting.pose] * problem.x_in_world[sighting.point];
  if (x.z() < kNearest) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d r = (problem.camera.see(x) - sighting.seen.uvd).head<2>();
  return r.squaredNorm() / (sighting.seen.sigma * sighting.seen.sigma);
}

BundleResult adjust_bundle(BundleProblem& problem, const BundleSettings& settings) {
  const auto P = static_cast<int>(problem.camera_from_world.size());
  const auto L = static_cast<int>(problem.x_in_world.size());
  PALPABLE_EXPECT(problem.fixed.size() == problem.camera_from_world.size(),
                  "one flag for every pose");
  int previous = 0;
  for (const BundleSighting& s : problem.sightings) {
    PALPABLE_EXPECT(s.pose >= 0 && s.pose < P && s.point >= previous && s.point < L,
                    "sightings refer to existing poses and points, sorted by point");
    previous = s.point;
  }
  return Adjuster(problem, settings).run();
}

}  // namespace palpable
