/// @file
/// A model and its load as an input deck of CalculiX.
///
///   N  nodes
///   level  factor of the full load, as in solid/equilibrium.h
///
/// One deck, one *STEP with NLGEOM, results printed at the levels only. CalculiX' laws under
/// NLGEOM: *ELASTIC is St. Venant-Kirchhoff, *HYPERELASTIC, NEO HOOKE is NeoHookeanAbaqus (compared
/// with the closed forms in tests/verification). It has no law like eq. (7).
///
/// ccx 2.20 has two absolute thresholds, so the units of a deck matter. (1) A residual below 1e-6
/// counts as zero, whatever the deck's unit: a soft body of 0.1 m has nodal forces of 1e-3 N, so a
/// tolerance of 1e-8 would in effect be 1e-3. (2) A D1 below 1e-10 counts as not given and is
/// replaced by 0.1 / (2 C10); in 1/Pa that concerns any solid as stiff as glass. Decks are
/// therefore written in units in which the shear modulus and the edge of an element are of order
/// 1e3 each, and nodal forces of order 1e9 times the strain; results are converted back on reading.
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <span>
#include <string>

namespace palpable {

/// The units of a model's deck in SI, powers of ten.
struct CalculixUnits {
  double length = 1;  ///< m
  double stress = 1;  ///< Pa
  [[nodiscard]] double force() const { return stress * length * length; }
};
[[nodiscard]] CalculixUnits calculix_units(const SolidModel& model);

/// A rigid box that presses the body with one of its faces: CalculiX' own contact (node to surface,
/// linear pressure over overclosure, Coulomb's friction if asked for), to compare ours with.
struct CalculixLid {
  Eigen::Vector3d middle;  ///< m, centre of the pressing face at level 0
  Eigen::Vector3d normal;  ///< unit, outward normal of that face
  double side = 0;         ///< m, edge of the box; larger than the pressed area
  Eigen::Vector3d way;     ///< m, displacement of the box at level 1
  double stiffness = 0;    ///< Pa/m, pressure over overclosure
  double friction = 0;     ///< Coulomb's coefficient; 0: none
  double sticking = 0;     ///< Pa/m, shear over slide of a point that sticks; with friction > 0
};

/// The deck. Numbers have as many digits as fit into the 20 characters that CalculiX reads: at
/// least 13 significant ones. Nodes and elements are numbered from 1 in the model's order.
/// @param full_load  (3 x N) N at level 1; may be zero if there are fixed displacements
/// @param levels     > 0, increasing, at least one
/// @param lid        a rigid box that presses the skin as well; nullptr: none
/// @throws Error as check_model(); for a law that CalculiX does not have; a load of the wrong size
[[nodiscard]] std::string calculix_deck(const SolidModel& model, const Eigen::Matrix3Xd& full_load,
                                        std::span<const double> levels, double tolerance = 1e-8,
                                        const CalculixLid* lid = nullptr);

/// The deck of free vibration around the undeformed body: one *STEP with *FREQUENCY. CalculiX'
/// laws are linear there, *ELASTIC alike for all deformations.
/// ccx 2.20 finds the eigenvalues omega^2 nearest to 1 in the deck's unit, and those below it not
/// at all. The density of all elements is kFrequencyDeckDensity in the deck's unit, with which the
/// lowest eigenvalues are far above 1 whatever the body.
/// @param modes    >= 1
/// @throws Error as check_model(); for another law than St. Venant-Kirchhoff's
[[nodiscard]] std::string calculix_frequency_deck(const SolidModel& model, int modes);
inline constexpr double kFrequencyDeckDensity = 1e-12;
/// (rad/s)^2 of an eigenvalue of 1 in that deck. @param density  kg/m^3, > 0
[[nodiscard]] double calculix_eigenvalue_unit(const SolidModel& model, double density);

}  // namespace palpable
