#include "palpable/touch/point_levels.h"

#include "palpable/base/contract.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Points of one set, found by place.
class Cells {
 public:
  Cells(std::span<const Vector3f> places, std::span<const Vector3f> normals, float size)
      : places_(places), normals_(normals), size_(size) {}

  void add(int point) { cells_[key_of(cell_of(places_[index(point)]))].push_back(point); }

  // Whether one of them is within the cells' size of a point, on its side of the body.
  [[nodiscard]] bool has_near(int point) const {
    const Vector3f& x = places_[index(point)];
    const Eigen::Vector3i middle = cell_of(x);
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i cell = middle + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const auto found = cells_.find(key_of(cell));
      if (found == cells_.end()) continue;
      for (const int other : found->second) {
        if ((places_[index(other)] - x).squaredNorm() < size_ * size_ &&
            normals_[index(other)].dot(normals_[index(point)]) > 0) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  [[nodiscard]] Eigen::Vector3i cell_of(const Vector3f& x) const {
    return (x / size_).array().floor().cast<int>();
  }
  static std::uint64_t key_of(const Eigen::Vector3i& cell) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      key = key << 21U | (static_cast<std::uint64_t>(cell[k] + (1 << 20)) & 0x1FFFFFU);
    }
    return key;
  }

  std::span<const Vector3f> places_, normals_;
  float size_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace

std::vector<float> point_levels(const SurfaceMesh& skin, std::span<const SkinPoint> points,
                                double coarsest, double finest) {
  PALPABLE_EXPECT(finest > 0 && finest <= coarsest, "levels from coarse to fine");
  const Eigen::Matrix3Xf vertices = skin.vertices.cast<float>();
  Eigen::Matrix3Xf normals(3, vertices.cols());
  vertex_normals(vertices, skin.triangles, normals);
  std::vector<Vector3f> places, outwards;
  for (const SkinPoint& point : points) {
    places.push_back(point.at(vertices));
    outwards.push_back(point.at(normals));
  }
  std::vector<float> levels(points.size(), 0.0f);
  for (double s = coarsest; s > 0.999 * finest; s /= std::sqrt(2.0)) {
    Cells cells(places, outwards, static_cast<float>(s));
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (levels[p] > 0) cells.add(static_cast<int>(p));
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (levels[p] > 0 || cells.has_near(static_cast<int>(p))) continue;
      levels[p] = static_cast<float>(s);
      cells.add(static_cast<int>(p));
    }
  }
  return levels;
}

}  // namespace palpable
