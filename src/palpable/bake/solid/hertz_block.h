/// @file
/// Hertz's problem, by which the contact solver is verified: a ball pressed into a half space
/// (Johnson, Contact Mechanics, 1985, sections 3.2 and 4.2).
///
///     a = sqrt(R d)      F = 4/3 E* sqrt(R) d^(3/2)      p0 = 3 F / (2 pi a^2)
///     E* = E / (1 - nu^2)
///
/// A quarter of a block with edges of 8 a stands for the half space. Symmetry holds two of its
/// faces. The other faces are displaced as in a half space under the point force F (Boussinesq,
/// Johnson eq. 3.18 ff.); for a force on a patch of radius a this is accurate to (a / 8 a)^2.
/// Strains stay below 1 %.
#pragma once

#include "palpable/bake/solid/contact.h"

namespace palpable {

struct HertzResult {
  double cell = 0;  ///< edge of the cells under the ball over the contact radius a
  int nodes = 0;
  double force_error = 0;     ///< F over Hertz's, minus 1
  double radius_error = 0;    ///< of a, by the forces' second moment: sum f r^2 = 2/5 a^2 F
  double pressure_error = 0;  ///< of p0, from F and that a
  ContactState state;
};

/// @param cells  along each edge of the quarter block, finer towards the ball
[[nodiscard]] HertzResult press_hertz_block(int cells);

}  // namespace palpable
