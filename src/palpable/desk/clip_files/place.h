/// @file
/// The pose of a body in front of the camera as users write it: on the command line, in a file of
/// numbers, or in the scene.toml beside a recording.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// camera_from_body from six numbers: the position of the body's origin in the camera frame (m:
/// right, down, forward) and three angles (degrees). With all angles 0 the body stands upright
/// before a level camera, its Z up, its X to the right, its Y away from the camera. Then
///
///     yaw    turns it about its own upright axis,
///     pitch  leans its top towards the camera, as seen by a camera tilted down by that angle,
///     roll   turns its picture about the optical axis.
[[nodiscard]] Rigid3 upright_pose(double x, double y, double z, double roll, double pitch,
                                  double yaw);

/// Reads a pose: six numbers "x y z roll pitch yaw" as above, or sixteen, camera_from_body row by
/// row (m). `text` holds the numbers themselves or names a file with them: a text file of numbers
/// ('#' begins a comment), or a .toml with the array camera_from_body.
///
/// @param option  name of the option that gave the text, for messages
/// @throws Error naming the option or file: neither a file nor numbers, another count, a value that
/// is
///         not finite, a matrix that is no rotation (R R^T off by more than 1e-3), a body behind
///         the camera or more than 100 m away
[[nodiscard]] Rigid3 read_pose(const std::string& text, const std::string& option = "pose");

/// The pose of a body is neither given nor found in the images. The message says what was searched;
/// the caller adds how the pose can be given instead.
class NoPlaceError : public Error {
 public:
  using Error::Error;
};

/// Contents of the scene.toml beside recorded images.
struct SceneFile {
  std::optional<Rigid3> camera_from_body;
  /// Whether things that are already present when the body is anchored press it, too.
  bool press_static = false;
};

/// Without such a file the result is a default SceneFile. @throws Error when the file cannot be
/// read or holds wrong values
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& path);

}  // namespace palpable
