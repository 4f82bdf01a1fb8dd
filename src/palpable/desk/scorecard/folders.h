/// @file
/// The folders that are scored, TRUTH and RESULT of docs/benchmark.md, read and checked as far as
/// they are text. Images are read frame by frame (image_scores.h).
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/stamped_pose.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/desk/clip_files/deformed_file.h"
#include "palpable/desk/score/row_error.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TrueContact {
  bool touching = false;
  int site = -1;     ///< -1 between sites, or not touching
  double depth = 0;  ///< m; 0: nothing touches, or it is not said
  /// m, from what moves to the undeformed body: 0 in a touch, infinite where nothing is there.
  std::optional<double> gap = {};
  double seen_share = 1;                      ///< of what touches; 1 where it is not said
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame: where it is deepest
};

/// truth/deformed: the full answer, of some frames. Their skins are read one by one
/// (deformed_file.h).
struct TrueSkins {
  SurfaceMesh rest;
  std::vector<DeformedLine> lines;  ///< at least one, by frame
};

/// The body that was filmed, at rest.
struct TrueBody {
  SurfaceMesh rest;            ///< m, body frame
  std::filesystem::path file;  ///< where it stands
};

/// What is known of a film. Only camera.toml must be there; lists of files that are not are empty.
struct TruthFolder {
  std::filesystem::path folder;
  std::filesystem::path
      part;               ///< where what is true of the body lies: folder, or bodies/NAME in it
  double depth_unit = 0;  ///< m per count of depth/, in truth and result
  double frames_per_second = 0;               ///< > 0
  int frames = 0;                             ///< > 0
  std::vector<TrueContact> contacts;          ///< one per frame
  std::vector<StampedPose> trajectory;        ///< one per frame
  std::map<int, std::vector<Capsule>> hands;  ///< per frame, camera frame; no entry: no hand
  std::vector<TrueRowOffset> rows;
  std::optional<TrueSkins> deformed;
  std::optional<TrueBody> body;           ///< body.ply, else deformed/rest.ply
  std::optional<Rigid3> world_from_body;  ///< scene.toml, here or in frames/ beside the truth

  /// Where the body truly stands, camera_from_body; nothing where body or camera is not known.
  [[nodiscard]] std::optional<Rigid3> pose_at(int frame) const;
  /// The hand in the body's frame; none where there is none, or the body's place is not known.
  [[nodiscard]] std::vector<Capsule> hand_at_body(int frame) const;
  /// Whether half or more of what touches is seen by a camera (touch_recall.h); so it is where that
  /// is not said. What no camera sees is true, but nobody is to blame.
  [[nodiscard]] bool is_seen(int frame) const;
};

struct FoundTouch {
  int site = -1;                              ///< -1: not said
  std::optional<double> level;                ///< of the site's full load
  std::optional<Eigen::Vector3d> force = {};  ///< N, on the body, body frame
  bool by_body = false;                       ///< another body presses, nothing real
};

/// What a system left that was shown the film. Nothing is there that the folder does not hold.
struct ResultFolder {
  std::filesystem::path folder;
  std::filesystem::path meshes;  ///< where the body's are, if any
  /// (frames of the truth) 1 where live.json counts the frame as processed; all 1 without it.
  std::vector<std::uint8_t> processed;
  std::optional<Rigid3> camera_from_body;                         ///< live.json
  std::optional<std::map<int, std::vector<FoundTouch>>> touches;  ///< by frame; none is empty
  std::optional<std::map<int, Rigid3>> poses;                     ///< camera_from_body by frame
  std::optional<std::vector<StampedPose>> trajectory;
  std::optional<std::vector<RowCorrection>> corrections;

  /// Where the body was drawn: pose.jsonl, else live.json.
  [[nodiscard]] std::optional<Rigid3> pose_at(int frame) const;
  /// Whether it says so of all processed frames.
  [[nodiscard]] bool every_frame_has_a_pose() const;
};

/// @param folder  TRUTH, or the folder that holds truth/
/// @param body    which of several; empty: there is one
/// @throws Error naming file and line when something is missing or makes no sense
[[nodiscard]] TruthFolder read_truth_folder(const std::filesystem::path& folder,
                                            const std::string& body = {});
/// @throws Error as above, and when the folder holds none of the files of a result
[[nodiscard]] ResultFolder read_result_folder(const std::filesystem::path& folder, int frames,
                                              const std::string& body = {});
/// The names of a film's bodies, in the order of the alphabet; none where there is one.
[[nodiscard]] std::vector<std::string> bodies_of_truth(const std::filesystem::path& folder);

}  // namespace palpable
