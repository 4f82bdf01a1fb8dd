/// @file
/// Comparison of our contact solver with CalculiX's on one mesh: a tilted lid presses a block.
#pragma once

#include <vector>

namespace palpable {

/// CalculiX's contact is a penalty method; the stiffer it is, the closer it is to ours.
struct ContactDifference {
  double stiffness = 0;     ///< of CalculiX's contact, in Young's modulus / edge length of a cell
  double displacement = 0;  ///< largest difference of a node / largest displacement
  double force = 0;         ///< relative, of the lid's total force
};

/// A block of 0.1 m and 60 kPa, held at its base. The lid is tilted by 6 degrees, so that it
/// touches a part of the top, and moves down by 8 mm. In both solvers the corners of the skin are
/// the contact points.
/// @param cells        along each edge of the block
/// @param stiffnesses  see ContactDifference
/// @param friction     Coulomb's coefficient; if above 0, the lid moves aside by 4 mm meanwhile,
/// and
///                     both solvers go in 20 steps. CalculiX lets a point slide while it sticks,
///                     with a tenth of the stiffness
/// @throws Error when one of the programs does not converge, or ccx is not installed
[[nodiscard]] std::vector<ContactDifference> compare_contact(int cells,
                                                             const std::vector<double>& stiffnesses,
                                                             double friction = 0.0);

}  // namespace palpable
