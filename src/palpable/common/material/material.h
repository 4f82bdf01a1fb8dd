/// @file
/// The available laws of hyperelasticity, and their names in a body file.
#pragma once

#include "palpable/common/material/mooney_rivlin.h"
#include "palpable/common/material/neo_hookean.h"
#include "palpable/common/material/neo_hookean_abaqus.h"
#include "palpable/common/material/saint_venant_kirchhoff.h"

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace palpable {

/// One homogeneous material. The alternatives are all available laws; each law is one file (law.h
/// describes how to write it) and one entry here.
using Material = std::variant<NeoHookean, SaintVenantKirchhoff, NeoHookeanAbaqus, MooneyRivlin>;

/// The material of this law that has Young's modulus E and Poisson's ratio nu at small strains:
/// mu = E / (2 (1 + nu)), lambda = E nu / ((1 + nu) (1 - 2 nu)).
///
/// A law with more than two constants chooses the others itself (MooneyRivlin::from_lame).
/// @param law  one of law_names()
/// @param E    Pa, > 0
/// @param nu   0 <= nu < 0.5; linear tetrahedra lock as nu nears 0.5 (10 % too stiff at 0.45)
/// @throws Error for an unknown law or values out of range
[[nodiscard]] Material material_from_young(std::string_view law, double E, double nu);

/// "neo-hookean", "saint-venant-kirchhoff", "neo-hooke-abaqus" and "mooney-rivlin".
[[nodiscard]] const std::vector<std::string>& law_names();

/// The law's name as in law_names().
[[nodiscard]] std::string law_name(const Material& material);

/// The law's own constants, in the order in which material_from_constants() takes them.
/// @throws Error for an unknown law
[[nodiscard]] std::span<const LawConstant> law_constants(std::string_view law);

/// The values of a material's constants, in the order of law_constants(), SI.
[[nodiscard]] std::vector<double> constants_of(const Material& material);

/// @param values  SI, one for each of law_constants(law)
/// @throws Error for an unknown law, and as check_material()
[[nodiscard]] Material material_from_constants(std::string_view law,
                                               std::span<const double> values);

/// Lame's constants of the material at small strains.
[[nodiscard]] LameConstants lame_constants(const Material& material);

/// Young's modulus (Pa) and Poisson's ratio at small strains.
struct YoungPoisson {
  double young, poisson;
};
/// Young's modulus and Poisson's ratio of the material at small strains.
[[nodiscard]] YoungPoisson young_poisson(const Material& material);

/// Poisson's ratio with as few digits as tell it and its distance from 0.5: "0.4", "0.49999".
[[nodiscard]] std::string poisson_text(double poisson);

/// Young's modulus with a thing of that stiffness: "6e+04 Pa, as of rubber". For messages about
/// loads, where a wrong unit is the likely cause.
[[nodiscard]] std::string stiffness_text(double young);

/// Young's modulus of diamond, Pa: nothing is stiffer.
inline constexpr double kStiffest = 1.2e12;

/// @throws Error if a constant is negative or not finite, if one is 0 that must not be
/// (LawConstant::may_be_zero), if mu <= 0 or if lambda < 0
void check_material(const Material& material);

/// Psi(F) J/m^3, P(F) Pa and dP/dF Pa of the material's law; units, layout and errors as in law.h.
[[nodiscard]] double energy_density(const Material& material, const Eigen::Matrix3d& F);
[[nodiscard]] Eigen::Matrix3d first_piola(const Material& material, const Eigen::Matrix3d& F);
[[nodiscard]] Tangent tangent(const Material& material, const Eigen::Matrix3d& F);

}  // namespace palpable
