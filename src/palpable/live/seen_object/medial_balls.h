/// @file
/// The whole of a thing from its seen side: balls behind the middle of its silhouette.
///
/// A camera sees fronts. How far a finger reaches behind its front is told by how wide it is: its
/// section is about as deep as it is wide. So the solid is the union of balls
///
///     radius r = largest disc of the silhouette around a pixel, at most `most_radius`
///     centre   = on the pixel's ray, behind the seen front by r / cos(front's normal, ray)
///
/// *only at medial pixels*, those whose disc no neighbour's disc holds: the middle of a finger,
/// a line of balls; of a wide thing the whole inside, balls of most_radius as deep as a palm is
/// thick. (A ball behind every pixel reaches too far: at a finger's flanks the normals push the
/// centres sideways.)
///
/// The last ball of a thing that ends is moved from its pixel to the middle of that end, which lies
/// less than a pixel on: or a finger would be half a pixel too short.
///
/// Under perspective a ball at depth Z, seen as a disc of d px with focal length f, has the radius
/// r = Z_front d / (f - d).
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/seen_object/silhouette.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace palpable {

struct MedialBallSettings {
  double most_radius = 0.0125;  ///< m: half of what a wide thing is thick, a palm's 25 mm
  /// Half side of the window in which front and normal are fitted, px: noise averages out.
  int reach = 5;
  /// Between the balls of a wide part, as a share of most_radius: their union is as flat as 1/50 of
  /// that radius.
  double spacing = 0.25;
  /// px by which things look wider than they are, on each side: the windows of a matcher reach over
  /// the outlines of near things. Discs are made as much smaller, but no less than a third of one.
  double fattening = 0;
  /// 1/m, by which the inverse depth of thin parts is measured too small: between its outlines,
  /// which lie deeper, a matcher sees a thin thing's front too far away.
  double too_far = 0;
  /// Wide parts that bend more than a ball of most_radius (fingers side by side) are as thick as
  /// they bend, but no thinner than least_relief, m.
  double least_relief = 0.006;
};

/// One ball, in the camera's frame.
struct MedialBall {
  Eigen::Vector3f front;   ///< m, where its thing is seen
  Eigen::Vector3f normal;  ///< unit, of the front, towards the camera
  Eigen::Vector3f centre;  ///< m, on the ray of the pixel
  float radius = 0;        ///< m
  int x = 0, y = 0;        ///< px, where it was found
  int pixels = 0;          ///< how many were averaged: the front scatters the less, the more
};

/// Where balls are wanted.
struct BallRegion {
  Rigid3 region_from_camera = Rigid3::Identity();
  /// A ball is left out when the seen point of its pixel lies outside; m.
  Eigen::AlignedBox3f box{Eigen::Vector3f::Constant(-1e6f), Eigen::Vector3f::Constant(1e6f)};
  /// A ball that cannot reach into this may be left out; m. Not all such balls are: where it
  /// matters, test the ball.
  Eigen::AlignedBox3f reached = box;
};

/// @param silhouette  of the same depth and mask; says which part of the image is looked at
/// @param region      where balls are wanted
/// @param balls       overwritten; allocates nothing when it has the capacity
void find_medial_balls(const DepthImage& depth, const PinholeCamera& camera,
                       const Silhouette& silhouette, const MedialBallSettings& settings,
                       const BallRegion& region, std::vector<MedialBall>& balls);

}  // namespace palpable
