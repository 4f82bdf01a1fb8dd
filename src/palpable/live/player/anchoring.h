/// @file
/// Where a body stands when nobody gives its pose: on the desk, or on the chessboard, that the
/// first second of a source shows.
///
/// Every frame gives one pose; their median is what counts, so that a hand which passes through
/// some of the frames does not matter. The camera may move meanwhile: it is followed, and all poses
/// are brought to the frame with which a session on the same source begins. That is a recording's
/// first frame, and of a camera the last one that was seen.
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

/// Where on what is seen a body is to stand.
struct Spot {
  /// The room that it needs there; without a radius nobody asks whether something stands in it.
  Footprint body = {};
  std::optional<Eigen::Vector2d> at_px = {};  ///< of the picture; nothing: it is looked for
};

/// On the plane that is seen, upright (camera_from_body_on in plane_fit.h): at the place nearest to
/// the picture's middle in which nothing stands that is seen (free_place.h). Or with Spot::at_px on
/// what is seen at that pixel of the frame named above (pose_at_pixel).
///
/// @param source  reads up to 30 frames of it
/// @param name    of the source, for messages
/// @return world_from_body; the world is the camera of the frame named above
/// @throws NoPlaceError (place.h) when no frame shows such a plane, things stand all over it, or
///         nothing is known of the pixel; Error when no frame can be used, the pixel is outside of
///         the picture, or a pair does not fit its calibration
[[nodiscard]] Rigid3 pose_on_plane(FrameSource& source, const std::string& name,
                                   const DepthSettings& settings, const Spot& spot = {});

/// What one frame says of it: camera_from_body; nothing where no plane is seen, or none that is
/// free.
[[nodiscard]] std::optional<Rigid3> pose_on_desk(const SeenFrame& seen, const DepthNoise& noise,
                                                 const Footprint& body);

/// On the middle of the chessboard that is seen (find_board_pose in board_calibration.h); otherwise
/// the same.
[[nodiscard]] Rigid3 pose_on_board(FrameSource& source, const std::string& name,
                                   const DepthSettings& settings, const BoardPattern& pattern);

/// Where a body stands that is put on the surface at a pixel, upright on it: camera_from_body_on()
/// of the plane around that point, or of the desk where it belongs to the one that is seen, which
/// is known better.
/// @param at_px  of seen.color
/// @return camera_from_body; nothing where no surface is known there
[[nodiscard]] std::optional<Rigid3> pose_at_pixel(const SeenFrame& seen, const DepthNoise& noise,
                                                  const Eigen::Vector2d& at_px);

}  // namespace palpable
