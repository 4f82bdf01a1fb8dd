/// @file
/// Files that describe a scene: the pose of a body in front of the camera and the bodies of a scene
/// as users write them (on the command line, in a file of numbers, in the scene.toml beside a
/// recording, in scenes/*.toml), and the camera.toml of a filmed sequence.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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
///         is not finite, a matrix that is no rotation (R R^T off by more than 1e-3), a body behind
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
  std::optional<double> friction = {};  ///< Coulomb's, of all skins that state none themselves
};

/// Writes FOLDER/scene.toml.
/// @param what  stands there, in the file's comment: "body" or "scene"
/// @param camera_from_body  in the first frame; the camera is the rectified left one
/// @throws Error when the file cannot be written
void write_scene_file(const std::filesystem::path& folder, const char* what,
                      const Rigid3& camera_from_body, double frames_per_second);

/// Without such a file the result is a default SceneFile. @throws Error when the file cannot be
/// read or holds wrong values
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& path);

/// What determines the pose of a body.
enum class Anchor {
  kPlace,  ///< the user, else the scene.toml beside the images (SceneFile)
  kPlane,  ///< the desk top that the first frames show (player/anchoring.h)
  kBoard   ///< the chessboard that they show
};

/// The position of one of several bodies.
struct BodyPlace {
  std::optional<Anchor> anchor = {};  ///< nothing: the scene's own frame
  std::optional<Rigid3> place = {};   ///< camera_from_anchor in the first frame, for a given place
  int beside = -1;  ///< index of an earlier body whose frame is the anchor; -1: none
  Rigid3 anchor_from_body = Rigid3::Identity();
};

/// One body of a scene before its file is read. A user writes scenes/*.toml as follows:
///
///     [[body]]
///     name = "upper"                       # in files and captions; unique
///     file = "../out/beam.palpable"        # relative to the scene file's folder
///     description = "../bodies/beam.toml"  # its source; for the hint if the file is missing
///     beside = "lower"                     # or anchor = "scene", "plane", "board" or "place"
///     at = ["0 mm", "0 mm", "75 mm"]       # from the anchor: right, away, up
///     turn = 90                            # degrees about its upright axis
///     scale = 1
///     set = ["stiffness=0.8"]              # values of its parameters
///     friction = 0.6                       # Coulomb's coefficient of its skin
///     color = [200, 120, 80]               # of its material
///
/// docs/scenes.md explains every key.
struct DescribedBody {
  std::string name = {};
  std::filesystem::path file;              ///< the body file
  std::filesystem::path description = {};  ///< what it is baked from; empty: not given
  std::string method = {};                 ///< of the bake; empty: the default
  BodyPlace place = {};
  double scale = 1;
  std::vector<std::string> set = {};  ///< NAME=VALUE
  std::optional<Rgb> color = {};
  std::optional<double> friction = {};  ///< of its skin; none: that of the body file
};

/// @return at least one body; their names differ
/// @throws Error naming file, line and key
[[nodiscard]] std::vector<DescribedBody> read_scene_description(const std::filesystem::path& path);

/// A key at the top of a scene file that is an option of `palpable live`: paint = "pressure".
struct SceneOption {
  std::string name;
  std::vector<std::string> words;  ///< one for a text, a number or a flag; those of an array
  int line = 0;
};
/// The options at the top of a scene file, in the file's order; their names and values are not
/// checked.
/// @throws Error naming file, line and key where a value is no text, number, flag or array of these
[[nodiscard]] std::vector<SceneOption> read_scene_options(const std::filesystem::path& path);

/// Bodies as the [[body]] tables of a scene file, which read_scene_description() reads; files with
/// their full paths.
[[nodiscard]] std::string scene_text(const std::vector<DescribedBody>& bodies);

/// The poses of the bodies in the scene's own frame, which is the anchor of bodies without one.
/// @throws Error naming a body whose anchor is only known from images
[[nodiscard]] std::vector<Rigid3> scene_from_bodies(const std::vector<DescribedBody>& bodies);

/// @throws Error that says how to bake the body file if it does not exist yet
/// @param scene  the scene file that names the body
void expect_baked(const DescribedBody& body, const std::filesystem::path& scene);

/// camera.toml of a truth: the camera and the depth unit for scoring, and the sequence and body
/// that were filmed. A folder without this file is no truth, so it is written last.
struct TruthCamera {
  double frames_per_second = 0;         ///< > 0; "fps"
  double depth_unit = 0;                ///< > 0, m per count of depth/; "depth_unit_m"
  std::optional<PinholeCamera> camera;  ///< the rectified left camera at half size
  std::optional<double> baseline;       ///< m; "baseline_m"
  std::string sequence;                 ///< name
  std::optional<std::uint64_t> seed;    ///< of the sequence; at most 2^63 - 1
  std::string body;                     ///< name
};

/// @throws Error when the file cannot be written
/// @throws ContractViolation unless all values are known
void write_truth_camera(const std::filesystem::path& path, const TruthCamera& camera);

/// Only fps and depth_unit_m are required.
/// @throws Error naming file and line when one of the two is missing or not above 0, or when the
/// file is no TOML
[[nodiscard]] TruthCamera read_truth_camera(const std::filesystem::path& file);

}  // namespace palpable
