/// @file
/// What a bake will have to do, counted from its description and its mesh before anything is
/// solved, and what the steps of it cost on this machine. bake_estimate.h makes time, memory and
/// bytes of it.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/bake_to_file.h"
#include "palpable/common/base/progress.h"

#include <optional>

namespace palpable {

/// A mesh on which equations are solved.
struct MeshCounts {
  int nodes = 0;
  int tets = 0;
  int points = 0;             ///< of integration: one a tetrahedron, or four where it has ten nodes
  int vertices = 0;           ///< on the skin
  double volume = 0;          ///< m^3
  double area = 0;            ///< m^2, of the skin
  double factor_numbers = 0;  ///< that the Cholesky factor of its stiffness stores
};

/// Tables of touch, and the held-out touches that measure them.
struct TouchCounts {
  MeshCounts mesh;  ///< the body's own, or the coarser one that carries its skin
  int shell = 0;    ///< nodes of the shell (shell_table.h)
  int held = 0;     ///< vertices that do not move
  int regions = 0;  ///< 0: linear tables
  int cross_modes = 0;
  int held_out = 0;  ///< touches
  int vibration_modes = 0;
  double table_bytes = 0;
};

/// A bake without a campaign.
struct IntrusiveCounts {
  int positions = 0;  ///< of the load
  int modes = 0;      ///< of displacement
  int stress_modes = 0;
  int energy_modes = 0;    ///< of the energy of several loads at once; 0: one load at a time
  int shell = 0;           ///< nodes of the shell (shell_table.h); 0 with one load at a time
  double shell_bytes = 0;  ///< of the table that the body file has of it
};

struct BakeCounts {
  MeshCounts body;
  int sites = 0;   ///< S
  int levels = 0;  ///< L
  int points = 1;  ///< P, combinations of the parameters' values
  int linear = 0;  ///< linear responses of vertices
  int shards = 1;  ///< parts of the campaign, one of which is solved; above 1 there is no body file
  bool held_out = false;  ///< whether the levels in between are solved, too
  /// Modes in the body file that the default tolerance needs (expected_modes()).
  double displacement_modes = 0, stress_modes = 0;
  int mode_nodes = 0;       ///< nodes at which the file has them: the skin's, or all
  int bytes_of_number = 4;  ///< of a mode
  std::optional<TouchCounts> touch = {};
  std::optional<IntrusiveCounts> intrusive = {};  ///< then there are no sites, levels and modes
};

/// CPU seconds of the steps of which nearly all work on a mesh consists.
struct MeshCosts {
  double factor = 0;  ///< ordering, stiffness and its Cholesky factor in double precision
  double solve = 0;   ///< one load with that factor, of 48 solved together
  double pass = 0;    ///< one pass over the elements: forces of second order (load_response.h)
};

/// CPU seconds on this machine.
struct BakeCosts {
  double mesh = 0;  ///< reading, meshing and placing the sites
  MeshCosts body;
  MeshCosts touch = {};  ///< on TouchCounts::mesh
  double flop = 0;       ///< one operation of a product of dense matrices in double precision
};

struct CountedBake {
  BakeCounts counts;
  BakeCosts costs;
};

/// Meshes the body, places its sites, finds the size of its tables of touch, and measures the
/// costs: one Cholesky factor and some loads on each mesh. A second for a body of 3,500 nodes, some
/// seconds for one of 16,000. Writes no file.
/// @throws Error as pose_body() or travelling_load(), where the bake itself would throw
[[nodiscard]] CountedBake count_bake(const BodyDescription& description,
                                     const BakeToFileSettings& settings,
                                     const Progress& progress = {});

/// Modes of one site that a reduction needs: 3.8 of displacement and 4.8 of stress at a tolerance
/// of 1e-4, and 1.5 fewer for each factor of ten; at least 1, at most `levels`.
struct ExpectedModes {
  double displacement = 0, stress = 0;
};
[[nodiscard]] ExpectedModes expected_modes(double tolerance, int levels);

}  // namespace palpable
