#include "palpable/reduced/separated_field.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <utility>

namespace palpable {
namespace {

// Where mu falls on an axis: between samples `left` and `left + 1`, a fraction t of the way.
struct Bracket {
  Eigen::Index left;
  double t;  // in [0, 1]
};

Bracket find_bracket(const ParameterAxis& axis, double mu) {
  const Eigen::VectorXd& samples = axis.samples;
  const double* first = samples.data();
  const Eigen::Index last = samples.size() - 1;

  if (axis.between == Between::kNothing) {
    const Eigen::Index at = std::lower_bound(first, first + last, mu) - first;
    PALPABLE_EXPECT(samples[at] == mu, "a choice is one of the samples");
    return {at, 0.0};
  }
  PALPABLE_EXPECT(mu == mu, "a parameter is a number");
  if (last == 0 || mu <= samples[0]) return {0, 0.0};
  if (mu >= samples[last]) return {last - 1, 1.0};
  const Eigen::Index left = std::upper_bound(first, first + last, mu) - first - 1;
  return {left, (mu - samples[left]) / (samples[left + 1] - samples[left])};
}

// Slope of the parabola through three samples, at the one numbered `at` (0, 1 or 2).
double parabola_slope(const Eigen::VectorXd& x, const auto& g, Eigen::Index first, int at) {
  const double h0 = x[first + 1] - x[first], h1 = x[first + 2] - x[first + 1];
  const double s0 = (g[first + 1] - g[first]) / h0, s1 = (g[first + 2] - g[first + 1]) / h1;
  const double curvature = (s1 - s0) / (h0 + h1);  // divided difference of second order
  if (at == 0) return s0 - h0 * curvature;
  if (at == 1) return s0 + h0 * curvature;
  return s1 + h1 * curvature;
}

// dG/dmu at sample k, from the sample's neighbours.
double slope(const ParameterAxis& axis, const auto& g, Eigen::Index k) {
  const Eigen::Index n = axis.samples.size();
  if (n == 2) return (g[1] - g[0]) / (axis.samples[1] - axis.samples[0]);
  const Eigen::Index first = std::clamp<Eigen::Index>(k - 1, 0, n - 3);
  return parabola_slope(axis.samples, g, first, static_cast<int>(k - first));
}

// G_i(mu); an axis with one sample is constant.
double parameter_function(const ParameterAxis& axis, double mu, Eigen::Index i) {
  const auto [left, t] = find_bracket(axis, mu);
  const auto g = axis.functions.col(i);
  if (t == 0.0) return g[left];
  if (t == 1.0) return g[left + 1];
  // Cubic Hermite polynomial on [left, left + 1].
  const double h = axis.samples[left + 1] - axis.samples[left];
  const double m0 = h * slope(axis, g, left), m1 = h * slope(axis, g, left + 1);
  const double rise = g[left + 1] - g[left];
  return g[left] + t * (m0 + t * (3.0 * rise - 2.0 * m0 - m1 + t * (m0 + m1 - 2.0 * rise)));
}

bool strictly_increasing(const Eigen::VectorXd& x) {
  return std::adjacent_find(x.data(), x.data() + x.size(),
                            [](double a, double b) { return !(a < b); }) == x.data() + x.size();
}

}  // namespace

SeparatedField::SeparatedField(Eigen::MatrixXf F, std::vector<ParameterAxis> axes)
    : F_(std::move(F)), axes_(std::move(axes)) {
  PALPABLE_EXPECT(F_.cols() >= 1, "a separated field has at least one mode");
  PALPABLE_EXPECT(!axes_.empty(), "a separated field has at least one parameter");
  for (const ParameterAxis& axis : axes_) {
    PALPABLE_EXPECT(axis.functions.cols() == F_.cols(), "each axis has one function per mode");
    PALPABLE_EXPECT(axis.functions.rows() == axis.samples.size(), "one row of G per sample");
    PALPABLE_EXPECT(axis.samples.size() >= 1, "an axis has at least one sample");
    PALPABLE_EXPECT(axis.samples.size() > 1 || axis.samples[0] == axis.samples[0],
                    "samples are numbers");
    PALPABLE_EXPECT(strictly_increasing(axis.samples), "samples increase strictly");
  }
}

float SeparatedField::weight(std::span<const double> mu, Eigen::Index i) const {
  double product = 1.0;  // G_i^1(mu_1) ... G_i^p(mu_p)
  for (std::size_t j = 0; j < axes_.size(); ++j) product *= parameter_function(axes_[j], mu[j], i);
  return static_cast<float>(product);
}

void SeparatedField::weights(std::span<const double> mu, std::span<float> weights) const {
  PALPABLE_EXPECT(mu.size() == axes_.size(), "one value per parameter");
  PALPABLE_EXPECT(weights.size() == static_cast<std::size_t>(F_.cols()), "one weight per mode");
  for (Eigen::Index i = 0; i < F_.cols(); ++i) {
    weights[static_cast<std::size_t>(i)] = weight(mu, i);
  }
}

void SeparatedField::evaluate(std::span<const double> mu, std::span<float> u) const {
  PALPABLE_EXPECT(u.size() == static_cast<std::size_t>(F_.rows()), "one value per row of F");
  evaluate_part(mu, 0, u);
}

void SeparatedField::evaluate_part(std::span<const double> mu, int first,
                                   std::span<float> u) const {
  PALPABLE_EXPECT(mu.size() == axes_.size(), "one value per parameter");
  PALPABLE_EXPECT(first >= 0 && static_cast<std::size_t>(first) + u.size() <=
                                    static_cast<std::size_t>(F_.rows()),
                  "the part lies within the field");
  const auto count = static_cast<Eigen::Index>(u.size());
  Eigen::Map<Eigen::VectorXf> field(u.data(), count);
  field.setZero();
  for (Eigen::Index i = 0; i < F_.cols(); ++i) {
    field.noalias() += weight(mu, i) * F_.col(i).segment(first, count);
  }
}

SeparatedField SeparatedField::truncated(int mode_count) const {
  PALPABLE_EXPECT(1 <= mode_count && mode_count <= this->mode_count(), "mode_count is in [1, m]");
  std::vector<ParameterAxis> axes = axes_;
  for (ParameterAxis& axis : axes) axis.functions = axis.functions.leftCols(mode_count).eval();
  return {F_.leftCols(mode_count), std::move(axes)};
}

}  // namespace palpable
