/// @file
/// Reads and checks the text files of the scored folders, TRUTH and RESULT of docs/benchmark.md.
/// Images are read frame by frame (image_scores.h).
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/score/camera_scores.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TrueContact {
  bool touching = false;
  int site = -1;     ///< -1: between sites, or no touch
  double depth = 0;  ///< m; 0: no touch, or not given
  /// m, distance of the nearest moving thing from the undeformed body: 0 in a touch, infinite when
  /// nothing is there. Nothing when not known.
  std::optional<double> gap = {};
  double seen_share = 1;                      ///< of the touching surface; 1 if not given
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame: the deepest point
};

/// truth/deformed: the full-order solutions of some frames. Their skins are read one by one
/// (frame_records.h).
struct TrueSkins {
  SurfaceMesh rest;
  std::vector<DeformedLine> lines;  ///< at least one, sorted by frame
};

/// The filmed body at rest.
struct TrueBody {
  SurfaceMesh rest;            ///< m, body frame
  std::filesystem::path file;  ///< file of the mesh
};

/// The truth of a film. Only camera.toml is required; the lists of missing files are empty.
struct TruthFolder {
  std::filesystem::path folder;
  std::filesystem::path
      part;               ///< folder with the truth of the body: `folder`, or bodies/NAME in it
  std::string film;       ///< name of the sequence; empty: not a film of `palpable synth`
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

  /// True camera_from_body; nothing when the pose of body or camera is not known.
  [[nodiscard]] std::optional<Rigid3> pose_at(int frame) const;
  /// The hand in the body frame; empty when there is no hand or the body's pose is not known.
  [[nodiscard]] std::vector<Capsule> hand_at_body(int frame) const;
  /// Whether the cameras see at least half of the touching surface (kSeenFrom); true when this
  /// is not given. Touches that are not seen are counted but do not enter the scores.
  [[nodiscard]] bool is_seen(int frame) const;
};

struct FoundTouch {
  int site = -1;                              ///< -1: not given
  std::optional<double> level;                ///< share of the site's full load
  std::optional<Eigen::Vector3d> force = {};  ///< N, on the body, body frame
  bool by_body = false;                       ///< another body presses, not a real obstacle
};

/// The result of a system that processed the film. Members whose files are missing are nothing.
struct ResultFolder {
  std::filesystem::path folder;
  std::filesystem::path meshes;  ///< folder of the body's meshes, if there is one
  /// One entry per frame of the truth: 1 if live.json lists the frame as processed. All 1 without
  /// it.
  std::vector<std::uint8_t> processed;
  RunSpeed speed;                                                 ///< of live.json
  std::optional<Rigid3> camera_from_body;                         ///< of live.json
  std::optional<std::map<int, std::vector<FoundTouch>>> touches;  ///< by frame; no list is empty
  std::optional<std::map<int, Rigid3>> poses;                     ///< camera_from_body by frame
  std::optional<std::vector<StampedPose>> trajectory;
  std::optional<std::vector<RowCorrection>> corrections;

  /// camera_from_body as drawn: from pose.jsonl, else from live.json.
  [[nodiscard]] std::optional<Rigid3> pose_at(int frame) const;
  /// Whether pose_at() is known for all processed frames.
  [[nodiscard]] bool every_frame_has_a_pose() const;
};

/// @param folder  TRUTH, or the folder that holds truth/
/// @param body    name of one of several bodies; empty: there is only one
/// @throws Error naming file and line when something is missing or invalid
[[nodiscard]] TruthFolder read_truth_folder(const std::filesystem::path& folder,
                                            const std::string& body = {});
/// @throws Error as above, and when the folder holds none of the files of a result
[[nodiscard]] ResultFolder read_result_folder(const std::filesystem::path& folder, int frames,
                                              const std::string& body = {});
/// The names of the bodies of a film, sorted; empty for a film with one body.
[[nodiscard]] std::vector<std::string> bodies_of_truth(const std::filesystem::path& folder);

}  // namespace palpable
