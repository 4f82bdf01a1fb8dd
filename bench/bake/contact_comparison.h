/// @file
/// Contact by our solver and by CalculiX, on one mesh: a tilted lid that comes down on a block.
#pragma once

#include <vector>

namespace palpable {

/// CalculiX' contact is a penalty, ours is not: the stiffer theirs, the nearer it is to ours.
struct ContactDifference {
  double stiffness = 0;     ///< of CalculiX' contact, in Young's moduli per edge of a cell
  double displacement = 0;  ///< largest difference of a node over the largest displacement
  double force = 0;         ///< relative, of the lid's whole force
};

/// A block of 0.1 m and 60 kPa on its base; the lid is tilted by 6 degrees, so that part of the top
/// comes into touch, and goes 8 mm down. Both solvers let the corners of the skin touch.
/// @param cells        along each edge of the block
/// @param stiffnesses  see ContactDifference
/// @throws Error when one of the programs does not get there, or ccx is not installed
[[nodiscard]] std::vector<ContactDifference> compare_contact(
    int cells, const std::vector<double>& stiffnesses);

}  // namespace palpable
