/// @file
/// Third and fourth derivatives of a law's energy, for every law.
///
/// Indices a, b, c, d run over the nine entries of F, column by column as Eigen stores them.
#pragma once

#include "palpable/common/material/material.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>

namespace palpable {

/// Distinct entries of a symmetric tensor over nine indices: those with a <= b <= c (<= d), ordered
/// by a, then b, then c, then d.
struct EnergyTensors {
  std::array<double, 165> third;   ///< d3 Psi / dF_a dF_b dF_c, Pa
  std::array<double, 495> fourth;  ///< d4 Psi / dF_a dF_b dF_c dF_d, Pa
};

/// From the power series of the energy along sums and differences of unit directions (jet.h) by
/// polarisation: exact but for rounding.
/// @throws ContractViolation if J <= 0
[[nodiscard]] EnergyTensors energy_tensors(const Material& material, const Eigen::Matrix3d& F);

/// The same with all permutations: [81 a + 9 b + c], [729 a + 81 b + 9 c + d].
struct FullEnergyTensors {
  std::array<double, 729> third;
  std::array<double, 6561> fourth;
};
[[nodiscard]] FullEnergyTensors unfolded(const EnergyTensors& tensors);

}  // namespace palpable
