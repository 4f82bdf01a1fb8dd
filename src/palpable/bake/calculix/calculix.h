/// @file
/// Equilibrium paths and frequencies by CalculiX (`ccx`), an independent finite-element program,
/// run as a child process: to verify our solver against it, or to compute snapshots with it
/// instead.
///
///   N  nodes
///   level  factor of the full load, as in solid/equilibrium.h
///
/// calculix_deck.h writes the input deck; calculix_dat.h reads the states.
#pragma once

#include "palpable/bake/calculix/calculix_dat.h"
#include "palpable/bake/calculix/calculix_deck.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

struct CalculixSettings {
  std::string program = "ccx";  ///< a name on PATH, or a path
  /// Convergence bound: largest residual at a degree of freedom, as a ratio to CalculiX' average
  /// nodal force (R_n and R_p of *CONTROLS, FIELD). CalculiX' test of the last correction is
  /// switched off, so the residual alone decides.
  double tolerance = 1e-8;
  /// Folder of the deck and the results: created if absent; its files are overwritten and kept.
  /// Empty: a temporary folder, which is removed even after an error.
  std::filesystem::path folder;
  std::optional<CalculixLid> lid = {};  ///< a rigid box that presses the skin
};

struct CalculixRun {
  std::vector<CalculixState> states;  ///< one per level reached, in order
  bool complete = false;              ///< all levels reached
  std::string why_stopped;            ///< CalculiX' reason, one line; empty when complete
  double last_level = 0;   ///< of the last increment that converged; may lie between levels
  int increments = 0;      ///< number of increments that converged
  int iterations = 0;      ///< of Newton's method, including failed increments
  double cpu_seconds = 0;  ///< of the ccx process, user and system
  double wall_seconds = 0;
};

/// Solves for the states at `levels` of the dead load `full_load` (and of the model's fixed
/// displacements) with one thread. Progress is reported in levels, from ccx's own .sta file.
///
/// Where ccx gives up, for instance because its increments become too small, the states reached so
/// far are returned and why_stopped holds the reason. Takes minutes for 16,000 nodes: one sparse
/// factorisation per Newton step.
/// @param full_load  (3 x N) N at level 1; may be zero if there are fixed displacements
/// @param levels     > 0, increasing, at least one
/// @throws Error as check_model(); for a law that CalculiX does not have; a load of the wrong size;
///         when ccx is not installed, cannot run, or refuses the deck (its message, in one line)
[[nodiscard]] CalculixRun solve_with_calculix(const SolidModel& model,
                                              const Eigen::Matrix3Xd& full_load,
                                              std::span<const double> levels,
                                              const CalculixSettings& settings = {},
                                              const Progress& progress = {});

/// The lowest frequencies of free vibration around the undeformed body, rad/s, rising, by CalculiX
/// (*FREQUENCY, ARPACK) on the same mesh: to verify solid/vibration_modes.h. Only `program` and
/// `folder` of the settings are used.
/// @param density  kg/m^3, > 0
/// @throws Error as solve_with_calculix(), and for another law than St. Venant-Kirchhoff's
[[nodiscard]] std::vector<double> frequencies_by_calculix(const SolidModel& model, double density,
                                                          int modes,
                                                          const CalculixSettings& settings = {});

/// The mass as CalculiX integrates it for *FREQUENCY, (N x N) kg: at the points of the stiffness,
/// one of a C3D4 and four of a C3D10. Those are too few for products of shape functions, so its
/// frequencies are too high: by up to 20 % on a coarse mesh of C3D4, by less than 0.1 % where five
/// C3D10 and more lie in a wave. With this mass ours are the same to seven digits
/// (calculix_test.cpp).
[[nodiscard]] Eigen::SparseMatrix<double> calculix_mass(const TetMesh& mesh, double density);

/// The program's full path if it can be run; nothing otherwise. @param program  name or path
[[nodiscard]] std::optional<std::filesystem::path> find_calculix(std::string_view program = "ccx");

/// CalculiX' error message, from its standard output: the first "*ERROR" with its continuation
/// lines, as one line without runs of blanks; empty if there is none.
[[nodiscard]] std::string calculix_error(std::string_view log);

}  // namespace palpable
