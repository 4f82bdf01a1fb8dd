#include "palpable/common/reduced/separated_field.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/mode_kernels.h"
#include "palpable/common/reduced/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

// Number of modes whose weights are computed, on the stack, before the modes are summed.
constexpr int kModesAtOnce = 256;

bool strictly_increasing(const Eigen::VectorXd& x) {
  return std::adjacent_find(x.data(), x.data() + x.size(),
                            [](double a, double b) { return !(a < b); }) == x.data() + x.size();
}

// The sample that equals `mu`: a choice has no values between its samples.
CubicWeights chosen(const ParameterAxis& axis, double mu) {
  const double* first = axis.samples.data();
  const Eigen::Index last = axis.samples.size() - 1;
  const Eigen::Index at = std::lower_bound(first, first + last, mu) - first;
  PALPABLE_EXPECT(axis.samples[at] == mu, "a choice is one of the samples");
  return {.left = at, .right = at};
}

}  // namespace

struct SeparatedField::Point {
  std::array<CubicWeights, kMostAxes> axes;
  int derived = -1;        // the axis that is differentiated
  int first = 0, end = 0;  // columns
};

SeparatedField::Table SeparatedField::tabulate(const ParameterAxis& axis) {
  Table table{axis.functions.transpose(), {}, {}};
  if (axis.between == Between::kSmooth) {
    table.slopes = spline_slopes(axis.samples, axis.functions).transpose();
    return table;
  }
  const Eigen::Index m = table.values.rows();
  for (Eigen::Index k = 0; k < table.values.cols(); ++k) {
    Eigen::Index first = 0, end = m;
    while (first < end && table.values(first, k) == 0.0) ++first;
    while (end > first && table.values(end - 1, k) == 0.0) --end;
    table.block.emplace_back(static_cast<int>(first), static_cast<int>(end));
  }
  return table;
}

SeparatedField::SeparatedField(Eigen::MatrixXf F, std::vector<ParameterAxis> axes)
    : F_(std::move(F)), axes_(std::move(axes)) {
  PALPABLE_EXPECT(F_.cols() >= 1, "a separated field has at least one mode");
  PALPABLE_EXPECT(!axes_.empty(), "a separated field has at least one parameter");
  PALPABLE_EXPECT(axes_.size() <= kMostAxes, "a separated field has at most 8 parameters");
  for (const ParameterAxis& axis : axes_) {
    PALPABLE_EXPECT(axis.functions.cols() == F_.cols(), "each axis has one function per mode");
    PALPABLE_EXPECT(axis.functions.rows() == axis.samples.size(), "one row of G per sample");
    PALPABLE_EXPECT(axis.samples.size() >= 1, "an axis has at least one sample");
    PALPABLE_EXPECT(axis.samples.size() > 1 || axis.samples[0] == axis.samples[0],
                    "samples are numbers");
    PALPABLE_EXPECT(strictly_increasing(axis.samples), "samples increase strictly");
    tables_.push_back(tabulate(axis));
  }
}

int SeparatedField::largest_block() const {
  int largest = mode_count();
  for (const Table& table : tables_) {
    if (table.block.empty()) continue;
    int most = 0;
    for (const auto& [first, end] : table.block) most = std::max(most, end - first);
    largest = std::min(largest, most);
  }
  return largest;
}

std::pair<int, int> SeparatedField::block(int j, Eigen::Index k) const {
  PALPABLE_EXPECT(j >= 0 && static_cast<std::size_t>(j) < axes_.size(), "the axis exists");
  const Table& table = tables_[j];
  if (table.block.empty()) return {0, mode_count()};
  PALPABLE_EXPECT(k >= 0 && k < static_cast<Eigen::Index>(table.block.size()), "the sample exists");
  return table.block[k];
}

SeparatedField::Point SeparatedField::point(std::span<const double> mu, int derived) const {
  PALPABLE_EXPECT(mu.size() == axes_.size(), "one value per parameter");
  Point at;
  at.derived = derived;
  at.end = mode_count();
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    if (axes_[j].between == Between::kSmooth) {
      at.axes[j] = cubic_weights(axes_[j].samples, mu[j]);
      continue;
    }
    at.axes[j] = chosen(axes_[j], mu[j]);
    const auto [first, end] = tables_[j].block[at.axes[j].left];
    at.first = std::max(at.first, first);
    at.end = std::min(at.end, end);
  }
  at.end = std::max(at.end, at.first);
  return at;
}

// Computes G_i^1 ... G_i^p for weights.size() modes from column `first` on.
void SeparatedField::weigh(const Point& point, int first, std::span<float> weights) const {
  std::array<double, kModesAtOnce> product;
  const std::size_t m = weights.size();
  std::fill_n(product.begin(), m, 1.0);
  for (std::size_t j = 0; j < axes_.size(); ++j) {
    const CubicWeights& c = point.axes[j];
    const double* w = static_cast<int>(j) == point.derived ? c.slope : c.value;
    const Table& table = tables_[j];
    const double* left = table.values.col(c.left).data() + first;
    if (table.slopes.size() == 0) {
      for (std::size_t i = 0; i < m; ++i) product[i] *= w[0] * left[i];
      continue;
    }
    const double* left_slope = table.slopes.col(c.left).data() + first;
    const double* right = table.values.col(c.right).data() + first;
    const double* right_slope = table.slopes.col(c.right).data() + first;
    for (std::size_t i = 0; i < m; ++i) {
      product[i] *= w[0] * left[i] + w[1] * left_slope[i] + w[2] * right[i] + w[3] * right_slope[i];
    }
  }
  for (std::size_t i = 0; i < m; ++i) weights[i] = static_cast<float>(product[i]);
}

