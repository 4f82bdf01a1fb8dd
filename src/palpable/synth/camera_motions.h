/// @file
/// How the camera moves: ways of the rectified left camera through the desk's room.
///
/// Desk frame (desk_body.h), metres and radians; moments are frame numbers.
#pragma once

#include "palpable/geometry/rigid.h"

#include <cstdint>
#include <functional>

namespace palpable {

using CameraPath = std::function<Rigid3(double)>;  ///< camera_from_desk at a moment

/// Where every sequence begins: the camera looks down on the body as somebody who sits at the desk.
[[nodiscard]] Eigen::Vector3d first_eye();
[[nodiscard]] Rigid3 first_camera_from_desk();

/// camera_from_desk of a level camera at `from` that looks at `at`; not straight up or down.
[[nodiscard]] Rigid3 look_at(const Eigen::Vector3d& from, const Eigen::Vector3d& at);

/// A camera on a stand.
[[nodiscard]] CameraPath on_tripod();

/// A hand's unrest round a path: a slow sway of 2-4 mm at most (as the seed says) and 0.3 degrees
/// with a quick tremor of a tenth of that on top. `frames` is the length that the bounds hold for.
[[nodiscard]] CameraPath held(CameraPath path, int frames, std::uint64_t seed);

/// A walk of more than 6 m in 900 frames: away from the desk, along it, with the eyes turned 60
/// degrees and more away into the room, back and close over the books. Rests in the first 60 frames
/// and after the last.
[[nodiscard]] CameraPath walk();

/// Shaken on purpose, in bursts: up to 14 mm and 2.5 degrees at 2.5 to 5 Hz.
[[nodiscard]] CameraPath shaken(std::uint64_t seed);

/// Fast turns to the sides, 30-40 degrees in 0.4 s, with rests between them.
[[nodiscard]] CameraPath fast_turns(std::uint64_t seed);

/// Sways slowly and widely, turning at up to 25 degrees a second: what makes a rolling shutter
/// shear the picture.
[[nodiscard]] CameraPath swaying(std::uint64_t seed);

}  // namespace palpable
