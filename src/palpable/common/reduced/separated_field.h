/// @file
/// Online evaluation of a separated (PGD) reduced model.
///
/// Letters used for shapes in this file:
///   N    values in the field: 3 per node for displacement, 6 per node for stress
///   m    modes
///   p    parameters
///   n_j  samples on parameter axis j
#pragma once

#include <Eigen/Core>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// Whether a parameter has values between its samples.
enum class Between {
  kSmooth,  ///< it is a quantity, such as a load level: G is interpolated by a piecewise cubic
  kNothing  ///< it is a choice, such as the number of a site: only the samples themselves exist
};

/// One parameter mu_j together with its mode functions G_i^j, i = 1..m.
struct ParameterAxis {
  std::string name;           ///< shown in messages and in the body file, e.g. "level"
  Eigen::VectorXd samples;    ///< (n_j) strictly increasing, in the unit of the parameter
  Eigen::MatrixXd functions;  ///< (n_j x m) column i is G_i^j at the samples; dimensionless
  Between between = Between::kSmooth;
};

/// A field for all parameter values, as a short sum of products of one-parameter functions,
///
///     u(X, mu)  ~=  sum_{i=1..m}  F_i(X) G_i^1(mu_1) ... G_i^p(mu_p)
///
/// (paper Sec. 3.2; Eq. 4 is one axis of kind kNothing whose samples number the load positions).
/// The bake half makes such fields for the frame loop. Construction is slow and may throw;
/// evaluation costs a multiply-add and reading four bytes for each value of each mode.
///
/// **One block of modes per choice.** If the functions of a choice are indicators (1 at one sample,
/// 0 at all others), each sample has modes of its own and none are shared. The constructor finds
/// this from the functions: at a sample, evaluation sums only the columns from the first to the
/// last that is not zero there. The sites of a body have little in common: 4 modes for each are as
/// accurate as 65 that all sites share.
///
/// The paper does not say how it interpolates in a parameter. Ours is the cubic spline through the
/// samples with not-a-knot ends (spline.h): fourth order, twice continuously differentiable.
///
/// Results are the same bytes on every processor (mode_kernels.h).
///
/// A SeparatedField does not change after construction, so threads may share one.
class SeparatedField {
 public:
  static constexpr int kMostAxes = 8;

  /// @param F     (N x m) column i is F_i; carries the unit of the field (m, Pa, ...). Single
  ///              precision: its rounding, 6e-8, is far below any reduction error, and evaluation
  ///              is bound by the bytes of F.
  /// @param axes  p >= 1 parameters, in the order in which evaluate() reads mu
  ///              At most kMostAxes.
  /// @throws ContractViolation if a table does not have m columns, if a table and its samples
  ///         differ in length, or if the samples do not increase strictly
  SeparatedField(Eigen::MatrixXf F, std::vector<ParameterAxis> axes);

  /// Writes u(X, mu) for one parameter point. Allocates nothing: made for the frame loop.
  ///
  /// @param mu  (p) a quantity beyond the ends of its axis is clamped to the nearest end, because
  ///            the modes were not made from data there and would grow without bound
  /// @param u   (N) overwritten; same unit and same ordering of values as the modes F
  /// @throws ContractViolation if mu or u has the wrong length, or if mu names a choice that is
  ///         not among the samples
  void evaluate(std::span<const double> mu, std::span<float> u) const;

  /// The same for `count` consecutive values from `first` on (a few nodes: cheap).
  void evaluate_part(std::span<const double> mu, int first, std::span<float> u) const;

  /// du/dmu_j, at the cost of evaluate(). 0 beyond the ends of axis j, where u is constant; at the
  /// ends themselves, the one-sided derivative from inside.
  /// @param du  (N) overwritten; the unit of the field by that of the parameter
  /// @throws ContractViolation as evaluate(), or if axis j is a choice
  void derivative(std::span<const double> mu, int j, std::span<float> du) const;

  /// The same for `count` consecutive values from `first` on.
  void derivative_part(std::span<const double> mu, int j, int first, std::span<float> du) const;

  /// The products G_i^1(mu_1) ... G_i^p(mu_p), the factors of the modes in u.
  /// @param weights  (m) overwritten
  void weights(std::span<const double> mu, std::span<float> weights) const;

  /// The field of the first `mode_count` modes only, 1 <= mode_count <= m.
  [[nodiscard]] SeparatedField truncated(int mode_count) const;

  /// The field at the fixed value mu_j = `at`, with one axis less. Exact.
  /// @throws ContractViolation if j is the only axis, or as evaluate() for `at`
  [[nodiscard]] SeparatedField settled(int j, double at) const;

  [[nodiscard]] int value_count() const { return static_cast<int>(F_.rows()); }
  [[nodiscard]] int mode_count() const { return static_cast<int>(F_.cols()); }
  /// The largest number of modes that are summed at one parameter point.
  [[nodiscard]] int largest_block() const;
  /// Modes that are not zero at sample k of a choice: the columns [first, second).
  [[nodiscard]] std::pair<int, int> block(int j, Eigen::Index k) const;
  [[nodiscard]] const Eigen::MatrixXf& modes() const { return F_; }
  [[nodiscard]] const std::vector<ParameterAxis>& axes() const { return axes_; }

 private:
  // The functions of an axis in the order in which evaluation reads them: by sample, then by mode.
  struct Table {
    Eigen::MatrixXd values, slopes;          // (m x n)
    std::vector<std::pair<int, int>> block;  // (n) block() at each sample of a choice
  };

  // One parameter point: the weights of each axis' samples, and the columns to be summed.
  struct Point;

  [[nodiscard]] static Table tabulate(const ParameterAxis& axis);
  [[nodiscard]] Point point(std::span<const double> mu, int derived) const;
  void weigh(const Point& point, int first, std::span<float> weights) const;
  void sum(const Point& point, int first_row, std::span<float> u) const;

  Eigen::MatrixXf F_;                // (N x m)
  std::vector<ParameterAxis> axes_;  // (p)
  std::vector<Table> tables_;        // (p)
};

/// The field with one block of modes per value of a choice: at (c, mu...) it equals blocks[c] at
/// (mu...).
/// @param name    of the choice, e.g. "site"; its samples are 0, 1, ...
/// @param blocks  at least one; all of one length, over the same axes (names, samples, kinds)
/// @throws ContractViolation if they are not
[[nodiscard]] SeparatedField one_block_per_choice(const std::string& name,
                                                  std::span<const SeparatedField> blocks);

}  // namespace palpable
