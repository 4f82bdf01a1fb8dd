/// @file
/// The states that CalculiX prints into its .dat file.
///
///   N  nodes     E  tetrahedra     Q  integration points of one: 1 (C3D4) or 4 (C3D10)
#pragma once

#include "palpable/bake/calculix/calculix_deck.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/error.h"

#include <Eigen/Core>

#include <iosfwd>
#include <string_view>
#include <vector>

namespace palpable {

/// One state of the body as CalculiX printed it: seven digits of each number.
struct CalculixState {
  double level = 0;
  Eigen::Matrix3Xd displacement;  ///< (3 x N) m
  /// (6 x Q E) Cauchy, Pa, at the integration points: those of element e from column Q e on. Point
  /// q of four is the one nearest to corner q.
  StressField stress;
};

/// What a .dat file of a deck of calculix_deck() must hold.
struct CalculixDatLayout {
  int node_count = 0;
  int tet_count = 0;
  int points = 1;              ///< Q
  std::vector<double> levels;  ///< requested ones; the file may hold fewer
  CalculixUnits units;         ///< calculix_units()
};

/// Reads the printed states. For any input the result is either complete states (each node and
/// element once, all numbers finite, levels in order) or a problem that names the line.
/// @param name  for messages
[[nodiscard]] Result<std::vector<CalculixState>> read_calculix_dat(std::istream& dat,
                                                                   const CalculixDatLayout& layout,
                                                                   std::string_view name);

/// Reads the eigenvalues of a deck of calculix_frequency_deck(), rising, in the deck's unit; of
/// seven digits. For any input the result is `modes` finite numbers or a problem that names the
/// line.
[[nodiscard]] Result<std::vector<double>> read_calculix_eigenvalues(std::istream& dat, int modes,
                                                                    std::string_view name);

}  // namespace palpable
