#include "palpable/live/track/pose_graph.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr int kMostSteps = 20;
constexpr int kMostTrials = 8;           // attempts at a step, each with more damping
constexpr double kConvergedCost = 1e-6;  // relative decrease of cost below which it has converged

// d log(exp(w) exp(phi)) / dw at w = 0 (Sola et al., "A micro Lie theory", 2018, Eq. 146).
Eigen::Matrix3d log_derivative(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  // For small angles the quotient loses all digits, and its series is used; the next term would be
  // angle^4 / 30,240.
  const double c =
      angle < 1e-3 ? 1.0 / 12 + angle * angle / 720
                   : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  const Eigen::Matrix3d P = cross_matrix(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * P + c * P * P;
}

double cost_of(const PoseGraph& graph) {
  double cost = 0;
  for (const PoseTie& tie : graph.ties) {
    const Twist r =
        residual_of(tie, graph.camera_from_world[tie.a], graph.camera_from_world[tie.b]).r;
    cost += r.head<3>().squaredNorm() / (tie.sigma_way * tie.sigma_way) +
            r.tail<3>().squaredNorm() / (tie.sigma_turn * tie.sigma_turn);
  }
  return cost;
}

}  // namespace

TieResidual residual_of(const PoseTie& tie, const Rigid3& a_from_world,
                        const Rigid3& b_from_world) {
  const Rigid3 E = tie.b_from_a * a_from_world * b_from_world.inverse(Eigen::Isometry);
  const Eigen::Vector3d t = E.translation();
  const Eigen::Matrix3d R = E.linear();
  const Eigen::AngleAxisd turn{Eigen::Quaterniond(R)};
  const Eigen::Vector3d phi = turn.angle() * turn.axis();

  TieResidual result;
  result.r << t, phi;
  // When a moves by s, E becomes exp(Ad(b_from_a) s) E; when b moves by s, E becomes E exp(-s).
  const Eigen::Matrix3d M = tie.b_from_a.linear();
  Eigen::Matrix<double, 6, 6> adjoint = Eigen::Matrix<double, 6, 6>::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = M;
  adjoint.topRightCorner<3, 3>() = cross_matrix(tie.b_from_a.translation()) * M;
  Eigen::Matrix<double, 6, 6> left = Eigen::Matrix<double, 6, 6>::Zero();
  left.topLeftCorner<3, 3>().setIdentity();
  left.topRightCorner<3, 3>() = -cross_matrix(t);
  left.bottomRightCorner<3, 3>() = log_derivative(phi);
  result.by_a = left * adjoint;
  result.by_b.setZero();
  result.by_b.topLeftCorner<3, 3>() = -R;
  result.by_b.bottomRightCorner<3, 3>() = -log_derivative(-phi);
  return result;
}

namespace {

// The normal equations A x = b of one Gauss-Newton step, with 6 unknowns for each pose except the
// first, which is fixed.
class NormalEquations {
 public:
  explicit NormalEquations(int poses) : poses_(poses), unknowns_(6 * (poses - 1)) {}

  void set_up(const PoseGraph& graph) {
    entries_.clear();
    b_ = Eigen::VectorXd::Zero(unknowns_);
    // With explicit zeros on the diagonal, a pose without ties makes the factorisation fail.
    for (int k = 1; k < poses_; ++k) add(k, k, Eigen::Matrix<double, 6, 6>::Zero());
    for (const PoseTie& tie : graph.ties) add(tie, graph);
    A_ = Sparse(unknowns_, unknowns_);
    A_.setFromTriplets(entries_.begin(), entries_.end());
    if (!analysed_) factor_.analyzePattern(A_);
    analysed_ = true;
  }

  // Levenberg and Marquardt: multiplies the diagonal by 1 + damping. False if that is singular.
  bool factorise(double damping) {
    Sparse damped = A_;
    for (Eigen::Index i = 0; i < unknowns_; ++i) damped.coeffRef(i, i) *= 1 + damping;
    factor_.factorize(damped);
    return factor_.info() == Eigen::Success;
  }
  [[nodiscard]] Eigen::VectorXd solve() const { return factor_.solve(b_); }

