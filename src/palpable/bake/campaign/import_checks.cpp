#include "palpable/bake/campaign/import_checks.h"

#include "palpable/bake/solid/displacement_range.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;

// Ratio to the largest displacement by which a held node may move. Solvers that hold nodes by
// springs or penalties let them move by a thousandth or so; in a wrong order of nodes some held
// node moves about as far as any.
constexpr double kHeldMoves = 0.05;

// Ratio between imported stress and that of the law from which a unit must be wrong. Recovery at
// the nodes and another element give tens of per cent.
constexpr double kFarStress = 3.0;

// Norm of the difference of deviators, ratio to that of the law's, from which components must be in
// another order. On a bar of 2 x 2 x 6 cubes that bends, right ones differ by 0.38, and those in
// the order xx xy zx yy yz zz by 1.4.
constexpr double kOtherStress = 0.9;

StressField deviators(StressField stress) {
  const Eigen::RowVectorXd mean = stress.topRows(3).colwise().mean();
  stress.topRows(3).rowwise() -= mean;
  return stress;
}

// (6 x E) The mean over the corners of each element.
StressField mean_of_corners(const TetMesh& mesh, const StressField& at_nodes) {
  StressField means(6, mesh.tet_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    means.col(e) = 0.25 * (at_nodes.col(mesh.tets(0, e)) + at_nodes.col(mesh.tets(1, e)) +
                           at_nodes.col(mesh.tets(2, e)) + at_nodes.col(mesh.tets(3, e)));
  }
  return means;
}

// sqrt(int 3/2 s : s dV / V), Pa. @param s  (6 x E) deviators
double mean_von_mises(const StressField& s, const Eigen::VectorXd& volumes) {
  const Eigen::ArrayXd squares = s.topRows(3).colwise().squaredNorm().transpose().array() +
                                 2.0 * s.bottomRows(3).colwise().squaredNorm().transpose().array();
  return std::sqrt(1.5 * (squares * volumes.array()).sum() / volumes.sum());
}

}  // namespace

void refuse_moved_support(std::span<const HeldComponent> held, const Matrix3Xd& u,
                          std::span<const std::int64_t> numbers, const std::string& place) {
  const double largest = u.colwise().norm().maxCoeff();
  const HeldComponent* worst = nullptr;
  for (const HeldComponent& h : held) {
    if (h.displacement != 0.0) continue;
    const double moved = std::abs(u.reshaped()[h.at]);
    if (moved <= kHeldMoves * largest) continue;
    if (worst == nullptr || moved > std::abs(u.reshaped()[worst->at])) worst = &h;
  }
  if (worst == nullptr) return;
  const auto node = static_cast<std::size_t>(worst->at / 3);
  throw Error(fmt::format(
      "{}: node {} is held by the support and moves by {:.4g} mm along {}, where the largest "
      "displacement is {:.4g} mm: are the rows in the order of the mesh's nodes, the components x "
      "y "
      "z of one node beside each other, and is it the support of this body?",
      place, numbers[node], 1e3 * std::abs(u.reshaped()[worst->at]), "xyz"[worst->at % 3],
      1e3 * largest));
}

void refuse_far_displacement(std::span<const HeldComponent> held, const Matrix3Xd& u, double range,
                             const std::string& place) {
  const double largest = largest_movement(held, u);
  if (largest <= range) return;
  throw Error(fmt::format(
      "{}: a node moves by {:.4g} mm, more than {:.4g} mm, the range of the model: write the unit "
      "of displacement in its [[field]] ('unit', metres without it), or a larger 'range' in "
      "[press] "
      "of the body",
      place, 1e3 * largest, 1e3 * range));
}

StressJudgement judge_stress(const SolidModel& model, const Matrix3Xd& u,
                             const StressField& stress) {
  StressField computed;
  try {
    computed = element_cauchy_stress(model, u);
  } catch (const Error& error) {
    return {fmt::format("stress was not judged: under the imported displacement {}", error.what()),
            true};
  }
  const Eigen::VectorXd volumes = tet_volumes(model.mesh);
  const StressField law = deviators(std::move(computed));
  const StressField given = deviators(mean_of_corners(model.mesh, stress));
  const double of_law = mean_von_mises(law, volumes), of_file = mean_von_mises(given, volumes);
  const double difference = mean_von_mises(given - law, volumes);
  const std::string both = fmt::format(
      "von Mises stress is {:.3g} Pa (mean over the body), and the law gives {:.3g} Pa at the "
      "imported displacement",
      of_file, of_law);
  if (!(of_file <= kFarStress * of_law && kFarStress * of_file >= of_law)) {
    return {
        both +
            ": is the unit of stress written in its [[field]], are its components in the order xx "
            "yy zz xy yz zx, and is Young's modulus that of the other solver?",
        true};
  }
  if (difference > kOtherStress * of_law) {
    return {both + fmt::format(", but the tensors differ by {:.3g} Pa: are the components in the "
                               "order xx yy zz xy yz zx?",
                               difference),
            true};
  }
  return {both, false};
}

}  // namespace palpable
