/// @file
/// Equilibrium paths by CalculiX (`ccx`), a solver that others wrote and trust, run as a program:
/// to compare ours with it, and for those who would rather have their snapshots from it.
///
///   N  nodes     E  tetrahedra     Q  integration points of one: 1 (C3D4) or 4 (C3D10)
///   level  factor of the full load, as in solid/equilibrium.h
///
/// One deck, one *STEP with NLGEOM, results printed at the levels only. CalculiX' laws under
/// NLGEOM: *ELASTIC is St. Venant-Kirchhoff, *HYPERELASTIC, NEO HOOKE is NeoHookeanAbaqus (compared
/// with the closed forms in tests/verification). It has no law like eq. (7).
///
/// Two traps of ccx 2.20, both about units. A residual below 1e-6 counts as zero, whatever the
/// deck's unit: a soft body of 0.1 m has nodal forces of 1e-3 N, so "1e-8" would mean 1e-3. And a
/// D1 below 1e-10 counts as not given and is replaced by 0.1 / (2 C10): in 1/Pa that is any
/// solid as stiff as glass. So decks are written in units in which an element's shear modulus and
/// edge are of order 1e3 each, so its stiffness 1e9; results are converted back on reading.
#pragma once

#include "palpable/base/error.h"
#include "palpable/base/progress.h"
#include "palpable/solid/solid_model.h"
#include "palpable/solid/stress.h"

#include <Eigen/Core>

#include <filesystem>
#include <iosfwd>
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
};

/// One state of the body as CalculiX printed it: seven digits of each number.
struct CalculixState {
  double level = 0;
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  /// (6 x Q E) Cauchy, Pa, at the integration points: those of element e from column Q e on. Point
  /// q of four is the one nearest to corner q.
  StressField stress;
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

// What solve_with_calculix is made of.

/// The units of a model's deck in SI, powers of ten.
struct CalculixUnits {
  double length = 1;  ///< m
  double stress = 1;  ///< Pa
  [[nodiscard]] double force() const { return stress * length * length; }
};
[[nodiscard]] CalculixUnits calculix_units(const SolidModel& model);

/// The deck. Numbers have as many digits as CalculiX reads, which is 20 characters, so at least 13
/// significant digits. Nodes and elements are numbered from 1 in the model's order.
/// @throws Error as solve_with_calculix
[[nodiscard]] std::string calculix_deck(const SolidModel& model, const Eigen::Matrix3Xd& full_load,
                                        std::span<const double> levels, double tolerance = 1e-8);

/// What a .dat file of such a deck must hold.
struct CalculixDatLayout {
  int node_count = 0;
  int tet_count = 0;
  int points = 1;              ///< Q
  std::vector<double> levels;  ///< those asked for; fewer may be there
  CalculixUnits units;         ///< calculix_units()
};

/// Reads the printed states. Whatever the bytes: states that are complete (each node and element
/// once, all numbers finite, levels in order) or a problem that names the line.
/// @param name  for messages
[[nodiscard]] Result<std::vector<CalculixState>> read_calculix_dat(std::istream& dat,
                                                                   const CalculixDatLayout& layout,
                                                                   std::string_view name);

/// CalculiX' own words about what went wrong, from its standard output: the first "*ERROR" with its
/// continuation lines, as one line without runs of blanks; empty if there is none.
[[nodiscard]] std::string calculix_error(std::string_view log);

}  // namespace palpable
