/// @file
/// Motion of the full mesh in time: inertia, hyperelastic forces, damping and loads.
///
///     M u'' + C u' + f_int(u) = f(t)      in the free directions
///
///   N  nodes     m  damped modes     h  time step
///
/// M is the consistent mass (vibration_modes.h), f_int the forces of equilibrium.h. The step is the
/// generalised-alpha method (Chung and Hulbert, "A time integration algorithm for structural
/// dynamics with improved numerical dissipation: the generalized-alpha method", J. Appl. Mech. 60,
/// 371-375, 1993) with weighted internal forces:
///
///     M ((1 - am) a' + am a) + C ((1 - af) v' + af v) + (1 - af) f_int(u') + af f_int(u) = f
///     u' = u + h v + h^2 ((1/2 - b) a + b a'),        v' = v + h ((1 - g) a + g a')
///     am = (2 r - 1)/(r + 1),   af = r/(r + 1),   g = 1/2 - am + af,   b = (1 - am + af)^2 / 4
///
/// where ' marks the end of the step and r = rho_inf. It is of second order and, in the linear
/// case, stable for every h. This is the truth against which the inertia of the live half is
/// measured: it has neither its modes nor its exact oscillators.
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <memory>

namespace palpable {

/// Damping that gives each of some modes the same ratio zeta, and stiffer motion more:
///
///     C(u) = M Phi D Phi^T M + (2 zeta / omega_m) K(u)
///     D    = diag(2 zeta omega_i (1 - omega_i / omega_m))
///
/// K is the tangent at u. At rest the two terms add up to 2 zeta omega_i in mode i <= m, exactly.
/// In modes beyond, only the second is left: zeta omega / omega_m, which is zeta at omega_m and
/// rises from there. Mass and stiffness alone (Rayleigh) would give the ratio at two frequencies
/// only; the first term alone would let all modes beyond ring for ever, which rubber does not do.
/// With the tangent at rest instead of K(u), parts that have turned would be damped as if they were
/// strained: the swings of a bunny's ear that is plucked by 20 mm came out 17 to 32 % too small.
struct ModalDamping {
  Eigen::VectorXd omega = {};   ///< (m) rad/s, rising; of vibration_modes() for the same body
  Eigen::MatrixXd shapes = {};  ///< (3N x m) 1/sqrt(kg), of unit modal mass
  double ratio = 0;             ///< zeta, 0 <= zeta; 0: none
};

struct DynamicsSettings {
  double time_step = 5e-4;  ///< s, > 0
  /// What is left after a step of motion whose period is far shorter than h, 0 to 1; at 1 nothing
  /// is lost. At 0.8 such motion, which the steps cannot follow, is gone after twenty steps. What
  /// they can follow is kept: with 40 steps in a period an amplitude loses 4e-7 in each, with 3 it
  /// loses 5e-3. A period comes out too long by a share of 0.088 (omega h)^2, at 1 of (omega h)^2
  /// / 12.
  double rho_inf = 0.8;
  /// A step counts as solved when the residual at free nodes is below this, relative to the norm of
  /// the largest forces so far: loads, internal forces, or inertia.
  double tolerance = 1e-8;
  int max_newton_steps = 30;
  int max_cg_iterations = 400;  ///< per Newton step
};

/// J. But for the loss of the method, kinetic + elastic + dissipated - work stays constant.
struct DynamicEnergy {
  double kinetic = 0;
  double elastic = 0;     ///< stored in the body
  double dissipated = 0;  ///< by damping, since start()
  double work = 0;        ///< by loads, preload and the obstacle, since start()

  [[nodiscard]] double balance() const { return kinetic + elastic + dissipated - work; }
};

/// Contact with an obstacle, see ContactSettings.
struct DynamicContact {
  double spacing = 0;   ///< m, between contact points; 0: chosen as ContactSettings::spacing
  double penalty = 30;  ///< ratio to the effective stiffness of a point's nodes
  double largest_entry = 1e-6;  ///< ratio to the diagonal of the body's bounding box
  int max_updates = 60;         ///< of the multipliers, per step
};

/// Not for several threads. Memory: the factor of the effective stiffness in 32 bits, 2 m vectors.
class ImplicitDynamics {
 public:
  /// @param density    kg/m^3, > 0
  /// @param preloaded  loads that act all the time, and the rest; nullptr: the undeformed body
  /// @throws Error as check_model(), and if nothing is free
  ImplicitDynamics(const SolidModel& model, double density, const ModalDamping& damping,
                   const DynamicsSettings& settings = {}, const Preloaded* preloaded = nullptr);
  ~ImplicitDynamics();
  ImplicitDynamics(ImplicitDynamics&&) noexcept;

  /// Begins at time 0, without an obstacle. The body need not be in equilibrium.
  /// @param u, v  (3 x N) m, m/s; supports stay where u has them, v is ignored there
  /// @throws Error if an element is inverted in u
  void start(const Eigen::Matrix3Xd& u, const Eigen::Matrix3Xd& v);

  /// From now on an obstacle presses the body; `motion` gives its pose at time() and later. It
  /// should not touch the body yet.
  /// @throws Error as ContactWalk for a spacing that is too small
  void set_obstacle(ObstacleMotion motion, const DynamicContact& contact = {});

  /// Moves on by a time step under a constant load, in addition to the preload. Where the load
  /// differs from that of the step before, a jumps by what the effective stiffness makes of the
  /// difference; without it a jump would be felt with a delay of some 0.06 h.
  /// @param load  (3 x N) N, dead
  /// @throws Error if no shortened Newton step leads on: try a smaller time step
  void step(const Eigen::Matrix3Xd& load);

  [[nodiscard]] double time() const;                           ///< s since start()
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const;          ///< (3 x N) m
  [[nodiscard]] const Eigen::Matrix3Xd& displacement() const;  ///< (3 x N) m, of undeformed nodes
  [[nodiscard]] Eigen::Matrix3Xd velocity() const;             ///< (3 x N) m/s
  [[nodiscard]] const DynamicEnergy& energy() const;
  /// N, of the obstacle on the body in the last step.
  [[nodiscard]] Eigen::Vector3d contact_force() const;
  [[nodiscard]] int touching() const;       ///< contact points with force
  [[nodiscard]] int newton_steps() const;   ///< since start()
  [[nodiscard]] int cg_iterations() const;  ///< since start()

 private:
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace palpable
