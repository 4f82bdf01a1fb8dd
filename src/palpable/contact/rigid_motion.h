/// @file
/// How a thing has moved since the frame before: the rigid motion that takes the points of its
/// front, as they were seen then, onto what is seen now (point-to-plane distances, Chen and Medioni
/// 1991; each point meets the pixel into which it falls).
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace palpable {

/// A point of a thing's front, body frame, m.
struct FrontPoint {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;  ///< unit, towards the camera
};

/// What one frame shows of the thing.
struct FrontView {
  const DepthImage& depth;  ///< m
  const MaskImage& shows;   ///< kShowsPresser where it may be the thing; empty: everywhere
  const PinholeCamera& camera;
  Rigid3 camera_from_body;
};

struct RigidMotionSettings {
  double sigma = 0.0007;  ///< m, of one point against the surface
  /// The motion is expected to differ from the guess by this much; what the points say nothing of
  /// (a finger's way along its own axis) stays as it was guessed.
  double slide = 0.010;  ///< m
  double turn = 0.10;    ///< rad
  double agrees = 0.0025;  ///< m: a point that is as near to the surface afterwards agrees
  double least_share = 0.6;  ///< of the points must agree, and at least
  int least_points = 12;     ///< so many
  int rounds = 8;
};

struct RigidMotion {
  Rigid3 now_from_before = Rigid3::Identity();  ///< body frame
  int agreeing = 0;
  int points = 0;
};

/// Nothing when too few points agree with any motion. Allocates nothing.
/// @param guess  now_from_before to begin with
[[nodiscard]] std::optional<RigidMotion> rigid_motion(std::span<const FrontPoint> before,
                                                      const FrontView& now, const Rigid3& guess,
                                                      const RigidMotionSettings& settings = {});

}  // namespace palpable
