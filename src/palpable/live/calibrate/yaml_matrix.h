/// @file
/// Matrices as OpenCV's YAML writes them, with all digits. Included by the files of calibrate/
/// only.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <Eigen/Core>
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// A number that YAML readers take for a real number, with as many digits as it needs.
inline std::string yaml_real(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// "0.0, 1.5"
template <class Numbers>
std::string yaml_list(const Numbers& numbers) {
  std::vector<std::string> texts;
  for (const double value : numbers) texts.push_back(yaml_real(value));
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// @param numbers  row by row
template <class Numbers>
std::string yaml_matrix(std::string_view name, int rows, int columns, const Numbers& numbers) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, rows, columns, yaml_list(numbers));
}

template <class Matrix>
std::vector<double> numbers_by_row(const Matrix& m) {
  std::vector<double> numbers;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) numbers.push_back(m(i, j));
  }
  return numbers;
}

template <class Matrix>
std::string yaml_matrix(std::string_view name, const Matrix& m) {
  return yaml_matrix(name, static_cast<int>(m.rows()), static_cast<int>(m.cols()),
                     numbers_by_row(m));
}

inline std::vector<double> camera_matrix_rows(const PinholeCamera& c) {
  return {c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1};
}

}  // namespace palpable
