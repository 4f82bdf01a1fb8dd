#include "palpable/bake/separate/coordinate_reduction.h"

#include "palpable/bake/separate/cp_als.h"
#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/separate/greedy_pgd.h"
#include "palpable/bake/separate/hosvd.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/common/base/contract.h"

#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool takes_parameters_together(ReductionMethod method) {
  return method == ReductionMethod::kPgd2 || method == ReductionMethod::kPod;
}

Separation separate(const SnapshotTensor& C, ReductionMethod method, const ReductionGoal& goal,
                    const Progress& progress, CoordinateReduction& result) {
  if (method == ReductionMethod::kPod) return pod(C, goal);
  if (method == ReductionMethod::kCp) return cp_als(C, goal, {}, progress);
  if (method == ReductionMethod::kHosvd) {
    const Tucker tucker = hosvd(C, goal.tolerance, HosvdOrder::kSequential);
    result.ranks = tucker.ranks();
    result.bound = tucker.bound;
    return {as_two_factors(tucker), {}, true};
  }
  return greedy_pgd(C, goal, {}, progress);
}

}  // namespace

MatrixXd CoordinateReduction::combination() const { return times(Q.combination, modes.F); }

VectorXd CoordinateReduction::left(const MatrixXd& gram) const {
  std::vector<int> sizes;
  for (const MatrixXd& G : modes.G) sizes.push_back(static_cast<int>(G.rows()));
  const MatrixXd own = Q.C * scale.asDiagonal();
  MatrixXd left = own;
  subtract_product(modes.F, parameter_products(modes.G, sizes), left);
  // The part that the coordinates leave out is orthogonal to the part that they represent.
  const VectorXd outside = gram.diagonal() - own.colwise().squaredNorm().transpose();
  return left.colwise().squaredNorm().transpose() + outside.cwiseMax(0.0);
}

MatrixXd CoordinateReduction::course(const MatrixXd& gram) const {
  const MatrixXd own = Q.C * scale.asDiagonal();
  MatrixXd course(modes.F.cols(), gram.cols());
  if (left_by_modes.size() > 0) {
    course = left_by_modes * scale.cwiseAbs2().asDiagonal();
  } else {
    std::vector<int> sizes;
    for (const MatrixXd& G : modes.G) sizes.push_back(static_cast<int>(G.rows()));
    const MatrixXd functions = parameter_products(modes.G, sizes);
    MatrixXd left = own;
    for (Index i = 0; i < course.rows(); ++i) {
      left.noalias() -= modes.F.col(i) * functions.col(i).transpose();
      course.row(i) = left.colwise().squaredNorm();
    }
  }
  const VectorXd outside = gram.diagonal() - own.colwise().squaredNorm().transpose();
  course.rowwise() += outside.cwiseMax(0.0).transpose();
  return course;
}

CoordinateReduction reduce_in_coordinates(const MatrixXd& gram, const std::vector<int>& sizes,
                                          const ReductionSettings& settings,
                                          const Progress& progress) {
  PALPABLE_EXPECT(settings.method != ReductionMethod::kPerSite, "a method for one tensor");
  PALPABLE_EXPECT(gram.rows() == snapshot_count(sizes), "a row for each snapshot");
  const Index K = gram.rows();
  const std::vector<int> axes =
      takes_parameters_together(settings.method) ? std::vector<int>{static_cast<int>(K)} : sizes;
  std::vector<VectorXd> scales;
  CoordinateReduction result;
  result.scale = VectorXd::Ones(K);
  if (settings.weight_snapshots) {
    scales = separated_norms(gram.diagonal().cwiseSqrt(), axes);
    result.scale =
        parameter_products(std::vector<MatrixXd>(scales.begin(), scales.end()), axes).col(0);
  }
  result.Q = pod_coordinates(gram, result.scale, kCoordinatesShare * settings.tolerance);
  // The error within the coordinates and the part that they leave out are orthogonal, so that their
  // squares add up.
  const double out = result.Q.lost * result.Q.lost, in = 1.0 - out;
  const ReductionGoal goal{std::sqrt((settings.tolerance * settings.tolerance - out) / in),
                           settings.max_modes};
  Separation separation = separate({result.Q.C, axes}, settings.method, goal, progress, result);
  result.reached = separation.reached;
  result.errors = (in * separation.errors.array().square() + out).sqrt();
  result.left_by_modes = std::move(separation.left);
  result.modes = std::move(separation.separated);
  if (settings.weight_snapshots) {
    if (result.modes.G.size() == 1) {
      result.modes.G[0] = result.scale.asDiagonal() * result.modes.G[0];
    } else {
      for (std::size_t j = 0; j < scales.size(); ++j) {
        result.modes.G[j] = scales[j].asDiagonal() * result.modes.G[j];
      }
    }
  }
  for (MatrixXd& G : result.modes.G) normalise(result.modes.F, G);
  return result;
}

ReductionSettings settings_of_one_site(const ReductionSettings& settings,
                                       const std::vector<int>& sizes) {
  ReductionSettings own = settings;
  own.method = sizes.size() == 2 ? ReductionMethod::kPod : ReductionMethod::kPgd;
  return own;
}

}  // namespace palpable
