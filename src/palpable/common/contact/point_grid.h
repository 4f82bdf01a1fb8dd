/// @file
/// A hash grid of points: finds those near a position without testing all.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace palpable {

/// Points by the grid cube that they lie in: all points within one edge of a position lie in the 27
/// cubes around it.
class PointGrid {
 public:
  /// @param edge  m, > 0
  explicit PointGrid(float edge) : edge_(edge) {}

  void add(std::size_t point, const Eigen::Vector3f& place) {
    cubes_[key_of(cube_of(place))].push_back(point);
  }

  /// Calls is_it(point) for the points in the 27 cubes around a position until it returns true. The
  /// points lie less than 2 edges away along each axis. @return whether it did
  template <class IsIt>
  bool any_near(const Eigen::Vector3f& place, const IsIt& is_it) const {
    const Eigen::Vector3i middle = cube_of(place);
    for (int k = 0; k < 27; ++k) {
      const auto cube =
          cubes_.find(key_of(middle + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (cube == cubes_.end()) continue;
      for (const std::size_t point : cube->second) {
        if (is_it(point)) return true;
      }
    }
    return false;
  }

 private:
  [[nodiscard]] Eigen::Vector3i cube_of(const Eigen::Vector3f& x) const {
    return (x / edge_).array().floor().cast<int>();
  }
  static std::uint64_t key_of(const Eigen::Vector3i& cube) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      key = key << 21U | (static_cast<std::uint64_t>(cube[k] + (1 << 20)) & 0x1FFFFFU);
    }
    return key;
  }

  float edge_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cubes_;
};

}  // namespace palpable
