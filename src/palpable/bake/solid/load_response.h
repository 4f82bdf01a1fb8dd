/// @file
/// Response of a body to a small load: the first three terms of its displacement as a power series
/// in the load, for any law, any elements, and with or without a preload.
///
///   N  nodes     k  loads     M  free nodes
///
///     u(a) = u_0 + a u_1 + a^2 u_2 + a^3 u_3 + ...        under the forces  preload + a f
///
///     K u_1 = f
///     K u_2 = - 1/2 D^2 f_int (u_1, u_1)
///     K u_3 = - D^2 f_int (u_1, u_2) - 1/6 D^3 f_int (u_1, u_1, u_1)
///
/// K, D^2 f_int and D^3 f_int are the derivatives of the internal forces at u_0. load_series.h has
/// all orders for St. Venant-Kirchhoff's law at rest.
#pragma once

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <memory>

namespace palpable {

/// Const members may be called from several threads at once.
class LoadResponse {
 public:
  /// Factorises K in double precision: 8 bytes for each nonzero of the factor.
  /// @param preloaded  the state u_0; nullptr: the undeformed body. Read during this call only
  /// @throws Error as check_model(), and if K is not positive definite: the body buckles in u_0
  explicit LoadResponse(const SolidModel& model, const Preloaded* preloaded = nullptr);
  ~LoadResponse();
  LoadResponse(LoadResponse&&) noexcept;

  [[nodiscard]] const SolidModel& model() const;
  /// (3 x N) m, u_0.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const;

  /// (3N x k) m, K^-1 loads, 0 in held directions. Solving 16 together costs as much as 4 alone.
  /// @param loads  (3N x k) N; not read in held directions
  [[nodiscard]] Eigen::MatrixXd linear(const Eigen::MatrixXd& loads) const;

  /// (3N) N, 1/2 D^2 f_int (u_1, u_1). One pass over the elements.
  [[nodiscard]] Eigen::VectorXd second_force(const Eigen::VectorXd& u_1) const;
  /// (3N) N, D^2 f_int (u_1, u_2) + 1/6 D^3 f_int (u_1, u_1, u_1). One pass over the elements.
  [[nodiscard]] Eigen::VectorXd third_force(const Eigen::VectorXd& u_1,
                                            const Eigen::VectorXd& u_2) const;
  /// (3N) N, D^2 f_int (v, w), by three passes over the elements.
  [[nodiscard]] Eigen::VectorXd mixed_force(const Eigen::VectorXd& v,
                                            const Eigen::VectorXd& w) const;
  /// (3N) N, K u.
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& u) const;

  /// (3N) 1 where the component is free, 0 where it is held.
  [[nodiscard]] const Eigen::VectorXd& free_mask() const;

 private:
  struct Core;
  std::unique_ptr<const Core> core_;
};

}  // namespace palpable
