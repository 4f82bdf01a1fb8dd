#include "palpable/bake/solid/block_matrix.h"

#include <algorithm>

namespace palpable {

int BlockPattern::find(int row, int wanted) const {
  const auto begin = column.begin() + row_start[row];
  const auto end = column.begin() + row_start[row + 1];
  const auto found = std::lower_bound(begin, end, wanted);
  return found != end && *found == wanted ? static_cast<int>(found - column.begin()) : -1;
}

BlockMatrix::BlockMatrix(const BlockPattern& pattern)
    : pattern_(&pattern), values_(9 * pattern.column.size(), 0.0) {}

void BlockMatrix::set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  const int M = pattern_->rows();
  y.resize(3 * M);
  const double* K = values_.data();
  const int* column = pattern_->column.data();
  const int* start = pattern_->row_start.data();
  for (int r = 0; r < M; ++r) {
    double y0 = 0.0, y1 = 0.0, y2 = 0.0;
    for (int p = start[r]; p < start[r + 1]; ++p) {
      const double* B = K + 9 * static_cast<std::ptrdiff_t>(p);
      const double* v = x.data() + 3 * static_cast<std::ptrdiff_t>(column[p]);
      y0 += B[0] * v[0] + B[3] * v[1] + B[6] * v[2];
      y1 += B[1] * v[0] + B[4] * v[1] + B[7] * v[2];
      y2 += B[2] * v[0] + B[5] * v[1] + B[8] * v[2];
    }
    y[3 * r] = y0;
    y[3 * r + 1] = y1;
    y[3 * r + 2] = y2;
  }
}

}  // namespace palpable
