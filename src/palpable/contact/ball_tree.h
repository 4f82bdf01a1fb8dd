/// @file
/// The union of many balls: which of them reaches nearest to a point.
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
  float distance = 0;  ///< to its surface, negative inside
  int ball = 0;        ///< index into the balls that the tree was made of
};

/// A tree of boxes over the balls' centres. Building it again allocates nothing once it held as
/// many.
class BallTree {
 public:
  void build(std::span<const Ball> balls);
  /// Building it of so many allocates nothing.
  void reserve(std::size_t balls);

  /// min over balls of |x - centre| - radius, and which one; of equal ones any. Nothing when that
  /// is `reach` or more. Exact (to a float's rounding).
  [[nodiscard]] std::optional<NearestBall> nearest(const Eigen::Vector3f& x, float reach) const;

  /// The same distance at eight places that all lie within `spread` of x; one walk for all.
  /// @param x        m
  /// @param ball     one that is known to be near: nearest(x)'s
  /// @return (8) m
  [[nodiscard]] std::array<float, 8> distances_around(const Eigen::Vector3f& x, float spread,
                                                      std::span<const Eigen::Vector3f, 8> places,
                                                      int ball) const;

  [[nodiscard]] std::span<const Ball> balls() const { return balls_; }

 private:
  struct Node {
    Eigen::Vector3f middle;  // of the centres' box
    Eigen::Vector3f half;
    float largest_radius = 0;
    int begin = 0;  // of order_
    int end = 0;
    int second = 0;  // index of the second child, the first follows its parent; 0: a leaf
  };
  int add(int begin, int end);

  std::vector<Ball> balls_;
  std::vector<int> order_;
  std::vector<Ball> sorted_;  // balls_[order_[k]]
  std::vector<Node> nodes_;
};

}  // namespace palpable
