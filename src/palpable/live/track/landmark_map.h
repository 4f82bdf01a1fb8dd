/// @file
/// What the tracker remembers: keyframes, and the landmarks seen in them. Plain data.
#pragma once

#include "palpable/live/track/patch.h"
#include "palpable/live/track/recogniser.h"
#include "palpable/live/track/sighting.h"

#include <vector>

namespace palpable {

/// In which keyframe a landmark was seen, and where in its picture.
struct KeyframeSighting {
  int keyframe = 0;  ///< index into LandmarkMap::keyframes
  Sighting seen;
};

/// A point of the world, and how its surroundings looked when it was first seen.
struct Landmark {
  Eigen::Vector3d x_in_world = Eigen::Vector3d::Zero();
  /// Index of the keyframe in which it was first seen, its anchor; -1 when that one was forgotten.
  int anchor = 0;
  Rigid3 lost_anchor = Rigid3::Identity();       ///< camera_from_world of the forgotten anchor
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< px, in the anchor's picture
  /// d(1/Z) / d(u, v) of the surface in the anchor's picture, 1/(m px): how it is inclined.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  PatchSource look;                         ///< cut from the anchor's picture
  std::vector<KeyframeSighting> sightings;  ///< in the order of the keyframes
  int inlier = 0;                           ///< frames in which it agreed with the pose
  int outlier = 0;                          ///< frames in which it was found in another place
  int missed = 0;                           ///< frames in which it was looked for and not found
  int last_frame = -1;                      ///< the last frame in which it agreed with the pose
  bool alive = true;                        ///< false: no longer looked for, its slot may be reused
};

struct Keyframe {
  int number = 0;   ///< of the frame
  double time = 0;  ///< s
  Rigid3 camera_from_world = Rigid3::Identity();
  std::vector<int> landmarks;  ///< indices of those seen in it
  int tracked = 0;             ///< how many those were when it was kept
  double median_depth = 1;     ///< m, of its landmarks
  Thumbnail thumbnail;         ///< to tell quickly which keyframes look like a picture
  Features features;           ///< to find out from where a picture was taken
};

/// Keyframes lie in the order of their frames. Landmarks lie in slots; a slot that is free is used
/// again, so that indices of landmarks stay valid while the map forgets.
struct LandmarkMap {
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  std::vector<int> free_slots;  ///< of landmarks

  /// Puts a landmark into a free slot, or behind the others, and enters it in `keyframe`'s list.
  void add(Landmark landmark, Keyframe& keyframe);
  /// How many landmarks can be added until there are `most`.
  [[nodiscard]] int room_for_landmarks(int most) const;
  [[nodiscard]] int count_alive() const;
  void clear();
};

/// Pose of the camera that first saw a landmark: anchor_from_world.
[[nodiscard]] inline const Rigid3& anchor_pose(const Landmark& landmark,
                                               const std::vector<Keyframe>& keyframes) {
  return landmark.anchor < 0 ? landmark.lost_anchor : keyframes[landmark.anchor].camera_from_world;
}

/// How the surroundings of a landmark, taken as a plane, are warped from its anchor's picture into
/// the present one: d(u, v) now per px there.
[[nodiscard]] Eigen::Matrix2d image_from_anchor(const TrackCamera& camera, const Landmark& landmark,
                                                const Rigid3& anchor_from_world,
                                                const Rigid3& camera_from_world);

}  // namespace palpable
