/// @file
/// The laws a body may be made of, and how they are named in a body file.
#pragma once

#include "palpable/solid/mooney_rivlin.h"
#include "palpable/solid/neo_hookean.h"
#include "palpable/solid/neo_hookean_abaqus.h"
#include "palpable/solid/saint_venant_kirchhoff.h"

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace palpable {

/// One homogeneous material. Every law has energy_density, first_piola and tangent.
using Material = std::variant<NeoHookean, SaintVenantKirchhoff, NeoHookeanAbaqus, MooneyRivlin>;

/// The law `law` with Young's modulus E and Poisson's ratio nu at small strains:
/// mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu) (1 - 2 nu)).
///
/// Mooney-Rivlin has one constant more: C2 = C1 / 4, as filled rubbers have it, or less where nu is
/// so small (below 0.14) that D1 would turn negative.
/// @param law  one of law_names()
/// @param E    Pa, > 0
/// @param nu   0 <= nu < 0.5; linear tetrahedra lock as nu nears 0.5 (10 % too stiff at 0.45)
/// @throws Error for an unknown law or values out of range
[[nodiscard]] Material material_from_young(std::string_view law, double E, double nu);

/// "neo-hookean", "saint-venant-kirchhoff", "neo-hooke-abaqus" and "mooney-rivlin".
[[nodiscard]] const std::vector<std::string>& law_names();

/// The law's name as in law_names().
[[nodiscard]] std::string law_name(const Material& material);

/// Small-strain constants, Pa.
struct LameConstants {
  double lambda;
  double mu;
};
[[nodiscard]] LameConstants lame_constants(const Material& material);

/// @throws Error unless the constants are finite, mu > 0 and lambda >= 0 (and, for Mooney-Rivlin,
/// each of its constants is >= 0)
void check_material(const Material& material);

[[nodiscard]] double energy_density(const Material& material, const Eigen::Matrix3d& F);
[[nodiscard]] Eigen::Matrix3d first_piola(const Material& material, const Eigen::Matrix3d& F);
[[nodiscard]] Tangent tangent(const Material& material, const Eigen::Matrix3d& F);

}  // namespace palpable
