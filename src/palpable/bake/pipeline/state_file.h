/// @file
/// A solved state of a body as a grid for ParaView.
#pragma once

#include "palpable/bake/exchange/vtu_file.h"
#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <filesystem>

namespace palpable {

/// Writes displacement, Cauchy stress at the nodes, its von Mises and principal values, and the
/// forces that act.
/// @param displacement  (3 x N) m
/// @param forces        (3 x N) N, with the name that they get in the file
/// @return the largest von Mises stress, Pa
/// @throws Error if an element is inverted, or the file cannot be written
double write_state_file(const std::filesystem::path& file, const SolidModel& model,
                        const Eigen::Matrix3Xd& displacement, const VtuField& forces);

}  // namespace palpable
