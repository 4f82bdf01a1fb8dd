/// @file
/// Signed distance to a closed skin that deforms, for contact between bodies.
///
///   V  vertices     T  triangles
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {

/// m: the deepest penetration between two bodies that is detected.
inline constexpr float kDeepInside = 0.02f;

/// The position on the skin that is nearest to a query point.
struct NearestOnSkin {
  float distance = 0;  ///< m, negative inside
  int triangle = 0;
  Eigen::Vector3f weights = Eigen::Vector3f::Zero();  ///< of its corners, sum 1
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, of the face, edge or corner
};

/// The smooth skin that the triangles approximate.
struct RoundedSkin {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, outwards; continuous along the skin
  Eigen::Matrix3f curvature = Eigen::Matrix3f::Zero();  ///< 1/m, dn/dx; symmetric
};

/// A tree of boxes over the triangles, made once; the positions of the vertices are updated by
/// move(). The sign of a distance is that of the angle-weighted normal of the nearest face, edge or
/// corner (as in surface_distance.h, which is exact in double precision but made anew for each
/// shape).
class MovingSurface {
 public:
  /// @param skin  closed; at rest
  explicit MovingSurface(const SurfaceMesh& skin);

  /// @param vertices  (3 x V) m, present positions. Copied; allocates nothing
  void move(const Eigen::Matrix3Xf& vertices);

  /// Nothing if the skin is farther than `reach`. Allocates nothing.
  [[nodiscard]] std::optional<NearestOnSkin> nearest(const Eigen::Vector3f& x, float reach) const;
  /// The vertex normals, interpolated in the triangle, so that the direction of a force does not
  /// jump when a point slides over an edge. Edges of more than 40 degrees stay sharp.
  [[nodiscard]] RoundedSkin rounded_at(const NearestOnSkin& found) const;
  /// Whether the box of some triangles is nearer than `reach`: a cheaper query.
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& x, float reach) const;

  /// The vertices on edges of more than 40 degrees, in rising order.
  [[nodiscard]] std::vector<int> sharp_vertices() const;
  /// Unit, outwards: the mean of the adjacent faces' normals, weighted by their angles.
  [[nodiscard]] Eigen::Vector3f vertex_normal(int v) const;
  /// The position as a weighted mean of its triangle's corners; the area is not set.
  [[nodiscard]] SkinPoint place_of(const NearestOnSkin& found) const {
    const Eigen::Vector3i c = corners(found.triangle);
    return {{c[0], c[1], c[2]}, found.weights, 0};
  }
  [[nodiscard]] Eigen::Index vertex_count() const { return vertices_.cols(); }              ///< V
  [[nodiscard]] Eigen::Vector3f vertex(int v) const { return vertices_.col(v).head<3>(); }  ///< m
  [[nodiscard]] Eigen::Vector3i corners(int triangle) const { return triangles_.col(triangle); }
  [[nodiscard]] Eigen::AlignedBox3f bounds() const {
    const Box& all = boxes_.front();
    return {all.low.head<3>().matrix(), all.high.head<3>().matrix()};
  }

 private:
  // A leaf holds the triangles order_[first .. first + count - 1], and the corners of these are
  // corners_[second ..] up to those of the next leaf. An inner box has count 0; its halves are the
  // next box and `second`.
  struct Box {
    Eigen::Array4f low, high;  // the fourth number is 0
    int first = 0, count = 0, second = 0;
    [[nodiscard]] float square_to(const Eigen::Array4f& x) const {
      return (low - x).max(x - high).max(0.0f).matrix().squaredNorm();
    }
  };
  struct Best {
    float square;
    int triangle;
    Eigen::Vector3f weights;
  };
  int build(int first, int count, const std::vector<Eigen::Vector3f>& centres);
  void find_corners();
  void find_adjacent();
  void look_into(int box, const Eigen::Array4f& x, Best& best) const;
  [[nodiscard]] Eigen::Vector3f face_normal(int triangle) const;
  [[nodiscard]] Eigen::Vector3f normal_at(int triangle, const Eigen::Vector3f& weights) const;
  [[nodiscard]] Eigen::Vector3f normal_around(int v, const Eigen::Vector3f& way,
                                              float least_cosine) const;

  Eigen::Matrix3Xi triangles_;
  Eigen::Matrix4Xf vertices_;  // the fourth number is 0
  std::vector<int> order_;
  std::vector<int> corners_;  // the vertices of each leaf, each once
  std::vector<Box> boxes_;
  std::vector<std::array<int, 3>> across_;  // (T) triangle beyond the edge from corner k to k + 1
  std::vector<int> first_, around_;  // triangles of v: around_[first_[v]] .. [first_[v + 1] - 1]
};

}  // namespace palpable
