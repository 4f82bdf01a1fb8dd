#include "palpable/common/response/rounded_rows.h"

#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

constexpr float kLargestRounded = 32767.0f;
constexpr std::size_t kAtOnce = 8;  // rows that are read side by side

}  // namespace

RoundedRows rounded(const RowsOfFloats& rows) {
  RoundedRows result;
  result.width = padded(static_cast<std::size_t>(rows.cols()));
  result.values.assign(result.width * static_cast<std::size_t>(rows.rows()), 0);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const float scale =
        (rows.cols() > 0 ? rows.row(i).cwiseAbs().maxCoeff() : 0.0f) / kLargestRounded;
    result.scale.push_back(scale);
    if (!(scale > 0)) continue;
    std::int16_t* to = result.values.data() + static_cast<std::size_t>(i) * result.width;
    for (Eigen::Index k = 0; k < rows.cols(); ++k) {
      to[k] = static_cast<std::int16_t>(std::lround(rows(i, k) / scale));
    }
  }
  return result;
}

void add_rows(const RoundedRows& rows, std::size_t first, std::span<const float> factors,
              std::span<float> sum) {
  std::array<float, kAtOnce> weights;
  for (std::size_t done = 0; done < factors.size(); done += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, factors.size() - done);
    for (std::size_t i = 0; i < count; ++i)
      weights[i] = factors[done + i] * rows.scale[first + done + i];
    best_row_kernels().add_rows(rows.row(first + done), rows.width, {weights.data(), count}, sum);
  }
}

Eigen::MatrixXd as_numbers(const RoundedRows& rows) {
  const Eigen::Map<
      const Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      values(rows.values.data(), static_cast<Eigen::Index>(rows.count()),
             static_cast<Eigen::Index>(rows.width));
  const Eigen::Map<const Eigen::VectorXf> scale(rows.scale.data(), values.rows());
  return scale.cast<double>().asDiagonal() * values.cast<double>();
}

}  // namespace palpable
