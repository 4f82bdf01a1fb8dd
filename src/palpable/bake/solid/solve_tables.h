/// @file
/// Tables of the convergence of a solve, for people to read.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/equilibrium.h"

#include <Eigen/Core>

#include <string>

namespace palpable {

/// A heading, a row for each Newton step with the residual before it, and one for each state that
/// was found. The press is sum(unit_load . (u - rest)), see PressGoal.
/// @param unit_load, rest  (3 x N) N and m
[[nodiscard]] std::string path_table(const PathResult& path, const Eigen::Matrix3Xd& unit_load,
                                     const Eigen::Matrix3Xd& rest);

/// The heading of contact_row(): a line of its own.
[[nodiscard]] std::string contact_heading();

/// One row: the time t of the obstacle, its force, and how well the conditions of contact.h hold.
[[nodiscard]] std::string contact_row(const ContactState& state);

}  // namespace palpable
