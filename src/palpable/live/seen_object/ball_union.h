/// @file
/// The signed distance to a union of balls that stand for what a camera sees, with normal and
/// curvature. Body frame, metres.
#pragma once

#include "palpable/common/contact/pressing_surface.h"
#include "palpable/live/seen_object/ball_tree.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Keeps its memory.
class BallUnion : public PressingSurface {
 public:
  /// @param band  m, as PressingSurface::band()
  explicit BallUnion(float band) : band_(band) {}
  void reserve(std::size_t balls);

  /// Takes the balls of another union, on their way from the frame before (0) to this one (1).
  void set_on_the_way(const BallUnion& now, float done);

  [[nodiscard]] std::span<const ObjectBall> balls() const override { return balls_; }
  [[nodiscard]] float friction_share() const override { return friction_share_; }
  [[nodiscard]] const Eigen::AlignedBox3f& bounds() const override { return bounds_; }
  [[nodiscard]] float band() const override { return band_; }
  /// Not known.
  [[nodiscard]] double moved() const override { return 0; }

  [[nodiscard]] std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x,
                                                       float reach) const override;
  /// Within the band.
  [[nodiscard]] std::optional<NearestOnObject> nearest(const Eigen::Vector3f& x) const {
    return nearest(x, band_);
  }
  [[nodiscard]] bool is_within(const Eigen::Vector3f& x, float reach) const override {
    return tree_.is_any_within(x, reach);
  }
  [[nodiscard]] std::optional<SurfaceShape> shape_at(const Eigen::Vector3f& x) const override;

 protected:
  void arrange();
  void find_friction_share();
  [[nodiscard]] NearestOnObject on_ball(const Eigen::Vector3f& x, float distance, int index) const;

  Eigen::Vector3f camera_ = Eigen::Vector3f::Zero();  // m, its position
  std::vector<ObjectBall> balls_;
  BallTree tree_;  // of the balls

 private:
  float band_;
  float friction_share_ = 0;
  Eigen::AlignedBox3f bounds_;
  std::vector<Ball> bare_;
};

}  // namespace palpable
