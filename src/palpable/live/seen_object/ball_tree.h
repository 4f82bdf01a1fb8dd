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

/// A tree of boxes over the balls' centres, four to a node. Building it again allocates nothing
/// once it held as many.
class BallTree {
 public:
  void build(std::span<const Ball> balls);
  /// Building it of so many allocates nothing.
  void reserve(std::size_t balls);

  /// min over balls of |x - centre| - radius, and which one; of equal ones any. Nothing when that
  /// is `reach` or more. Exact (to a float's rounding).
  [[nodiscard]] std::optional<NearestBall> nearest(const Eigen::Vector3f& x, float reach) const;

  /// Whether nearest() finds any, to a float's rounding; told sooner.
  [[nodiscard]] bool is_any_within(const Eigen::Vector3f& x, float reach) const;

  /// The same distance at eight places around x; one walk for all.
  /// @param x        m
  /// @param across   unit: the places lie across it from x,
  /// @param spread   m: and so far away
  /// @param ball     one that is known to be near: nearest(x)'s
  /// @return (8) m
  [[nodiscard]] std::array<float, 8> distances_around(const Eigen::Vector3f& x,
                                                      const Eigen::Vector3f& across, float spread,
                                                      std::span<const Eigen::Vector3f, 8> places,
                                                      int ball) const;

  [[nodiscard]] std::span<const Ball> balls() const { return balls_; }

 private:
  // As many balls lie beside each other in memory, and are looked at at once.
  static constexpr int kBlock = 8;
  using Block = Eigen::Array<float, kBlock, 1>;
  struct Balls {
    Block x, y, z, radius;  // m; no ball: radius -infinity
    [[nodiscard]] Block distances(const Eigen::Vector3f& from) const {
      return ((x - from.x()).square() + (y - from.y()).square() + (z - from.z()).square()).sqrt() -
             radius;
    }
  };
  // The four children's boxes of centres, and their largest radii. No child: radius -infinity.
  struct Node {
    Eigen::Array4f x, y, z;  // m, middles
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
  std::vector<int> order_;     // of the balls in blocks
  std::vector<Balls> blocks_;  // ball order_[kBlock k + i] is number i of block k
  std::vector<Node> nodes_;
};

}  // namespace palpable
