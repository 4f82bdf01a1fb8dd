/// @file
/// What a body file stores so that a body whose energy is known in some modes (SeveralLoads) can be
/// touched anywhere: the modes at the nodes of its shell, for the stress, and the local compliance
/// of its skin under a point, which the modes are too smooth to hold.
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
  Eigen::MatrixXf inner_modes;  ///< (3 (W - V) x n) m, at the shell's inner nodes
  /// 1/Pa, (1 - nu^2) / E of the law at rest. A disc of radius a that is pressed evenly by a force
  /// f moves by 0.54 half_space f / a (its mean; Johnson, Contact Mechanics, 3.4).
  double half_space = 0;
  double point_spacing = 0.003;  ///< m, between contact points
  double friction = 0;           ///< as TouchTables::friction
};

[[nodiscard]] std::size_t bytes_of(const ModalTables& tables);

/// Why the tables cannot belong to a body; empty if they can.
[[nodiscard]] std::string trouble_of(const ModalTables& tables, const ReducedBody& body);

/// The tables of the body with every length multiplied by `s`, as scaled(ReducedBody) does.
[[nodiscard]] ModalTables scaled(const ModalTables& tables, double s);

}  // namespace palpable
