/// @file
/// Tables of numbers in 16 bits.
#pragma once

#include "palpable/common/base/row_kernels.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// Rows of 16-bit numbers, each row with one factor.
struct RoundedRows {
  std::size_t width = 0;             ///< numbers in a row, a multiple of 16
  std::vector<std::int16_t> values;  ///< row by row
  std::vector<float> scale;          ///< by row, the unit of its values

  [[nodiscard]] std::size_t count() const { return scale.size(); }
  [[nodiscard]] const std::int16_t* row(std::size_t i) const { return values.data() + i * width; }
};

using RowsOfFloats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// @param rows  (n x width), padded with zeros to a multiple of 16
[[nodiscard]] RoundedRows rounded(const RowsOfFloats& rows);

/// (n x width) values times factors.
[[nodiscard]] Eigen::MatrixXd as_numbers(const RoundedRows& rows);

/// The three rows of a node (x, y, z) times a vector: row 3 node + d is component d.
[[nodiscard]] inline Eigen::Vector3f at_node(const RoundedRows& rows, std::size_t node,
                                             std::span<const float> vector) {
  Eigen::Vector3f values;
  best_row_kernels().dots(rows.row(3 * node), 3, vector, values.data());
  return values.cwiseProduct(Eigen::Map<const Eigen::Vector3f>(rows.scale.data() + 3 * node));
}

/// sum += sum_i factors_i row (first + i).
void add_rows(const RoundedRows& rows, std::size_t first, std::span<const float> factors,
              std::span<float> sum);

}  // namespace palpable
