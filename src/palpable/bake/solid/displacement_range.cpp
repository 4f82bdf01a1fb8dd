#include "palpable/bake/solid/displacement_range.h"

#include <fmt/core.h>

#include <algorithm>

namespace palpable {

namespace {

// An element this much larger than at rest, not a compressed one, explains a loss of stiffness. Of
// bodies that are pressed, elements beside the patch expand by some per cent.
constexpr double kExpanded = 1.5;

// m: what all held components of this direction move by; 0 where they differ, or there are none.
double shared_movement(std::span<const HeldComponent> held, const Eigen::Matrix3Xd& u,
                       int direction) {
  const HeldComponent* first = nullptr;
  for (const HeldComponent& h : held) {
    if (h.at % 3 != direction) continue;
    if (first == nullptr) first = &h;
    if (h.displacement != first->displacement) return 0.0;
  }
  // By its state, not by `displacement`, which is that of level 1.
  return first == nullptr ? 0.0 : u.reshaped()[first->at];
}

}  // namespace

double largest_movement(std::span<const HeldComponent> held, const Eigen::Matrix3Xd& u) {
  Eigen::Vector3d shared;
  for (int i = 0; i < 3; ++i) shared[i] = shared_movement(held, u, i);
  return (u.colwise() - shared).colwise().norm().maxCoeff();
}

std::string beyond_range_text(double range) {
  return fmt::format(
      "a node would move by more than {:.4g} mm, the range of the model ('range' in [press]): "
      "look at the units of the loads and of Young's modulus, press less, or give a larger range",
      1e3 * range);
}

double largest_volume_ratio(const TetMesh& mesh, const Eigen::Matrix3Xd& u) {
  TetMesh corners{mesh.nodes, mesh.tets, {}};
  const Eigen::VectorXd before = tet_volumes(corners);
  corners.nodes += u;
  return (tet_volumes(corners).array() / before.array()).maxCoeff();
}

std::optional<std::string> expansion_text(const TetMesh& mesh, const Eigen::Matrix3Xd& u) {
  const double J = largest_volume_ratio(mesh, u);
  if (J < kExpanded) return std::nullopt;
  return fmt::format(
      "the body loses its stiffness there: an element has expanded to J = {:.3g} times its "
      "volume, and (ln J)^2 of the law softens towards J = 2.7; pull less",
      J);
}

}  // namespace palpable
