/// @file
/// The asymptotic numerical method: the displacement of a St. Venant-Kirchhoff body as a power
/// series in the size of a dead load (Cochelin, Damil, Potier-Ferry 1994; the paper's ref. 50).
///
///   N  nodes     k  loads     n  orders
///
///     u(a) = a u_1 + a^2 u_2 + ...          under the forces a f
///     H_p = grad u_p,    S_p = C : (sym H_p + Q_p),    Q_p = 1/2 sum_{r=1}^{p-1} H_r^T H_{p-r}
///
///     K u_1 = f
///     K u_p = - sum_e V_e ( C : Q_p + sum_{r=1}^{p-1} H_r S_{p-r} ) grad N,       p >= 2
///
/// with one stiffness K, that of the undeformed body. P = F S is a cubic polynomial of u, so these
/// are all terms of order p; nothing is truncated but the series itself.
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace palpable {

/// Where a series is truncated.
struct SeriesSettings {
  int most_orders = 14;  ///< >= 1
  /// The series of a load ends where |u_p| <= tolerance |u_1|, at the full load, in the norm of
  /// the lumped mass.
  double tolerance = 1e-6;
};

/// One load's series.
struct LoadOrders {
  Eigen::MatrixXd u;       ///< (3N x n) column p - 1 is u_p, m at the full load
  bool converged = false;  ///< the tolerance was met
  /// |u_{n-1}| / |u_n|: an estimate of the largest multiple of the full load for which the series
  /// converges; infinite for n = 1.
  double radius = 0;
};

/// The series of one body under any loads; K is factorised once, in double precision.
class LoadSeries {
 public:
  /// @throws Error as check_model(); for another law than St. Venant-Kirchhoff's, for 10-node
  ///         elements, and for supports that move
  explicit LoadSeries(const SolidModel& model);
  ~LoadSeries();
  LoadSeries(LoadSeries&&) noexcept;

  [[nodiscard]] const SolidModel& model() const;

  /// (3N x k) m, K^-1 loads, 0 where the body is held: the displacement under each load to first
  /// order. 3 ms each on the beam of 12,803 nodes.
  /// @param loads  (3N x k) N; at held nodes not read
  [[nodiscard]] Eigen::MatrixXd linear_response(const Eigen::MatrixXd& loads) const;

  /// (3N) K u, N. @param u  (3N) m, 0 where the body is held
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& u) const;

  /// The orders of each load, 16 loads side by side. Memory: 16 loads x orders x 6 stresses x 8
  /// bytes an element.
  /// @param loads  (3N x k) N at a = 1; neighbours should need about the same number of orders
  [[nodiscard]] std::vector<LoadOrders> solve(const Eigen::MatrixXd& loads,
                                              const SeriesSettings& settings) const;

  /// (3N) N, the forces that hold the body in the state u (m): d/du of the stored energy.
  [[nodiscard]] Eigen::VectorXd internal_force(const Eigen::VectorXd& u) const;

  /// (3N) 1 where the component is free, 0 where it is held.
  [[nodiscard]] const Eigen::VectorXd& free_mask() const;
  /// (3N) m^3, the lumped mass of density 1, once for each component: the norm's weights.
  [[nodiscard]] const Eigen::VectorXd& mass() const;

 private:
  struct Core;
  std::unique_ptr<const Core> core_;
};

/// (n) the coefficients c of the vector Pade form of a series at `a`. They replace the powers a^p
/// of the series: u = sum_p c_p u_p with c_n = 0,
///
///     c_p = a^p D_{n-1-p}(a) / D_{n-1}(a),   D_k(a) = 1 + d_1 a + ... + d_k a^k,
///
/// d such that u_n + d_1 u_{n-1} + ... + d_{n-1} u_1 is normal to u_1 ... u_{n-1} (Najah, Cochelin,
/// Damil, Potier-Ferry 1998). It converges for larger a than the series does. Where the two
/// agree, both are accurate.
/// @param gram  (n x n) inner products of the orders
[[nodiscard]] Eigen::VectorXd pade_coefficients(const Eigen::MatrixXd& gram, double a);

}  // namespace palpable
