/// @file
/// How far the nearest seen point is from a place, and which it is: the query of Algorithm 1,
/// twice.
///
/// CloudGrid is exact. Voxmap is the paper's (Sec. 3.4, Figs. 7 and 8): what is seen is equipped
/// with a distance field, made anew in each frame, and the body's nodes, the point shell, look it
/// up.
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

/// A seen point, as a query finds it.
struct NearestSeen {
  int index = 0;          ///< into the cloud
  Eigen::Vector3f point;  ///< m, that one
  float squared = 0;      ///< m^2, its distance
};

/// The points in cells of a uniform grid around them, some half the reach wide: a query asks the
/// cells that its reach overlaps.
class CloudGrid {
 public:
  /// @param reach  m, up to which distances are asked
  explicit CloudGrid(double reach);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);

  /// The nearest point whose squared distance is less than `below`, of equally near ones the first:
  /// what looking at all of them finds.
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
  std::vector<int> first_;  // entry of each cell, and behind the last one
  std::vector<Entry> entries_;
};

/// A field over the region around a body: each corner of its voxels knows the point of the cloud
/// that is nearest to it. Points are handed on from corner to corner in two sweeps, up and down
/// (Danielsson's), so some corners know the second nearest.
///
///     d(x) = min over the corners c of the voxel of x  |x - closest(c)|
///
/// That is never less than the true distance. By the corners alone what touches would be up to 0.71
/// voxels away: a surface through the middle of a voxel is met by its corners' closest points so
/// far beside. So where the answer is less than three voxels, the points in the voxel of x and in
/// those around it are asked, too, and nearer than a voxel it is exact. Inside of the region it is
/// off by less than half a voxel; docs/contact.md has the figures.
class Voxmap {
 public:
  /// @param region  m, in which distances are asked; beyond it the voxels of its edge answer
  /// @param reach   m, up to which
  /// @param voxel   m, its side; made larger where the region would have more than 4 million of
  /// them
  Voxmap(const Eigen::AlignedBox3d& region, double reach, double voxel);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);

  /// As CloudGrid::nearest, as exact as that.
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x, float below) const;

  /// m
  [[nodiscard]] double voxel() const { return static_cast<double>(voxel_); }

 private:
  // What a corner knows.
  struct Corner {
    int closest;    // point; -1: none within the reach
    float squared;  // m^2, its distance
    int first;      // point in the voxel above, right and behind of the corner; -1: there is none
  };
  [[nodiscard]] Eigen::Array3i voxel_of(const Eigen::Vector3f& x) const;
  [[nodiscard]] std::ptrdiff_t number_of(int x, int y, int z) const {
    return (static_cast<std::ptrdiff_t>(z) * corners_.y() + y) * corners_.x() + x;
  }
  [[nodiscard]] Eigen::Vector3f place_of(int x, int y, int z) const {
    return origin_ + voxel_ * Eigen::Vector3f(Eigen::Vector3i(x, y, z).cast<float>());
  }
  void forget();
  void sow();
  void sweep_slice(int z, int from);
  void sweep_row(int y, int z, std::ptrdiff_t slice, std::ptrdiff_t row);

  float voxel_;  // m
  float reach_;  // m
  float far_;    // m^2, beyond which no corner needs to know a point
  Eigen::Vector3f origin_;
  Eigen::Array3i corners_;  // along each axis
  std::vector<Corner> field_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> index_;     // into the cloud, of each
  std::vector<int> next_;      // point of the same voxel; -1: it is the last
  Eigen::AlignedBox3f box_;    // of the points
  Eigen::Array3i low_, high_;  // the corners that have a meaning, both included
};

/// One of them.
class CloudDistance {
 public:
  CloudDistance(DistanceQuery how, const Eigen::AlignedBox3d& region, double reach, double voxel);

  void reserve(std::size_t points);
  void build(std::span<const Eigen::Vector3f> cloud);
  [[nodiscard]] std::optional<NearestSeen> nearest(const Eigen::Vector3f& x, float below) const;

  /// m, up to which distances are asked
  [[nodiscard]] double reach() const { return reach_; }

 private:
  double reach_;
  std::variant<CloudGrid, Voxmap> how_;
};

}  // namespace palpable
