/// @file
/// The text files of a clip's truth and of a run's results with a line per frame:
///
///     truth     hand.jsonl, contact.jsonl, deformed/deformed.jsonl, rig.jsonl
///     results   touches.jsonl, pose.jsonl, rectification.jsonl, timing.csv
///
/// Each NAME_line() returns one line, including its line end.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// hand.jsonl of a truth: the capsules of all moving things, one line per frame:
///
///     {"frame":7,"capsules":[[ax,ay,az,bx,by,bz,ra,rb],...]}
///
/// Lengths are in metres, in the frame of the camera at that instant.
struct HandLine {
  int frame = 0;
  std::vector<Capsule> capsules;
};

[[nodiscard]] std::string hand_line(const HandLine& hand);

/// @throws Error naming file and line when frame numbers do not increase, when a capsule is not
/// eight numbers or when a radius is negative
[[nodiscard]] std::vector<HandLine> read_hands(const std::filesystem::path& path);

/// contact.jsonl of a truth: whether the hand reaches into the undeformed body, one line per frame:
///
///     {"frame":7,"touching":false,"depth_m":0,"site":-1,"gap_m":0.012000}
///     {"frame":8,"touching":true,"depth_m":0.004100,"site":3,"point":[0.010000,0.020000,0.030000],
///      "seen_share":0.750}                                                          (one line)
struct ContactLine {
  int frame = 0;
  bool touching = false;
  double depth = 0;                           ///< m; "depth_m"
  int site = -1;                              ///< nearest site; -1: no touch, or no site near
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame; only of a touch
  /// m, "gap_m": distance of the undeformed body from the nearest moving thing; only without a
  /// touch.
  std::optional<double> gap = {};
  /// Share of the touching surface that the cameras can see (script/seen_share.h); only of a touch.
  std::optional<double> seen_share = {};
};

[[nodiscard]] std::string contact_line(const ContactLine& contact);

/// Only "frame" and "touching" are required; a missing depth is read as 0.
/// @throws Error naming file and line when frame numbers do not increase or a value is out of range
[[nodiscard]] std::vector<ContactLine> read_contacts(const std::filesystem::path& path);

/// truth/deformed of a clip: the skin of a body as the true hand deforms it, for some frames.
///
///     rest.ply        the skin at rest, m, body frame
///     000148.ply      the deformed skin: the same vertices and triangles in the same
///                     order, with the property von_mises (Pa) at each vertex
///     deformed.jsonl  one line per frame:
///                     {"frame":148,"body":0,"depth_m":0.0041,"force":[fx,fy,fz],
///                      "point":[x,y,z],"scored":true}
///
/// The truth of one frame except for the skin.
struct DeformedLine {
  int frame = 0;
  int body = 0;                                     ///< index of the body in a scene
  double depth = 0;                                 ///< m, as in contact.jsonl; "depth_m"
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, total contact force on the body
  std::optional<Eigen::Vector3d> point = {};  ///< m, where the force acts; absent without force
  bool scored = true;
  std::string why = {};  ///< in words why the frame is not scored
};

[[nodiscard]] std::string deformed_line(const DeformedLine& line);

/// The lines of deformed.jsonl in `folder`, sorted by frame; the file may hold them in any order.
/// If a frame has several lines, the last one counts. Empty if there is no such file.
/// @throws Error naming file and line of what cannot be read
[[nodiscard]] std::vector<DeformedLine> read_deformed_lines(const std::filesystem::path& folder);

/// truth/deformed/000148.ply
[[nodiscard]] std::filesystem::path deformed_skin_file(const std::filesystem::path& folder,
                                                       int frame);

/// truth/body.ply: skin of the filmed body at rest, m, body frame.
inline constexpr std::string_view kBodySkinFile = "body.ply";

/// The property that carries the von Mises stress, Pa.
inline constexpr std::string_view kVonMisesProperty = "von_mises";

/// rig.jsonl of a truth: the misalignment of the rig, one line per frame:
///
///     {"frame":7,"row_offset_px":0.0700}
///     {"frame":8,"row_offset_px":0.5700,"step":true}
///
/// The right image lies row_offset_px rows of the full-size picture lower than the calibration
/// says. "step": the offset jumped in this frame.
struct RigLine {
  int frame = 0;
  double row_offset_px = 0;
  bool step = false;
};

[[nodiscard]] std::string rig_line(const RigLine& rig);

/// @throws Error naming file and line when frame numbers do not increase or an offset is no number
[[nodiscard]] std::vector<RigLine> read_rig(const std::filesystem::path& path);

