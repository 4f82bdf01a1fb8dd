/// @file
/// Camera motions: paths of the rectified left camera through the desk's room.
///
/// Desk frame (desk_body.h), m and rad; times are in frames.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <functional>
#include <string_view>

namespace palpable {

using CameraPath = std::function<Rigid3(double)>;  ///< camera_from_desk at a time

/// Position and pose of the camera at the beginning of every sequence, apart from a tremor: it
/// looks down on the body from the position of a person at the desk.
[[nodiscard]] Eigen::Vector3d first_eye();
[[nodiscard]] Rigid3 first_camera_from_desk();

/// camera_from_desk of a level camera at `from` that looks at `at`. The direction must not be
/// vertical.
[[nodiscard]] Rigid3 look_at(const Eigen::Vector3d& from, const Eigen::Vector3d& at);

/// A camera on a stand.
[[nodiscard]] CameraPath on_tripod();

/// A sequence that a camera on a stand films, with a rig without faults; nothing moves yet.
[[nodiscard]] Sequence tripod_sequence(std::string_view name, int frames, std::uint64_t seed);

/// Adds the unrest of a hand-held camera to a path: a slow sway and, a tenth as large, a fast
/// tremor. The largest shift is 2.4 to 3.8 mm (depending on the seed), the largest rotation 0.3
/// degrees.
/// @param frames  number of frames over which these maxima hold
[[nodiscard]] CameraPath held(CameraPath path, int frames, std::uint64_t seed);

/// A walk of more than 6 m in 900 frames: away from the desk, along it, with a look into the room
/// more than 60 degrees away from the body, back, and close above the books. The camera rests in
/// the first 60 frames and after the last.
[[nodiscard]] CameraPath walk();

/// A shaken camera: bursts of 3 s with rests of 1 s, up to 14 mm and 2.5 degrees, at 2.5 to 5 Hz.
[[nodiscard]] CameraPath shaken(std::uint64_t seed);

/// A turn of 30 to 40 degrees in 0.4 s every 2.2 s: to one side, back, to one side and so on.
[[nodiscard]] CameraPath fast_turns(std::uint64_t seed);

/// A slow sway of up to 35 mm and 6 degrees, with rotations of up to 25 degrees/s, which is enough
/// for a rolling shutter to shear the image.
[[nodiscard]] CameraPath swaying(std::uint64_t seed);

}  // namespace palpable
