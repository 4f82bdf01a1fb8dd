/// @file
/// Sparse PGD: separated modes by regression from scattered samples, for campaigns that did not
/// compute every combination of their parameters (the paper's ref. 46; Ibanez, Abisset, Chavanne,
/// Ammar, Gonzalez, Cueto, Huerta, Duval, Chinesta 2018).
///
///   N    values in one sample (or its coordinates in a basis)     T  samples     p  parameters
///   b_j  basis functions of parameter j                           m  modes
#pragma once

#include "palpable/common/base/progress.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Its name for users, like those of method_name() for the reductions of whole tables.
inline constexpr std::string_view kSparsePgdName = "sparse-pgd";

/// One parameter of the samples, and the basis in which its functions G^j are expanded.
struct SparseAxis {
  enum class Basis {
    kLegendre,  ///< for a quantity: Legendre polynomials on [low, high]
    kNodal      ///< for a choice 0, 1, ... : a free value for each
  };
  std::string name;
  Basis basis = Basis::kLegendre;
  double low = 0, high = 1;  ///< kLegendre: range of the parameter
  bool zero_at_low = false;  ///< kLegendre: all functions are (mu - low) times a polynomial
  int highest_degree = 12;   ///< kLegendre: upper limit of the polynomials' degree
  int choices = 0;           ///< kNodal: how many there are
};

struct SparseSettings {
  int max_modes = 40;
  int folds = 5;        ///< of cross-validation
  int max_passes = 30;  ///< of alternating directions per mode
  /// Share by which a mode, or a higher degree, must lower the cross-validated error to be
  /// accepted.
  double least_gain = 0.01;
  double ridge = 1e-8;     ///< relative to the mean of the normal matrix's diagonal
  std::uint64_t seed = 1;  ///< of the folds
};

/// u(X, mu) ~= sum_i F_i(X) prod_j sum_b a^j_ib phi^j_b(mu_j)
struct SparsePgd {
  std::vector<SparseAxis> axes;
  Eigen::MatrixXd F;                          ///< (N x m)
  std::vector<Eigen::MatrixXd> coefficients;  ///< (p) of (b_j x m)
  std::vector<std::vector<int>> degrees;      ///< (m) of (p): degree of each mode's polynomials
  /// (m) relative error after 1, 2, ... modes: on all samples, and on the samples left out in
  /// cross-validation.
  Eigen::VectorXd training_errors, validation_errors;

  /// (m) G_i^j(mu_j) of one axis.
  [[nodiscard]] Eigen::VectorXd functions_of(Eigen::Index j, double mu_j) const;

  /// (m) prod_j G_i^j(mu_j). @param mu  (p)
  [[nodiscard]] Eigen::VectorXd functions(const Eigen::VectorXd& mu) const;
};

/// (b) phi_0 .. phi_{b-1} of the axis at mu.
[[nodiscard]] Eigen::VectorXd basis_functions(const SparseAxis& axis, double mu);

/// Fits mode after mode by alternating directions on the residual R of the samples:
///
///     min over F, a^1 ... a^p   sum_t | R_t - F prod_j (phi^j(mu_t) . a^j) |^2
///
/// Polynomials begin with degree 1. The degree on an axis is raised only if that lowers the
/// cross-validated error: the first modes are smooth, and later ones, when most of the field is
/// already represented, need higher degrees. After each mode the coefficients of all modes are
/// fitted again, axis by axis, then all F together. Ends when a further mode no longer lowers the
/// cross-validated error.
///
/// Cross-validation: each fold is left out in turn and predicted by a model of the others. A choice
/// (kNodal) that occurs in the left-out samples must also occur in the others; a fold that would
/// leave out all samples of a choice gives some back.
/// @param values  (N x T)
/// @param points  (p x T)
/// @throws Error if the samples are all zero or not finite, or if every sample is the only one of
/// its
///         choice, so that none can be left out
/// @throws ContractViolation for sizes that do not fit, or choices out of range
[[nodiscard]] SparsePgd sparse_pgd(const Eigen::MatrixXd& values, const Eigen::MatrixXd& points,
                                   std::vector<SparseAxis> axes,
                                   const SparseSettings& settings = {},
                                   const Progress& progress = {});

}  // namespace palpable