 private:
  using Sparse = Eigen::SparseMatrix<double>;

  void add(int row_pose, int column_pose, const Eigen::Matrix<double, 6, 6>& block) {
    if (row_pose == 0 || column_pose == 0) return;  // the first pose is fixed
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) {
        entries_.emplace_back(6 * (row_pose - 1) + i, 6 * (column_pose - 1) + j, block(i, j));
      }
    }
  }

  void add(const PoseTie& tie, const PoseGraph& graph) {
    const TieResidual residual =
        residual_of(tie, graph.camera_from_world[tie.a], graph.camera_from_world[tie.b]);
    Twist weight;
    weight << Eigen::Vector3d::Constant(1 / (tie.sigma_way * tie.sigma_way)),
        Eigen::Vector3d::Constant(1 / (tie.sigma_turn * tie.sigma_turn));
    const Eigen::Matrix<double, 6, 6> weighted_a = weight.asDiagonal() * residual.by_a;
    const Eigen::Matrix<double, 6, 6> weighted_b = weight.asDiagonal() * residual.by_b;
    add(tie.a, tie.a, residual.by_a.transpose() * weighted_a);
    add(tie.a, tie.b, residual.by_a.transpose() * weighted_b);
    add(tie.b, tie.a, residual.by_b.transpose() * weighted_a);
    add(tie.b, tie.b, residual.by_b.transpose() * weighted_b);
    if (tie.a > 0) b_.segment<6>(6 * (tie.a - 1)) -= weighted_a.transpose() * residual.r;
    if (tie.b > 0) b_.segment<6>(6 * (tie.b - 1)) -= weighted_b.transpose() * residual.r;
  }

  int poses_;
  Eigen::Index unknowns_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd b_;
  Sparse A_;
  Eigen::SimplicialLDLT<Sparse> factor_;
  bool analysed_ = false;
};

}  // namespace

PoseGraphResult adjust_pose_graph(PoseGraph& graph) {
  const int poses = static_cast<int>(graph.camera_from_world.size());
  for (const PoseTie& tie : graph.ties) {
    PALPABLE_EXPECT(std::min(tie.a, tie.b) >= 0 && std::max(tie.a, tie.b) < poses && tie.a != tie.b,
                    "a tie joins two poses");
    PALPABLE_EXPECT(tie.sigma_way > 0 && tie.sigma_turn > 0, "sigmas are positive");
  }
  PoseGraphResult result;
  result.first_cost = result.last_cost = cost_of(graph);
  if (poses < 2) return result;

  NormalEquations equations(poses);
  double damping = 1e-9;
  for (int step = 0; step < kMostSteps; ++step) {
    equations.set_up(graph);
    bool lowered = false;
    double cost = result.last_cost;
    for (int trial = 0; trial < kMostTrials && !lowered; ++trial) {
      if (!equations.factorise(damping)) {
        damping = std::max(10 * damping, 1e-6);
        continue;
      }
      const Eigen::VectorXd x = equations.solve();
      if (!x.allFinite()) return result;
      PoseGraph moved = graph;
      for (int k = 1; k < poses; ++k) {
        Rigid3& pose = moved.camera_from_world[k];
        pose = moved_by(x.segment<6>(6 * (k - 1)), pose);
      }
      cost = cost_of(moved);
      lowered = cost < result.last_cost;
      if (lowered) {
        graph.camera_from_world = std::move(moved.camera_from_world);
        damping = std::max(0.1 * damping, 1e-12);
      } else {
        damping = std::max(10 * damping, 1e-6);
        result.solved = true;  // the system was solvable; perhaps the cost is already minimal
      }
    }
    if (!lowered) return result;
    result.solved = true;
    ++result.steps;
    const bool converged = result.last_cost - cost < kConvergedCost * result.last_cost;
    result.last_cost = cost;
    if (converged) break;
  }
  return result;
}

}  // namespace palpable
