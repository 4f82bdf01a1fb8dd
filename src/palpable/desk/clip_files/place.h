/// @file
/// Where a body stands before the camera, as users write it: on the command line, in a file of
/// numbers, or in the scene.toml beside a recording.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// camera_from_body from six numbers: the place of the body's origin in the camera (m: right, down,
/// forward) and three angles (degrees). With all angles 0 the body stands upright before a level
/// camera, its Z up, its X to the right, its Y away from the camera. Then
///
///     yaw    turns it about its own upright axis,
///     pitch  leans its top towards the camera: what a camera that looks down by that angle sees,
///     roll   turns the picture of it about the optical axis.
[[nodiscard]] Rigid3 upright_pose(double x, double y, double z, double roll, double pitch,
                                  double yaw);

/// Reads a pose: six numbers "x y z roll pitch yaw" as above, or sixteen, camera_from_body row by
/// row (m). They are given as they are or are in the file that the text names: a text file of
/// numbers ('#' begins a comment), or a .toml with the array camera_from_body.
///
/// @param option  what it was given as, for messages
/// @throws Error naming what was given: not a file and no numbers, another count, not finite, a
///         matrix that is no rotation (by more than 1e-3), a body behind the camera
[[nodiscard]] Rigid3 read_pose(const std::string& text, const std::string& option = "pose");

/// Nobody says where the body stands, and nothing that is seen does. The message says what was
/// looked for; how else to say it is the caller's to add.
class NoPlaceError : public Error {
 public:
  using Error::Error;
};

/// What a recorded scene says of itself (scene.toml beside the images).
struct SceneFile {
  std::optional<Rigid3> camera_from_body;
  bool press_static = false;  ///< what is there when the body is anchored presses it, too
};

/// Without such a file nothing is known. @throws Error when it cannot be read or is wrong
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& path);

}  // namespace palpable
