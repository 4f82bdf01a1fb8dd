/// @file
/// Joins several bodies into one model, so that bodies in contact are solved together (contact.h,
/// `mutual`).
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/geometry/rigid.h"

#include <span>
#include <vector>

namespace palpable {

struct JoinedModel {
  SolidModel model;  ///< in the world frame
  /// (bodies + 1) each. Body b has the nodes first_node[b] .. first_node[b + 1] - 1, in its own
  /// order, and likewise the tetrahedra from first_tet[b] on.
  std::vector<int> first_node, first_tet;
};

/// Puts bodies beside each other without joining any of their nodes. Materials are isotropic, so a
/// rotation of a body does not change them.
/// @param world_from_body  one for each
/// @throws Error where 4-node and 10-node tetrahedra would mix, or where a rotated body has a
///         support that holds a node in some directions only: these would not be along x, y or z
[[nodiscard]] JoinedModel joined(std::span<const SolidModel> bodies,
                                 std::span<const Rigid3> world_from_body);

}  // namespace palpable
