/// @file
/// Equilibrium paths by CalculiX (`ccx`), a solver that others wrote and trust, run as a program:
/// to compare ours with it, and for those who would rather have their snapshots from it.
///
///   N  nodes
///   level  factor of the full load, as in solid/equilibrium.h
///
/// The deck is calculix_deck.h's, the states are read by calculix_dat.h.
#pragma once

#include "palpable/bake/campaign/calculix_dat.h"
#include "palpable/bake/campaign/calculix_deck.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

struct CalculixSettings {
  std::string program = "ccx";  ///< a name on PATH, or a path
  /// Largest residual at a degree of freedom over CalculiX' average nodal force (R_n and R_p of
  /// *CONTROLS, FIELD). Its test of the last correction is switched off: the residual decides.
  double tolerance = 1e-8;
  /// Where deck and results go; made if absent, overwritten, kept. Empty: a temporary folder, which
  /// is removed, also when something fails.
  std::filesystem::path folder;
  std::optional<CalculixLid> lid = {};  ///< presses the body's skin
};

struct CalculixRun {
  std::vector<CalculixState> states;  ///< one per level reached, in order
  bool complete = false;              ///< all levels reached
  std::string why_stopped;            ///< empty when complete: one line, in CalculiX' words
  double last_level = 0;              ///< the last that converged; it may lie between two levels
  int increments = 0;                 ///< that converged
  int iterations = 0;                 ///< of Newton's method, those of failed increments included
  double cpu_seconds = 0;             ///< of the ccx process, user and system
  double wall_seconds = 0;
};

/// Solves for the states at `levels` of the dead load `full_load` (and of the model's fixed
/// displacements) with one thread. Progress is reported in levels, from ccx's own .sta file.
///
/// Where ccx cuts its increments down to nothing, the states so far are the answer and why_stopped
/// says so. Costs minutes for 16,000 nodes: a sparse factorisation per Newton step.
/// @param full_load  (3 x N) N at level 1; may be zero if there are fixed displacements
/// @param levels     > 0, increasing, at least one
/// @throws Error as check_model(); for a law that CalculiX does not have; a load of the wrong size;
///         when ccx is not installed, cannot run, or refuses the deck (its message, in one line)
[[nodiscard]] CalculixRun solve_with_calculix(const SolidModel& model,
                                              const Eigen::Matrix3Xd& full_load,
                                              std::span<const double> levels,
                                              const CalculixSettings& settings = {},
                                              const Progress& progress = {});

/// The program's full path if it can be run; nothing otherwise. @param program  name or path
[[nodiscard]] std::optional<std::filesystem::path> find_calculix(std::string_view program = "ccx");

/// CalculiX' own words about what went wrong, from its standard output: the first "*ERROR" with its
/// continuation lines, as one line without runs of blanks; empty if there is none.
[[nodiscard]] std::string calculix_error(std::string_view log);

}  // namespace palpable
