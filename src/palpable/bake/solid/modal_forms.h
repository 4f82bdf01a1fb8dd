/// @file
/// The stored energy of a body beyond its stiffness, in some modes, as symmetric forms: what a
/// reduced model needs for the second and third order of its response to a load.
///
///   N  nodes     r  modes     s  leading modes, s <= r
///
///     A_ijk  = D^3 W (U_i, U_j, U_k)             i, j, k < r
///     B_ijkl = D^4 W (U_i, U_j, U_k, U_l)        i, j, k, l < s
///     E_ijkl = B_ijkl - sum_(m < s) ( A_ijm A_klm + A_ikm A_jlm + A_ilm A_jkm )
///
/// at the body's state u_0. With modes that are orthonormal in the stiffness, a load with modal
/// coordinates a has the response q = a - 1/2 A(a, a) - 1/6 E(a, a, a) + ... in them.
#pragma once

#include "palpable/bake/solid/solid_model.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace palpable {

/// Distinct coefficients, i <= j <= k (<= l), ordered by i, then j, then k, then l.
struct ModalForms {
  int modes = 0;                ///< r
  int leading = 0;              ///< s
  std::vector<double> cubic;    ///< A, J
  std::vector<double> quartic;  ///< E, J
};

/// Selection of the integration points that are summed. Points where the modes are steep dominate
/// the forms: under a finger a few per cent of the body contribute nine tenths. The last tenth
/// still matters, because large terms cancel where a thin part bends. The contribution of a point
/// is estimated as its volume times |G|^3, with the gradients G of all modes.
struct FormSampling {
  /// The points that contribute most, together this share of the whole, are all summed.
  double exact = 0.98;
  double neglect = 3e-4;  ///< the points that contribute least, together this share, are left out
  /// The points in between form groups of this size along a curve through the body; one point of
  /// each group represents it. Larger is faster and less accurate.
  int every = 8;
};

/// Makes the forms of many sets of modes of one body; gradients and the law's derivatives are
/// computed once. Const members may be called from several threads at once.
class ModalFormMaker {
 public:
  /// @param rest  (3 x N) m, u_0
  /// @throws Error as check_model(); ContractViolation if an element is inverted at rest
  ModalFormMaker(const SolidModel& model, const Eigen::Matrix3Xd& rest);
  ~ModalFormMaker();
  ModalFormMaker(ModalFormMaker&&) noexcept;

  /// The forms, computed in single precision.
  /// @param modes    (3N x r)
  /// @param leading  s, 0 <= s <= r
  [[nodiscard]] ModalForms make(const Eigen::MatrixXd& modes, int leading,
                                const FormSampling& sampling = {}) const;

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace palpable
