/// @file
/// The solid shape of a thing from its seen side: balls behind the middle of its silhouette.
///
/// A camera sees only the front of a thing. A finger's section is about as deep as it is wide, so
/// its width gives its depth. The solid is the union of balls
///
///     radius r = largest disc of the silhouette around a pixel, at most `most_radius`
///     centre   = on the pixel's ray, behind the seen front by r / cos(front's normal, ray)
///
/// *at medial pixels only*: pixels whose disc is not contained in the disc of a neighbour. In a
/// finger these are its middle line; in a wide thing they are the whole inside, with balls of
/// most_radius, as deep as a palm is thick. (Balls behind all pixels would reach too far: at a
/// finger's flanks the normals push their centres sideways.)
///
/// At the end of a thing the last ball is moved from its pixel to the middle of that end, by less
/// than a pixel. Without that a finger would be half a pixel too short.
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
  double most_radius = 0.0125;  ///< m: half the thickness of a wide thing, such as a palm of 25 mm
  /// px: half the side of the window in which front and normal are fitted. Larger windows average
  /// more noise and smooth away more shape.
  int reach = 5;
  /// Distance between the balls of a wide part, as a ratio to most_radius. With 1/4 the surface of
  /// their union is flat to 1/50 of that radius.
  double spacing = 0.25;
  /// px by which a thing seems wider than it is on each side, because the windows of a matcher
  /// reach across the outlines of near things. The radius of a disc is reduced by this, but to no
  /// less than 1/3 px.
  double fattening = 0;
  /// 1/m by which the inverse depth of thin parts is measured too small: a matcher mixes the front
  /// of a thin thing with its outlines, which are farther away.
  double too_far = 0;
  /// m: the least radius of a ball where a wide part is curved more than a ball of most_radius
  /// (fingers side by side); there the radius is otherwise that of the curvature.
  double least_relief = 0.006;
};

/// One ball, in the camera's frame.
struct MedialBall {
  Eigen::Vector3f front;   ///< m, on the seen surface
  Eigen::Vector3f normal;  ///< unit, of the front, towards the camera
  Eigen::Vector3f centre;  ///< m, on the ray of the pixel
  float radius = 0;        ///< m
  int x = 0, y = 0;        ///< px, where it was found
  int pixels = 0;          ///< number that were averaged; the front's variance falls with it
};

/// Where balls are wanted.
struct BallRegion {
  Rigid3 region_from_camera = Rigid3::Identity();
  /// A ball is left out when the seen point of its pixel lies outside; m.
  Eigen::AlignedBox3f box{Eigen::Vector3f::Constant(-1e6f), Eigen::Vector3f::Constant(1e6f)};
  /// Balls that cannot reach into this may be left out, but not all of them are; m.
  Eigen::AlignedBox3f reached = box;
};

/// Finds the balls of all things in a silhouette.
/// @param silhouette  of the same depth and mask; its box is the part of the image that is searched
/// @param region      where balls are wanted
/// @param balls       overwritten; allocates nothing when it has the capacity
void find_medial_balls(const DepthImage& depth, const PinholeCamera& camera,
                       const Silhouette& silhouette, const MedialBallSettings& settings,
                       const BallRegion& region, std::vector<MedialBall>& balls);

}  // namespace palpable
