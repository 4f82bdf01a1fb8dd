#include "palpable/common/response/refinement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// Largest s: a larger load is corrected like that of 1.5 f_0. s^2 was found to hold up to 2.
constexpr float kLargestRatio = 1.5f;
// Largest correction (L2 over the skin's vertices), as a ratio to the full-order solution. A larger
// one belongs to a load that the body does not bear without the obstacle that holds it, such as one
// beyond a snap; it would not help.
constexpr float kMostCorrection = 0.3f;
// Largest difference (L2) of a probe's full-order solution from its linear response, as a ratio to
// the latter, for the two to be of the same body.
constexpr float kSameBody = 0.1f;
constexpr int kProbes = 24;           // forces of a probe, at most
constexpr float kProbeMoves = 1e-4f;  // m, the largest displacement by a probe

}  // namespace

float correction_weight(float work, float shared, float solved) {
  if (!(work > 0) || !(shared > 0) || !(solved > 0)) return 0;
  const float s = std::min(shared / solved, kLargestRatio);
  const float k = std::min(1.0f, shared / work * (shared / solved));
  return s * s * k * k * k * k;
}

std::array<float, 2> Refinement::weights_under(std::span<const VertexForce> loads,
                                               const Eigen::Ref<const Matrix3Xf>& at_loads) const {
  std::array<float, 2> found{};
  if (!acts()) return found;
  float work = 0;
  std::array<float, 2> shared{};
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Vector3f& f = loads[i].force;
    work += f.dot(at_loads.col(static_cast<Eigen::Index>(i)));
    for (std::size_t k = 0; k < shared.size(); ++k) {
      const ExactCorrection& c = corrections[k];
      if (c.work > 0) shared[k] += f.dot(c.linear.col(loads[i].vertex));
    }
  }
  const std::array share{1 - blended, blended};
  for (std::size_t k = 0; k < shared.size(); ++k) {
    found[k] = share[k] * correction_weight(work, shared[k], corrections[k].work);
  }
  return found;
}

bool Refinement::take_up(const RequestedLoad& load, const Matrix3Xf& exact) {
  const Eigen::Index V = load.linear.cols();
  const float off = (exact - load.tables).leftCols(V).norm();
  if (!(off <= kMostCorrection * exact.leftCols(V).norm())) return false;
  std::swap(corrections[0], corrections[1]);
  std::swap(weights[0], weights[1]);
  ExactCorrection& c = corrections[1];
  c.field = exact - load.tables;
  c.linear = load.linear;
  c.work = 0;
  for (const VertexForce& f : load.forces) c.work += f.force.dot(c.linear.col(f.vertex));
  weights[1] = 0;
  blended = 0;
  return true;
}

void add_up_by_vertex(std::vector<VertexForce>& forces) {
  std::sort(forces.begin(), forces.end(),
            [](const VertexForce& a, const VertexForce& b) { return a.vertex < b.vertex; });
  std::size_t kept = 0;
  for (std::size_t k = 1; k < forces.size(); ++k) {
    if (forces[k].vertex == forces[kept].vertex) {
      forces[kept].force += forces[k].force;
    } else {
      forces[++kept] = forces[k];
    }
  }
  forces.resize(kept + 1);
}

void make_probe(LinearField& field, int vertices, int nodes, RequestedLoad& probe) {
  probe.forces.clear();
  for (int k = 0; k < kProbes; ++k) {
    const int v = vertices * k / kProbes;
    if (!probe.forces.empty() && probe.forces.back().vertex == v) continue;
    probe.forces.push_back({v, Vector3f(0, 0, k % 2 == 0 ? -1.0f : -0.5f)});
  }
  probe.tables.resize(3, nodes);
  field.fill(probe.forces, probe.tables);
  const float largest =
      std::sqrt(probe.tables.leftCols(vertices).colwise().squaredNorm().maxCoeff());
  if (!(largest > 0)) return;
  const float share = kProbeMoves / largest;
  for (VertexForce& f : probe.forces) f.force *= share;
  probe.tables *= share;
  probe.linear = probe.tables.leftCols(vertices);
}

bool is_of_probed_body(const RequestedLoad& probe, const Matrix3Xf& exact) {
  const Eigen::Index V = probe.linear.cols();
  return exact.cols() == probe.tables.cols() &&
         (exact.leftCols(V) - probe.linear).norm() <= kSameBody * probe.linear.norm();
}

}  // namespace palpable
