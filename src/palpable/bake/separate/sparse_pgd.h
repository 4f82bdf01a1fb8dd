/// @file
/// Sparse PGD: separated modes by regression from scattered samples, for campaigns that did not (or
/// could not) visit every combination of their parameters (the paper's ref. 46; Ibanez, Abisset,
/// Chavanne, Ammar, Gonzalez, Cueto, Huerta, Duval, Chinesta 2018).
///
///   N    values in one sample (or its coordinates in a basis)     T  samples     p  parameters
///   b_j  functions on parameter j                                 m  modes
#pragma once

#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// What people call it, as method_name() of the reductions of whole tables.
inline constexpr std::string_view kSparsePgdName = "sparse-pgd";

/// One parameter of the samples and what its functions G^j may be.
struct SparseAxis {
  enum class Basis {
    kLegendre,  ///< a quantity: Legendre polynomials on [low, high]
    kNodal      ///< a choice 0, 1, ... : one value each
  };
  std::string name;
  Basis basis = Basis::kLegendre;
  double low = 0, high = 1;  ///< kLegendre
  bool zero_at_low = false;  ///< kLegendre: all functions are (mu - low) times a polynomial
  int highest_degree = 12;   ///< kLegendre: of the polynomials, bounded
  int choices = 0;           ///< kNodal
};

struct SparseSettings {
  int max_modes = 40;
  int folds = 5;        ///< of cross-validation
  int max_passes = 30;  ///< of alternating directions per mode
  /// A mode is kept while it lowers the cross-validated error by this part.
  double least_gain = 0.01;
  double ridge = 1e-8;     ///< relative to the mean of the normal matrix's diagonal
  std::uint64_t seed = 1;  ///< of the folds
};

/// u(X, mu) ~= sum_i F_i(X) prod_j sum_b a^j_ib phi^j_b(mu_j)
struct SparsePgd {
  std::vector<SparseAxis> axes;
  Eigen::MatrixXd F;                          ///< (N x m)
  std::vector<Eigen::MatrixXd> coefficients;  ///< (p) of (b_j x m)
  std::vector<std::vector<int>> degrees;      ///< (m) of (p): how far each mode's polynomials go
  /// (m) relative pooled error on the samples, and on those that folds leave out, after 1, 2, ...
  /// modes.
  Eigen::VectorXd training_errors, validation_errors;

  /// (m) G_i^j(mu_j) of one axis.
  [[nodiscard]] Eigen::VectorXd functions_of(Eigen::Index j, double mu_j) const;

  /// (m) prod_j G_i^j(mu_j). @param mu  (p)
  [[nodiscard]] Eigen::VectorXd functions(const Eigen::VectorXd& mu) const;
};

/// (b) phi_0 .. phi_{b-1} of the axis at mu.
[[nodiscard]] Eigen::VectorXd basis_functions(const SparseAxis& axis, double mu);

/// Mode by mode, alternating directions on the residual R of the samples:
///
///     min over F, a^1 ... a^p   sum_t | R_t - F prod_j (phi^j(mu_t) . a^j) |^2
///
/// Polynomials begin with degree 1 and only go further, axis by axis, where a fit to the other
/// folds predicts a fold better for it: low modes, of which there is most to know, are smooth, and
/// high degrees come when enough of the field is taken away. After each mode all coefficients and
/// then all F are fitted once more together. Ends when a further mode no longer helps in
/// cross-validation.
/// @param values  (N x T)
/// @param points  (p x T)
/// A fold learns at least one sample of each choice that it is asked about.
/// @throws Error if the samples are all zero or not finite, or no choice has two of them
/// @throws ContractViolation for sizes that do not fit, or choices out of range
[[nodiscard]] SparsePgd sparse_pgd(const Eigen::MatrixXd& values, const Eigen::MatrixXd& points,
                                   std::vector<SparseAxis> axes,
                                   const SparseSettings& settings = {},
                                   const Progress& progress = {});

}  // namespace palpable
