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

/// What a parameter may be between two samples.
enum class Between {
  kSmooth,  ///< a quantity, such as a load level: G is interpolated by a piecewise cubic
  kNothing  ///< a choice, such as the number of a contact site: only the samples themselves exist
};

/// One parameter mu_j together with its mode functions G_i^j, i = 1..m.
struct ParameterAxis {
  std::string name;           ///< shown in messages and in the body file, e.g. "level"
  Eigen::VectorXd samples;    ///< (n_j) strictly increasing, in the unit of the parameter
  Eigen::MatrixXd functions;  ///< (n_j x m) column i is G_i^j at the samples; dimensionless
  Between between = Between::kSmooth;
};

/// A field known for every parameter value as a short sum of products of one-parameter functions,
///
///     u(X, mu)  ~=  sum_{i=1..m}  F_i(X) G_i^1(mu_1) ... G_i^p(mu_p)
///
/// (paper Sec. 3.2; Eq. 4 is one axis of kind kNothing whose samples number the load positions).
/// It is what the bake half hands to the frame loop: building one is slow and may throw,
/// evaluating one costs a multiply-add and four bytes of reading for each value of each mode.
///
/// **One block of modes per choice.** Where the functions of a choice are indicators (1 at one
/// sample, 0 at all others), a sample has modes of its own and nothing is shared. So much is found
/// out from the functions: at a sample only the columns from the first to the last that is not zero
/// there are summed. Sites of a body share almost nothing: 4 modes each do what 65 for all do.
///
/// The paper does not say how it interpolates in a parameter. Ours is the cubic spline through the
/// samples with not-a-knot ends (spline.h): fourth order, twice continuously differentiable.
///
/// Results are the same bytes on every processor (mode_kernels.h).
///
/// A SeparatedField never changes after construction, so threads may share one freely.
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
  /// @param mu  (p) a quantity beyond the ends of its axis is taken as the nearest end, because the
  ///            model has seen nothing there and extrapolated modes grow without bound
  /// @param u   (N) overwritten; same unit and same ordering of values as the modes F
  /// @throws ContractViolation if mu or u has the wrong length, or if mu names a choice that is
  ///         not among the samples
  void evaluate(std::span<const double> mu, std::span<float> u) const;

  /// The same for `count` consecutive values from `first` on (a few nodes: cheap).
  void evaluate_part(std::span<const double> mu, int first, std::span<float> u) const;

  /// du/dmu_j, at the cost of evaluate(). Beyond the ends of its axis u is constant, so 0; at the
  /// ends themselves, from inside.
  /// @param du  (N) overwritten; the unit of the field by that of the parameter
  /// @throws ContractViolation as evaluate(), or if axis j is a choice
  void derivative(std::span<const double> mu, int j, std::span<float> du) const;

  /// The same for `count` consecutive values from `first` on.
  void derivative_part(std::span<const double> mu, int j, int first, std::span<float> du) const;

  /// The products G_i^1(mu_1) ... G_i^p(mu_p), which are all of u that depends on mu.
  /// @param weights  (m) overwritten
  void weights(std::span<const double> mu, std::span<float> weights) const;

  /// The same field cut after its first `mode_count` modes, 1 <= mode_count <= m.
  [[nodiscard]] SeparatedField truncated(int mode_count) const;

  /// The same field where mu_j always is `at`: one axis less. Exact.
  /// @throws ContractViolation if j is the only axis, or as evaluate() for `at`
  [[nodiscard]] SeparatedField settled(int j, double at) const;

  [[nodiscard]] int value_count() const { return static_cast<int>(F_.rows()); }
  [[nodiscard]] int mode_count() const { return static_cast<int>(F_.cols()); }
  /// The most modes that one parameter point sums.
  [[nodiscard]] int largest_block() const;
  /// Modes that are not zero at sample k of a choice: the columns [first, second).
  [[nodiscard]] std::pair<int, int> block(int j, Eigen::Index k) const;
  [[nodiscard]] const Eigen::MatrixXf& modes() const { return F_; }
  [[nodiscard]] const std::vector<ParameterAxis>& axes() const { return axes_; }

 private:
  // What evaluation reads of an axis: sample by sample, modes side by side.
  struct Table {
    Eigen::MatrixXd values, slopes;          // (m x n)
    std::vector<std::pair<int, int>> block;  // (n) columns that are not zero there, of a choice
  };

  // One parameter point: of each axis the weights of its samples, and the columns to be summed.
  struct Point;

  [[nodiscard]] static Table tabulate(const ParameterAxis& axis);
  [[nodiscard]] Point point(std::span<const double> mu, int derived) const;
  void weigh(const Point& point, int first, std::span<float> weights) const;
  void sum(const Point& point, int first_row, std::span<float> u) const;

  Eigen::MatrixXf F_;                // (N x m)
  std::vector<ParameterAxis> axes_;  // (p)
  std::vector<Table> tables_;        // (p)
};

/// One block of modes per value of a choice: at (c, mu...) it is blocks[c] at (mu...).
/// @param name    of the choice, e.g. "site"; its samples are 0, 1, ...
/// @param blocks  at least one; all of one length, over the same axes (names, samples, kinds)
/// @throws ContractViolation if they are not
[[nodiscard]] SeparatedField one_block_per_choice(const std::string& name,
                                                  std::span<const SeparatedField> blocks);

}  // namespace palpable