/// A touch in touches.jsonl.
struct FeltTouch {
  int site = -1;                              ///< index in the body file; -1: not given
  std::optional<double> level = {};           ///< >= 0, share of the site's full load
  std::optional<double> press_depth = {};     ///< m
  std::optional<Eigen::Vector3d> force = {};  ///< N, on the body, body frame
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame
  std::optional<double> time = {};            ///< s
  std::optional<double> area = {};            ///< m^2, pressed part of the skin
  /// Share of the force where the camera does not see the obstacle's surface and it is assumed.
  std::optional<double> assumed = {};
  std::string by = {};  ///< name of the body that presses; empty: a real obstacle
  /// Id of what presses, in runs without a camera (`live --source hands.jsonl`).
  std::optional<std::int64_t> thing = {};
  /// N, the part of the force that is friction, body frame; nothing without friction.
  std::optional<Eigen::Vector3d> friction = {};
  /// Coulomb's coefficient between body and what presses; nothing without friction.
  std::optional<double> friction_coefficient = {};
  /// What presses was taken to move as its thing does in the mean (Touch::way_is_mean).
  bool mean_motion = false;
  /// Contact points for which there was no room (Touch::left_out); nothing if there was.
  std::optional<double> left_out = {};
};

/// touches.jsonl of a result: where and how hard the body is pressed, one line for each frame with
/// a touch:
///
///     {"frame":7,"touches":[{"site":3,"level":0.500000,"press_depth":0.0040000,
///      "force":[0.1,0.2,-1.3],"point":[0.010000,0.020000,0.030000],"time":0.233333}]}  (one line)
///
/// The strongest touch comes first. Touches of a body with tables have no site and no level but
/// "area" and "assumed", and the list is followed by "displacement_error" and "stress_error".
/// If there are several bodies, each has its own lines, which name it ("body":"upper"), and a touch
/// by another body names that body ("by":"lower").
///
/// Only "frame" is required; an empty list means no touch. Until issue 24 a line held one touch,
/// {"frame":7,"site":3,"level":0.5,...}, with the magnitude of its force: such lines are still
/// read, without the force.
struct TouchesLine {
  int frame = 0;
  std::vector<FeltTouch> touches;
  /// Stated errors of displacement and stress, relative (1 = 100 %).
  std::optional<double> displacement_error = {}, stress_error = {};
  std::string body = {};  ///< name of the body; empty: there is only one
  /// In runs without a camera, of all bodies: "reached", or "later" and "not reached", where forces
  /// are not the answer.
  std::string answer = {};
};

/// Unknown values are left out.
[[nodiscard]] std::string touches_line(const TouchesLine& line);

/// @return sorted by frame; the touches of several lines with the same frame are joined in one list
/// @param body  lines that name another body are skipped
/// @throws Error naming file and line when a frame, site, level or a force in a list is invalid.
/// The other values affect no score: invalid ones count as unknown
[[nodiscard]] std::vector<TouchesLine> read_touches(const std::filesystem::path& path,
                                                    const std::string& body = {});

/// pose.jsonl of a result: the pose in which the body was drawn, one line per frame:
///
///     {"frame":7,"camera_from_body":[1,0,0,0.1,0,1,0,0.2,0,0,1,0.4,0,0,0,1]}
///
/// The 16 numbers are the matrix row by row. If there are several bodies, each has a line per frame
/// that names it: "body":"upper".
struct PoseLine {
  int frame = 0;
  Rigid3 camera_from_body = Rigid3::Identity();
  std::string body = {};  ///< name of the body; empty: there is only one
};

[[nodiscard]] std::string pose_line(const PoseLine& pose);

/// @param body  lines that name another body are skipped
/// @throws Error naming file and line when frame numbers do not increase or a pose is no rigid
/// motion
[[nodiscard]] std::vector<PoseLine> read_poses(const std::filesystem::path& path,
                                               const std::string& body = {});

/// rectification.jsonl of a result: the corrections of a rig that lost its alignment, one line per
/// change:
///
///     {"frame":150,"row_correction_px":0.5120,"row_error_px":0.0312}
///
/// From this frame on the right image is moved up by row_correction_px rows of the full-size
/// picture, in addition to the rectification by the calibration. row_error_px remains in this
/// frame.
struct CorrectionLine {
  int frame = 0;
  double row_correction_px = 0;
  std::optional<double> row_error_px;  ///< remaining error; nothing: too few points
};

[[nodiscard]] std::string correction_line(const CorrectionLine& correction);

/// @throws Error naming file and line when frame numbers do not increase or a correction is no
/// number
[[nodiscard]] std::vector<CorrectionLine> read_corrections(const std::filesystem::path& path);

/// timing.csv of a run: the time of each stage in each frame, ms, with "total_ms" last:
///
///     frame,read_ms,rectify_ms,...,total_ms
///     0,1.250,0.310,...,14.022
///
/// F frames, S stages.
struct TimingTable {
  std::vector<std::string> stages;      ///< (S) without "_ms"
  std::vector<int> frames;              ///< (F)
  std::vector<std::vector<double>> ms;  ///< (F) of (S)
};

/// The first line, including its line end. @param stages  without "_ms"
[[nodiscard]] std::string timing_header(std::span<const std::string> stages);
/// The line of a frame. @param ms  in the header's order
[[nodiscard]] std::string timing_line(int frame, std::span<const double> ms);

/// @throws Error naming file and line when the header differs, or when a line has another length or
/// holds something other than numbers
[[nodiscard]] TimingTable read_timing(const std::filesystem::path& path);

}  // namespace palpable
