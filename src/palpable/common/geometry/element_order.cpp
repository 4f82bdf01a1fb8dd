#include "palpable/common/geometry/element_order.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace palpable {
namespace {

constexpr int kBits = 16;  // per axis: cells finer than any mesh that fits into memory

// Interleaves the bits of x, y and z, highest first.
std::uint64_t interleaved(const Eigen::Vector3d& cell) {
  std::uint64_t key = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    for (int i = 0; i < 3; ++i) {
      key = 2 * key + ((static_cast<std::uint64_t>(cell[i]) >> bit) & 1);
    }
  }
  return key;
}

}  // namespace

std::vector<int> order_along_curve(const Eigen::Matrix3Xd& points) {
  std::vector<int> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  if (order.empty()) return order;
  const Eigen::Vector3d low = points.rowwise().minCoeff();
  const double extent = (points.rowwise().maxCoeff() - low).maxCoeff();
  const double cells = extent > 0.0 ? ((1 << kBits) - 1) / extent : 0.0;
  std::vector<std::uint64_t> keys;
  keys.reserve(order.size());
  for (const auto& point : points.colwise()) keys.push_back(interleaved(cells * (point - low)));
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return keys[i] < keys[j]; });
  return order;
}

}  // namespace palpable
