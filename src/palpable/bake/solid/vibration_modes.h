/// @file
/// The vibration modes of a body that is held by its supports, around its state of rest:
///
///     K phi_i = omega_i^2 M phi_i,     phi_i^T M phi_j = delta_ij
///
/// K is the tangent stiffness at rest, under the preload, and M the consistent mass of the mesh
/// (Bathe, Finite Element Procedures, 2nd ed., 4.2.4 and ch. 10 and 11). Damping is not part of it.
///
///   N  nodes     m  modes
#pragma once

#include "palpable/bake/solid/load_response.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace palpable {

/// (N x N) kg: int rho N_a N_b dV over the undeformed body, the same in x, y and z. The entries add
/// up to the body's mass. Exact for 4-node tetrahedra and for 10-node ones with straight edges.
/// @pre density > 0, kg/m^3 of the undeformed body
[[nodiscard]] Eigen::SparseMatrix<double> consistent_mass(const TetMesh& mesh, double density);

struct VibrationSettings {
  int least = 20;         ///< modes, >= 1; fewer of a body with fewer degrees of freedom
  double below = 376.99;  ///< rad/s, 2 pi 60 Hz: all modes below this are found
  int most = 200;         ///< modes, >= least
};

/// Modes by rising omega. Where some modes have the same omega, any rotation of them solves the
/// equation too.
struct VibrationModes {
  Eigen::VectorXd omega;     ///< (m) rad/s, > 0
  Eigen::MatrixXd shapes;    ///< (3N x m) 1/sqrt(kg); 0 in held directions
  Eigen::VectorXd residual;  ///< (m) |K phi - omega^2 M phi| / |K phi|, over free directions
};

/// The largest residual of a mode that vibration_modes() returns.
inline constexpr double kLargestEigenResidual = 1e-6;

/// The lowest modes, by a block Lanczos iteration with K^-1 M (Grimes, Lewis, Simon, SIAM J. Matrix
/// Anal. Appl. 15, 228-272, 1994, without shifts), whose basis is kept orthogonal in full. Takes
/// some 100 solves with K and 24 N (3 m + 50) bytes. A pair of modes of one frequency is never cut:
/// there may be a mode more than requested.
///
/// The result is a function of the body alone: the start is fixed, and nothing runs in parallel.
/// The largest component of a shape is positive.
/// @pre density > 0, kg/m^3
/// @throws Error if no basis was large enough, or the residual of a mode is above
///         kLargestEigenResidual
[[nodiscard]] VibrationModes vibration_modes(const LoadResponse& body, double density,
                                             const VibrationSettings& settings = {});
/// The same with another mass than the consistent one. @param M  (N x N) kg, symmetric, not
/// negative
[[nodiscard]] VibrationModes vibration_modes(const LoadResponse& body,
                                             const Eigen::SparseMatrix<double>& M,
                                             const VibrationSettings& settings = {});

}  // namespace palpable
