/// @file
/// The tracker's map: keyframes, and the landmarks seen in them. Plain data.
#pragma once

#include "palpable/live/track/patch.h"
#include "palpable/live/track/recogniser.h"
#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

/// A sighting of a landmark in a keyframe.
struct KeyframeSighting {
  int keyframe = 0;  ///< index into LandmarkMap::keyframes
  Sighting seen;
};

/// A point of the world, with the picture of its surroundings when it was first seen.
struct Landmark {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  /// Index of the keyframe in which it was first seen, its anchor; -1 if that one was removed.
  int anchor = 0;
  Rigid3 lost_anchor = Rigid3::Identity();       ///< camera_from_world of the removed anchor
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< px, in the anchor's picture
  /// Inclination of the surface: d(1/Z) / d(u, v) in the anchor's picture, 1/(m px).
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  PatchSource look;                         ///< cut from the anchor's picture
  std::vector<KeyframeSighting> sightings;  ///< in the order of the keyframes
  int inlier = 0;                           ///< frames in which it agreed with the pose
  int outlier = 0;                          ///< frames in which it was found at another position
  int missed = 0;                           ///< frames in which it was searched and not found
  int last_frame = -1;                      ///< the last frame in which it agreed with the pose
  bool alive = true;                        ///< false: no longer searched, its slot may be reused
};

struct Keyframe {
  int number = 0;   ///< of the frame
  double time = 0;  ///< s
  Rigid3 camera_from_world = Rigid3::Identity();
  std::vector<int> landmarks;  ///< indices of those seen in it
  int tracked = 0;             ///< the number of its landmarks when it was kept
  double median_depth = 1;     ///< m, of its landmarks
  Thumbnail thumbnail;         ///< to find similar keyframes quickly
  Features features;           ///< to find the pose from which a picture was taken
};

/// Keyframes are stored in the order of their frames. Landmarks are stored in slots, and free slots
/// are reused, so that the indices of landmarks stay valid when others are removed.
struct LandmarkMap {
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<int> free_slots;  ///< of landmarks

  /// Puts a landmark into a free slot, or at the end, and adds its index to `keyframe`'s list.
  void add(Landmark landmark, Keyframe& keyframe);
  /// The number of landmarks that can be added until `most` slots are occupied.
  [[nodiscard]] int room_for_landmarks(int most) const;
  [[nodiscard]] int count_alive() const;
  void clear();
};

/// Pose of the camera when it first saw a landmark: anchor_from_world.
[[nodiscard]] inline const Rigid3& anchor_pose(const Landmark& landmark,
                                               const std::vector<Keyframe>& keyframes) {
  return landmark.anchor < 0 ? landmark.lost_anchor : keyframes[landmark.anchor].camera_from_world;
}

/// The linear map that warps the surroundings of a landmark, taken as a plane, from its anchor's
/// picture into the present one: d(u, v) here per px there.
[[nodiscard]] Eigen::Matrix2d image_from_anchor(const TrackCamera& camera, const Landmark& landmark,
                                                const Rigid3& anchor_from_world,
                                                const Rigid3& camera_from_world);

}  // namespace palpable
