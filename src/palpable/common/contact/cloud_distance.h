/// @file
/// The seen point nearest to a position, and its distance: the query of Algorithm 1, in two
/// implementations.
///
/// CloudGrid is exact. Voxmap is that of the paper (Sec. 3.4, Figs. 7 and 8): a distance field
/// around the seen points is made anew in each frame, and the body's nodes, the point shell, look
/// it up.
///
/// Body frame, metres. Points of a cloud are finite. Nothing here throws; building allocates
/// nothing once there is room for as many points (reserve()). The same cloud gives the same bytes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace palpable {

enum class DistanceQuery {
  kGrid,   ///< CloudGrid
  kVoxmap  ///< Voxmap
};

/// The result of a query.
struct NearestSeen {
  int index = 0;          ///< into the cloud
  Eigen::Vector3f point;  ///< m, its position
  float squared = 0;      ///< m^2, square of its distance
};

/// The points in the cells of a uniform grid around them, about half the reach wide: a query
/// searches the cells that its reach overlaps.
class CloudGrid {
 public:
  /// @param reach  m, the largest distance of queries
  explicit CloudGrid(double reach);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);

  /// The nearest point whose squared distance is less than `below`, the first one of equally near
  /// points: the same as a search through all points.
  /// @param below  m^2
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x, float below) const;

 private:
  struct Entry {
    Eigen::Vector3f point;
    int index;
  };
  [[nodiscard]] Eigen::Array3i cell_of(const Eigen::Vector3f& x) const;
  [[nodiscard]] std::size_t number_of(int x, int y, int z) const {
    const int number = (z * cells_.y() + y) * cells_.x() + x;  // at most 32^3 cells
    return static_cast<std::size_t>(number);
  }

  float usual_cell_;  // m
  Eigen::AlignedBox3f box_;
  Eigen::Array3f per_metre_ = Eigen::Array3f::Zero();  // cells
  Eigen::Array3i cells_ = Eigen::Array3i::Zero();
  std::vector<int> first_;  // first entry of each cell, and the end of the last one
  std::vector<Entry> entries_;
};

/// A field over the region around a body: each corner of its voxels stores the point of the cloud
/// that is nearest to it. The points are passed from corner to corner in two sweeps, up and down
/// (Danielsson's algorithm), so that some corners store the second nearest.
///
///     d(x) = min over the corners c of the voxel of x  |x - closest(c)|
///
/// This is never less than the true distance. With the corners alone the distance of a touching
/// point would be up to 0.71 voxels too large: the surface may pass through the middle of a voxel,
/// far from the points that are nearest to its corners. So where the result is less than three
/// voxels, the points in the voxel of x and in its neighbours are searched as well; distances below
/// one voxel are then exact. In the whole region the error is less than half a voxel;
/// docs/lab/contact.md has the figures.
class Voxmap {
 public:
  /// @param region  m, the box of the queried positions; beyond it the voxels at its border are
  ///                used
  /// @param reach   m, the largest distance of queries
  /// @param voxel   m, side of a voxel; made larger where the region would have more than 4 million
  ///                of them
  Voxmap(const Eigen::AlignedBox3d& region, double reach, double voxel);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);

  /// As CloudGrid::nearest, with the error described above.
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x, float below) const;

  /// m, side of a voxel.
  [[nodiscard]] double voxel() const { return static_cast<double>(voxel_); }

 private:
  // Contents of a corner.
  struct Corner {
    int closest;    // index into points_; -1: none within the reach
    float squared;  // m^2, its distance
    int first;      // first point in the voxel that begins at the corner; -1: there is none
  };
  [[nodiscard]] Eigen::Array3i voxel_of(const Eigen::Vector3f& x) const;
  [[nodiscard]] std::ptrdiff_t number_of(int x, int y, int z) const {
    return (static_cast<std::ptrdiff_t>(z) * corners_.y() + y) * corners_.x() + x;
  }
  [[nodiscard]] Eigen::Vector3f place_of(int x, int y, int z) const {
    return origin_ + voxel_ * Eigen::Vector3f(Eigen::Vector3i(x, y, z).cast<float>());
  }
  void clear_corners();
  void insert_points();
  void sweep_slice(int z, int from);
  void sweep_row(int y, int z, std::ptrdiff_t slice, std::ptrdiff_t row);

  float voxel_;  // m
  float reach_;  // m
  float far_;    // m^2, square of the distance beyond which corners store no point
  Eigen::Vector3f origin_;
  Eigen::Array3i corners_;  // along each axis
  std::vector<Corner> field_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> index_;     // of each point, into the cloud
  std::vector<int> next_;      // next point of the same voxel; -1: it is the last
  Eigen::AlignedBox3f box_;    // of the points
  Eigen::Array3i low_, high_;  // range of the corners in use, both included
};

/// A CloudGrid or a Voxmap.
class CloudDistance {
 public:
  CloudDistance(DistanceQuery how, const Eigen::AlignedBox3d& region, double reach, double voxel);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x, float below) const;

  /// m, the largest distance of queries.
  [[nodiscard]] double reach() const { return reach_; }

 private:
  double reach_;
  std::variant<CloudGrid, Voxmap> how_;
};

}  // namespace palpable
