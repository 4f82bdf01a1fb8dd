/// @file
/// The range of displacements in which a model means anything. Far beyond it an element solution
/// still converges, but no real body is deformed like that: most such loads come from a wrong unit.
///
///   N  nodes     u  displacement from the unloaded body, (3 x N) m
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>

namespace palpable {

/// m: the largest displacement of a node. In each direction in which all held components move by
/// the same length, that length is subtracted first: it moves the body as a whole.
[[nodiscard]] double largest_movement(std::span<const HeldComponent> held,
                                      const Eigen::Matrix3Xd& u);

/// One line for people: what a state beyond SolidModel::largest_displacement means, and the remedy.
/// @param range  m
[[nodiscard]] std::string beyond_range_text(double range);

/// The largest ratio of an element's volume to its undeformed volume, of its corners.
[[nodiscard]] double largest_volume_ratio(const TetMesh& mesh, const Eigen::Matrix3Xd& u);

/// Why a body that is pulled loses its stiffness, with J; nothing where no element has expanded so
/// far that this explains it.
[[nodiscard]] std::optional<std::string> expansion_text(const TetMesh& mesh,
                                                        const Eigen::Matrix3Xd& u);

}  // namespace palpable