void SeparatedField::sum(const Point& point, int first_row, std::span<float> u) const {
  PALPABLE_EXPECT(first_row >= 0 && static_cast<std::size_t>(first_row) + u.size() <=
                                        static_cast<std::size_t>(F_.rows()),
                  "the part lies within the field");
  const ModeKernels& kernels = mode_kernels().front();
  std::array<float, kModesAtOnce> weights;
  int first = point.first;
  do {
    const int count = std::min(kModesAtOnce, point.end - first);
    const auto some = std::span(weights).first(static_cast<std::size_t>(count));
    weigh(point, first, some);
    kernels.sum({F_.data() + Eigen::Index{first} * F_.rows() + first_row,
                 static_cast<std::size_t>(F_.rows()), some.size()},
                some.data(), first > point.first, u);
    first += count;
  } while (first < point.end);
}

void SeparatedField::weights(std::span<const double> mu, std::span<float> weights) const {
  PALPABLE_EXPECT(weights.size() == static_cast<std::size_t>(F_.cols()), "one weight per mode");
  const Point at = point(mu, -1);
  std::fill(weights.begin(), weights.end(), 0.0f);
  for (int first = at.first; first < at.end; first += kModesAtOnce) {
    const int count = std::min(kModesAtOnce, at.end - first);
    weigh(at, first,
          weights.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)));
  }
}

void SeparatedField::evaluate(std::span<const double> mu, std::span<float> u) const {
  PALPABLE_EXPECT(u.size() == static_cast<std::size_t>(F_.rows()), "one value per row of F");
  sum(point(mu, -1), 0, u);
}

void SeparatedField::evaluate_part(std::span<const double> mu, int first,
                                   std::span<float> u) const {
  sum(point(mu, -1), first, u);
}

void SeparatedField::derivative(std::span<const double> mu, int j, std::span<float> du) const {
  PALPABLE_EXPECT(du.size() == static_cast<std::size_t>(F_.rows()), "one value per row of F");
  derivative_part(mu, j, 0, du);
}

void SeparatedField::derivative_part(std::span<const double> mu, int j, int first,
                                     std::span<float> du) const {
  PALPABLE_EXPECT(
      j >= 0 && static_cast<std::size_t>(j) < axes_.size() && axes_[j].between == Between::kSmooth,
      "the parameter is a quantity");
  sum(point(mu, j), first, du);
}

SeparatedField SeparatedField::truncated(int mode_count) const {
  PALPABLE_EXPECT(1 <= mode_count && mode_count <= this->mode_count(), "mode_count is in [1, m]");
  std::vector<ParameterAxis> axes = axes_;
  for (ParameterAxis& axis : axes) axis.functions = axis.functions.leftCols(mode_count).eval();
  return {F_.leftCols(mode_count), std::move(axes)};
}

SeparatedField SeparatedField::settled(int j, double at) const {
  PALPABLE_EXPECT(j >= 0 && static_cast<std::size_t>(j) < axes_.size() && axes_.size() > 1,
                  "the axis exists and is not the only one");
  const auto index = static_cast<std::size_t>(j);
  const CubicWeights c = axes_[index].between == Between::kSmooth
                             ? cubic_weights(axes_[index].samples, at)
                             : chosen(axes_[index], at);
  const Table& table = tables_[index];
  Eigen::VectorXd G = c.value[0] * table.values.col(c.left);
  if (table.slopes.size() > 0) {
    G += c.value[1] * table.slopes.col(c.left) + c.value[2] * table.values.col(c.right) +
         c.value[3] * table.slopes.col(c.right);
  }
  std::vector<ParameterAxis> axes = axes_;
  axes.erase(axes.begin() + j);
  // The factor G goes to another axis: preferably to one of a quantity, so that the indicators of a
  // choice stay indicators.
  std::size_t carrier = 0;
  while (carrier + 1 < axes.size() && axes[carrier].between != Between::kSmooth) ++carrier;
  axes[carrier].functions = axes[carrier].functions * G.asDiagonal();
  return {F_, std::move(axes)};
}

SeparatedField one_block_per_choice(const std::string& name,
                                    std::span<const SeparatedField> blocks) {
  PALPABLE_EXPECT(!blocks.empty(), "there is at least one block");
  Eigen::Index m = 0;
  for (const SeparatedField& block : blocks) {
    PALPABLE_EXPECT(block.value_count() == blocks[0].value_count(), "blocks have one length");
    PALPABLE_EXPECT(block.axes().size() == blocks[0].axes().size(), "blocks share their axes");
    m += block.mode_count();
  }
  const auto S = static_cast<Eigen::Index>(blocks.size());
  Eigen::MatrixXf F(blocks[0].value_count(), m);
  std::vector<ParameterAxis> axes{{name, Eigen::VectorXd::LinSpaced(S, 0.0, double(S - 1)),
                                   Eigen::MatrixXd::Zero(S, m), Between::kNothing}};
  for (ParameterAxis axis : blocks[0].axes()) {
    axis.functions.resize(axis.samples.size(), m);
    axes.push_back(std::move(axis));
  }
  Eigen::Index first = 0;
  for (Eigen::Index c = 0; c < S; ++c) {
    const SeparatedField& block = blocks[c];
    const Eigen::Index count = block.mode_count();
    F.middleCols(first, count) = block.modes();
    axes[0].functions.row(c).segment(first, count).setOnes();
    for (std::size_t j = 1; j < axes.size(); ++j) {
      const ParameterAxis& axis = block.axes()[j - 1];
      PALPABLE_EXPECT(axis.name == axes[j].name && axis.samples == axes[j].samples &&
                          axis.between == axes[j].between,
                      "blocks share their axes");
      axes[j].functions.middleCols(first, count) = axis.functions;
    }
    first += count;
  }
  return {std::move(F), std::move(axes)};
}

}  // namespace palpable
