/// @file
/// Problems with known solutions, by which friction in contact.h is verified. All throw Error when
/// a state is not found.
///
///     P  normal force, N     Q, T  tangential force, N     mu  Coulomb's coefficient
#pragma once

namespace palpable {

/// A ball on a half space, dragged aside and back (Cattaneo; Mindlin; Mindlin and Deresiewicz; see
/// Johnson, Contact Mechanics, 1985, sections 7.2 and 7.4). With the slide's largest displacement
/// d_0 = 3/2 mu P S, S the compliance Q -> d of a contact that sticks all over:
///
///     stick radius    c / a = (1 - Q / (mu P))^(1/3)
///     forth           d = d_0 (1 - (1 - Q / (mu P))^(2/3))
///     back from Q*    d = d_0 (2 (1 - (Q* - Q) / (2 mu P))^(2/3) - (1 - Q* / (mu P))^(2/3) - 1)
///
/// Half a block with edges of 12 a, 6 a and 6 a stands for the half space; its far faces are held.
/// P is that of the state, S is measured on the same mesh with a coefficient with which nothing
/// slides: errors of the mesh cancel, and what is left is that of friction. The closed form
/// neglects the shear under a normal force: the ball is pressed without friction, which begins
/// before the drag. It also neglects what Q does to the pressure, and slip across Q: mu and
/// Poisson's ratio are small.
struct MindlinResult {
  int nodes = 0;
  /// c / a over the closed form, minus 1, root mean square of the states on the way forth; c and a
  /// are those of circles with the area that sticks and that touches.
  double stick_radius_error = 0;
  double displacement_error = 0;  ///< largest on the way forth, relative
  double unloading_error = 0;     ///< largest on the way back, relative to that at Q*
  /// S over (2 - nu) / (4 G a), that of half of a half space, minus 1. The far faces are held.
  double compliance_error = 0;
  /// Share of S that is the elastic slip (point_friction.h): measured with ten times its stiffness.
  double elastic_slip = 0;
  double cone_error = 0;  ///< ContactState::cone_error, the largest
};

/// @param cells_in_radius  cells of the mesh under the ball along the contact radius a
[[nodiscard]] MindlinResult drag_mindlin_block(int cells_in_radius);

/// A block that is held at its base, and a plate that presses it and is then pulled aside.
struct SlipResult {
  double angle_error = 0;  ///< atan(T / P) where the plate slides, over atan(mu), minus 1
  /// Largest T / (mu P), and the least where no point sticks.
  double largest_ratio = 0, least_sliding = 0;
  /// Work of the plate while it is pulled, over the energy stored and dissipated meanwhile,
  /// minus 1.
  double energy_error = 0;
  /// Work of the plate in a step less the change of the stored energy, over the work of all steps:
  /// the least. Below 0 by the elastic slip that is given back, and by the trapezoidal rule.
  double least_lost = 0;
};

[[nodiscard]] SlipResult pull_plate(int cells, double coefficient, int steps);

/// Largest movement of a node, m, while a ball that was dragged until a part of its contact slips
/// rests on a block for `frames` states.
[[nodiscard]] double creep_at_rest(int cells, double coefficient, int frames);

/// A strip between two held ends, and a cylinder that is pressed into it and then moved along it,
/// until it slides. Its tensions T have the ratio of Euler and Eytelwein; friction acts on the
/// strip's surface and tension in its middle:
///
///     T_1 / T_2 = exp(mu theta r / (r + h / 2))     theta  wrapped angle     h  thickness
struct CapstanResult {
  double ratio = 0, angle = 0;  ///< T_1 / T_2; theta, rad, both by the forces at the ends
  double error = 0;             ///< T_1 / T_2 over the closed form, minus 1
  int sticking = 0;             ///< points that stick at the end
};

/// @param cells  along the strip
[[nodiscard]] CapstanResult slide_strip(int cells, double coefficient);

/// A ball pressed into a block by 5 mm and dragged aside by as much: relative change of the
/// displacement (L2 over all nodes) with half the step.
/// @param step  m, the larger one
[[nodiscard]] double change_with_half_step(int cells, double coefficient, double step);

}  // namespace palpable
