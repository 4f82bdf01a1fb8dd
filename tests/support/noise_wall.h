/// @file
/// A moving stereo camera in front of a wall with a noise texture, for tests of tracking.
///
/// World: X right, Y down, Z forward, m. The wall is the plane Z = kNoiseWallZ.
#pragma once

#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/tracker.h"
#include "tests/support/noise_room.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <utility>
#include <vector>

namespace palpable::test {

inline const TrackCamera kNoiseWallCamera{{480, 288, 260, 256, 241.5, 141.5}, 0.063};
inline constexpr double kNoiseWallZ = 1.2;  // m

/// Motion of the wall's picture, px, for 1 m of camera motion to the right.
inline constexpr double kPxPerMetre = 260 / kNoiseWallZ;

inline TrackerSettings noise_wall_settings() {
  TrackerSettings settings;
  settings.camera = kNoiseWallCamera;
  settings.noise = stereo_noise({kNoiseWallCamera.camera, kNoiseWallCamera.baseline, 0});
  return settings;
}

/// camera_from_world of a camera at (x, y, z) that looks along Z.
inline Rigid3 standing_at(double x, double y, double z) {
  return Rigid3(Eigen::Translation3d(-x, -y, -z));
}

/// The visible point of the wall at pixel (u, v): Z in m, and the point in the world frame.
inline std::pair<double, Eigen::Vector3d> wall_at(const Rigid3& camera_from_world, double u,
                                                  double v) {
  const Rigid3 world_from_camera = camera_from_world.inverse(Eigen::Isometry);
  const Eigen::Vector3d eye = world_from_camera.translation();
  const Eigen::Vector3d ray =
      world_from_camera.linear() * kNoiseWallCamera.camera.unproject(u, v, 1);
  const double Z = (kNoiseWallZ - eye.z()) / ray.z();
  return {Z, eye + Z * ray};
}

/// The picture from one pose, or the mean over several poses, as with an open shutter. Pixels are
/// truncated to whole grey levels; there is no other noise.
inline GrayImage wall_picture(const std::vector<Rigid3>& cameras_from_world) {
  GrayImage image(kNoiseWallCamera.camera.width, kNoiseWallCamera.camera.height);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      double sum = 0;
      for (const Rigid3& pose : cameras_from_world) {
        const Eigen::Vector3d at = wall_at(pose, x, y).second;
        sum += wall_texture(at.x(), at.y(), 1);
      }
      image(x, y) = static_cast<std::uint8_t>(sum / static_cast<double>(cameras_from_world.size()));
    }
  }
  return image;
}

/// One frame and the images that it refers to.
struct WallView {
  GrayImage left, right;
  DepthImage depth;  ///< of the left image's size
  Pyramid pyramid;   ///< of the left image
  TrackerFrame frame;

  /// @param with_right_eye  false: like a colour + depth camera
  explicit WallView(const Rigid3& camera_from_world, bool with_right_eye = true)
      : WallView(camera_from_world, {camera_from_world}, with_right_eye) {}

  /// A picture averaged over the poses `smeared`, with the depth for `camera_from_world`.
  WallView(const Rigid3& camera_from_world, const std::vector<Rigid3>& smeared, bool with_right_eye)
      : left(wall_picture(smeared)), depth(left.width(), left.height()) {
    if (with_right_eye) {
      const Rigid3 right_from_left(Eigen::Translation3d(-kNoiseWallCamera.baseline, 0, 0));
      right = wall_picture({right_from_left * camera_from_world});
    }
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        depth(x, y) = static_cast<float>(wall_at(camera_from_world, x, y).first);
      }
    }
    pyramid.build(left);
    frame.left = &left;
    frame.right = with_right_eye ? &right : nullptr;
    frame.depth = &depth;
  }
  // Not copyable, because the pyramid and the frame point into the object.
  WallView(const WallView&) = delete;
  WallView& operator=(const WallView&) = delete;
  WallView(WallView&&) = delete;
  WallView& operator=(WallView&&) = delete;
  ~WallView() = default;
};

/// A landmark on the wall at pixel uv of the map's newest keyframe, whose picture is `view`.
inline Landmark wall_landmark(const WallView& view, const LandmarkMap& map,
                              const Eigen::Vector2d& uv) {
  Landmark landmark;
  landmark.anchor = static_cast<int>(map.keyframes.size()) - 1;
  landmark.uv = uv;
  landmark.look = PatchSource::cut(view.pyramid, uv);
  landmark.x_in_world = wall_at(map.keyframes.back().camera_from_world, uv.x(), uv.y()).second;
  Sighting seen;
  seen.uvd = kNoiseWallCamera.see(map.keyframes.back().camera_from_world * landmark.x_in_world);
  landmark.sightings.push_back({landmark.anchor, seen});
  return landmark;
}

/// A map of one keyframe at the world's origin, with `across` x `down` landmarks on a grid over its
/// picture, row by row.
struct WallMap : LandmarkMap {
  WallMap(const WallView& view, int across, int down) {
    keyframes.emplace_back();
    const PinholeCamera& c = kNoiseWallCamera.camera;
    for (int j = 0; j < down; ++j) {
      for (int i = 0; i < across; ++i) {
        const Eigen::Vector2d uv(40 + (c.width - 80) * (i + 0.5) / across,
                                 40 + (c.height - 80) * (j + 0.5) / down);
        add(wall_landmark(view, *this, uv), keyframes.back());
      }
    }
  }
};

/// The picture of the first keyframe of a WallMap with both eyes; made once per program.
inline const WallView& first_wall_view() {
  static const WallView view(Rigid3::Identity());
  return view;
}

}  // namespace palpable::test
