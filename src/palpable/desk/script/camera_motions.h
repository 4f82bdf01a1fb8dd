/// @file
/// How the camera moves: paths of the rectified left camera through the desk's room.
///
/// Desk frame (desk_body.h), metres and radians; moments are frame numbers.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <cstdint>
#include <functional>

namespace palpable {

using CameraPath = std::function<Rigid3(double)>;  ///< camera_from_desk at a moment

/// Where the camera is at the beginning of every sequence, but for a tremor: it looks down on the
/// body as somebody does who sits at the desk.
[[nodiscard]] Eigen::Vector3d first_eye();
[[nodiscard]] Rigid3 first_camera_from_desk();

/// camera_from_desk of a level camera at `from` that looks at `at`; not straight up or down.
[[nodiscard]] Rigid3 look_at(const Eigen::Vector3d& from, const Eigen::Vector3d& at);

/// A camera on a stand.
[[nodiscard]] CameraPath on_tripod();

/// A path with the unrest of a hand that holds the camera: a slow sway and, a tenth as large, a
/// quick tremor. The largest shift is 2.4 to 3.8 mm (the seed chooses), the largest turn 0.3
/// degrees.
/// @param frames  the length within which these are the largest
[[nodiscard]] CameraPath held(CameraPath path, int frames, std::uint64_t seed);

/// A walk of more than 6 m in 900 frames: away from the desk, along it, with a look into the room
/// 60 degrees and more off the body, back and close over the books. The camera rests in the first
/// 60 frames and after the last.
[[nodiscard]] CameraPath walk();

/// Shaken in bursts of 3 s with rests of 1 s: by up to 14 mm and 2.5 degrees, at 2.5 to 5 Hz.
[[nodiscard]] CameraPath shaken(std::uint64_t seed);

/// Every 2.2 s a turn of 30-40 degrees in 0.4 s: to one side, back, to a side and so on.
[[nodiscard]] CameraPath fast_turns(std::uint64_t seed);

/// Sways slowly by up to 35 mm and 6 degrees, turning at up to 25 degrees a second: enough for a
/// rolling shutter to shear the image.
[[nodiscard]] CameraPath swaying(std::uint64_t seed);

}  // namespace palpable
