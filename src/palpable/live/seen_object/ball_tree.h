/// @file
/// The signed distance of a point to the union of many balls, and the nearest ball.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct Ball {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float radius = 0;
};

struct NearestBall {
  float distance = 0;  ///< m, to its surface, negative inside
  int ball = 0;        ///< index into the balls of which the tree was built
};

/// A tree of boxes around the balls' centres with four children for each node. Building it again
/// allocates nothing once it held as many balls.
class BallTree {
 public:
  void build(std::span<const Ball> balls);
  /// Reserves memory: building a tree of up to this many balls then allocates nothing.
  void reserve(std::size_t balls);

  /// The minimum over balls of |x - centre| - radius, and its ball; any one of equally near balls.
  /// Nothing when the minimum is `reach` or more. Exact (to a float's rounding).
  [[nodiscard]] std::optional<NearestBall> nearest(const Eigen::Vector3f& x, float reach) const;

  /// Whether nearest() finds a ball, to a float's rounding; faster: it stops at the first one.
  [[nodiscard]] bool is_any_within(const Eigen::Vector3f& x, float reach) const;

  /// The distance of nearest() at eight positions on a circle around x, by one walk of the tree.
  /// @param x       m, the circle's centre
  /// @param across  unit, perpendicular to the circle's plane
  /// @param spread  m, the circle's radius
  /// @param places  m, the positions
  /// @param ball    a ball that is known to be near, such as that of nearest(x)
  /// @return (8) m
  [[nodiscard]] std::array<float, 8> distances_around(const Eigen::Vector3f& x,
                                                      const Eigen::Vector3f& across, float spread,
                                                      std::span<const Eigen::Vector3f, 8> places,
                                                      int ball) const;

  [[nodiscard]] std::span<const Ball> balls() const { return balls_; }

 private:
  // Number of balls that are stored together and compared in one vector operation.
  static constexpr int kBlock = 8;
  using Block = Eigen::Array<float, kBlock, 1>;
  struct Balls {
    Block x, y, z, radius;  // m; an unused entry has radius -infinity
    [[nodiscard]] Block distances(const Eigen::Vector3f& from) const;
  };
  // The boxes of centres and the largest radii of four children; a missing child has radius
  // -infinity.
  struct Node {
    Eigen::Array4f x, y, z;  // m, the middles of the boxes
    Eigen::Array4f half_x, half_y, half_z;
    Eigen::Array4f radius;
    std::array<int, 4> child{};  // a node, or ~block
  };
  int add(int begin, int end);
  [[nodiscard]] int split(int begin, int end);
  void set_child(int node, int slot, int begin, int end);
  template <class AtBlock>
  void walk(const Eigen::Vector3f& x, const float& reach, const AtBlock& at_block) const;

  std::vector<Ball> balls_;
  std::vector<int> order_;     // the balls' indices in the order of the blocks
  std::vector<Balls> blocks_;  // entry i of block k is ball order_[kBlock k + i]
  std::vector<Node> nodes_;
};

}  // namespace palpable
