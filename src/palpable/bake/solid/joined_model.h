/// @file
/// Several bodies as one problem: what touches each other is solved together (contact.h, `mutual`).
#pragma once

#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/geometry/rigid.h"

#include <span>
#include <vector>

namespace palpable {

struct JoinedModel {
  SolidModel model;  ///< in the world frame
  /// (bodies + 1) nodes first_node[b] .. first_node[b + 1] - 1 are those of body b, in its order;
  /// likewise its tetrahedra.
  std::vector<int> first_node, first_tet;
};

/// Puts bodies beside each other without joining any of their nodes. Materials are isotropic, so
/// they stay what they are when a body turns.
/// @param world_from_body  one for each
/// @throws Error where 4-node and 10-node tetrahedra would mix, or a body that turns has a support
///         that holds some directions of a node only: its plane would not be one of x, y, z
[[nodiscard]] JoinedModel joined(std::span<const SolidModel> bodies,
                                 std::span<const Rigid3> world_from_body);

}  // namespace palpable
