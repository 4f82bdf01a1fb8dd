/// @file
/// What a body file holds for a body whose energy is known in some modes (SeveralLoads) to be
/// touched anywhere: the modes at the nodes of its shell, for the stress, and how its skin gives
/// way under a point, which the modes do not know.
///
///   V  vertices of the skin     W  nodes of its shell (shell_table.h)     n  modes
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/shell_table.h"

#include <Eigen/Core>

#include <cstddef>
#include <string>

namespace palpable {

struct ModalTables {
  ShellTable shell;
  Eigen::MatrixXf inner_modes;  ///< (3 (W - V) x n) m: what the shell's inner nodes do
  /// 1/Pa, (1 - nu^2) / E of the law at rest: a half space gives way by 0.54 times that, times the
  /// force, over the radius of a disc that is pressed (its mean; Johnson, Contact Mechanics, 3.4).
  double half_space = 0;
  double point_spacing = 0.003;  ///< m, of contact points
};

[[nodiscard]] std::size_t bytes_of(const ModalTables& tables);

/// Why tables cannot be those of a body; empty if they can.
[[nodiscard]] std::string trouble_of(const ModalTables& tables, const ReducedBody& body);

/// Every length times `s`, as scaled_body.h has it.
[[nodiscard]] ModalTables scaled(const ModalTables& tables, double s);

}  // namespace palpable
