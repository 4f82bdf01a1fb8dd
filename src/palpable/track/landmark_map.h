/// @file
/// What the tracker remembers: keyframes and the points seen in them. Plain data.
#pragma once

#include "palpable/track/patch.h"
#include "palpable/track/recogniser.h"
#include "palpable/track/sighting.h"

#include <cstddef>
#include <vector>

namespace palpable {

struct KeyframeSighting {
  int keyframe = 0;
  Sighting seen;
};

/// A point of the world and how it looked when it was first seen.
struct Landmark {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  int anchor = 0;                                ///< the keyframe in which it was first seen; or -1
  Rigid3 lost_anchor = Rigid3::Identity();       ///< with -1: that keyframe's last pose
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< there, px
  /// d(1/Z) / d(u, v) of the surface there, 1/(m px): how it is inclined.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  PatchSource look;
  std::vector<KeyframeSighting> sightings;  ///< in the order of the keyframes
  int inlier = 0;                           ///< frames that it agreed with
  int outlier = 0;                          ///< frames in which it was found but elsewhere
  int missed = 0;                           ///< frames in which it was looked for and not found
  int last_frame = -1;                      ///< that it agreed with
  bool alive = true;
};

struct Keyframe {
  int number = 0;
  double time = 0;
  Rigid3 camera_from_world = Rigid3::Identity();
  std::vector<int> landmarks;  ///< seen in it
  int tracked = 0;             ///< how many carried it, with the new ones
  double median_depth = 1;     ///< m
  Thumbnail thumbnail;
  Features features;
};

/// Pose of the camera that first saw a landmark, camera_from_world.
[[nodiscard]] inline const Rigid3& anchor_pose(const Landmark& landmark,
                                               const std::vector<Keyframe>& keyframes) {
  return landmark.anchor < 0
             ? landmark.lost_anchor
             : keyframes[static_cast<std::size_t>(landmark.anchor)].camera_from_world;
}

/// d(u, v) in the present image per px in the image where the landmark was first seen: how its
/// surroundings, taken as a plane, are warped.
[[nodiscard]] Eigen::Matrix2d image_from_anchor(const TrackCamera& camera, const Landmark& landmark,
                                                const Rigid3& anchor_from_world,
                                                const Rigid3& camera_from_world);

}  // namespace palpable
