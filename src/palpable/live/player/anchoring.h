/// @file
/// Poses of bodies that are placed automatically: on the desk, or on the chessboard, that the first
/// second of a source shows.
///
/// Every frame gives one pose, and the result is the median, so that a hand which passes through
/// some of the frames does not matter. The camera may move meanwhile: it is followed, and all poses
/// are converted to the camera frame in which a session on the same source begins: the first frame
/// of a recording, the last frame read from a live camera.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/map/free_place.h"
#include "palpable/live/sources/frame_source.h"

#include <Eigen/Core>

#include <optional>
#include <string>

namespace palpable {

/// The position on the plane at which a body is to stand.
struct Spot {
  /// The area that must be free of things; with radius 0 that is not checked.
  Footprint body = {};
  std::optional<Eigen::Vector2d> at_px = {};  ///< pixel; empty: a free position is found
};

/// Pose of a body that stands upright on the plane that is visible (camera_from_body_on in
/// plane_fit.h): at the free position nearest to the centre of the picture (free_place.h), or, with
/// Spot::at_px, on the surface at that pixel of the start frame named above (pose_at_pixel).
///
/// @param source  up to 30 frames of it are read
/// @param name    of the source, for messages
/// @return world_from_body; the world is the camera of the start frame
/// @throws NoPlaceError (scene_files.h) when no frame shows such a plane, when no position on it is
/// free, or when the surface at the pixel is unknown; Error when no frame is usable, the pixel is
/// outside the picture, or a stereo pair does not fit its calibration
[[nodiscard]] Rigid3 pose_on_plane(FrameSource& source, const std::string& name,
                                   const DepthSettings& settings, const Spot& spot = {});

/// The same from a single frame: camera_from_body; empty where no plane is visible or no
/// position on it is free.
[[nodiscard]] std::optional<Rigid3> pose_on_desk(const SeenFrame& seen, const DepthNoise& noise,
                                                 const Footprint& body);

/// Pose of a body on the centre of the visible chessboard (find_board_pose in board_calibration.h);
/// otherwise as pose_on_plane().
[[nodiscard]] Rigid3 pose_on_board(FrameSource& source, const std::string& name,
                                   const DepthSettings& settings, const BoardPattern& pattern);

/// Pose of a body that stands upright on the surface at a pixel: camera_from_body_on() of the
/// plane around that point. If the point belongs to the desk, the desk's plane is used, which
/// is more accurate.
/// @param at_px  of seen.color
/// @return camera_from_body; empty where the surface at the pixel is unknown
[[nodiscard]] std::optional<Rigid3> pose_at_pixel(const SeenFrame& seen, const DepthNoise& noise,
                                                  const Eigen::Vector2d& at_px);

}  // namespace palpable
