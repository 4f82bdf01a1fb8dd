/// @file
/// truth/deformed of a clip: the true deformed skin of a body under the true hand, for some frames.
///
///     rest.ply        the skin at rest, m, body frame
///     000148.ply      the deformed one: the same vertices and triangles in the same order, with
///     the
///                     property von_mises (Pa) at each vertex
///     deformed.jsonl  a line per frame:
///                     {"frame":148,"body":0,"depth_m":0.0041,"force":[fx,fy,fz],
///                      "point":[x,y,z],"scored":true}
#pragma once

#include "palpable/common/geometry/mesh_file.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// What is true of a frame, but for the skin.
struct DeformedLine {
  int frame = 0;
  int body = 0;                                     ///< which of several
  double depth = 0;                                 ///< m, as in contact.jsonl; "depth_m"
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, of all that touches, on the body
  std::optional<Eigen::Vector3d> point = {};        ///< m, where it acts; absent without force
  bool scored = true;
  std::string why = {};  ///< not scored: in words
};

/// One line, its end included.
[[nodiscard]] std::string deformed_line(const DeformedLine& line);

/// The lines of truth/deformed, in any order of frames; of a frame that stands there twice the
/// last. Nothing where there is no such file.
/// @throws Error naming file and line for what cannot be read
[[nodiscard]] std::vector<DeformedLine> read_deformed_lines(const std::filesystem::path& folder);

/// truth/deformed/000148.ply
[[nodiscard]] std::filesystem::path deformed_skin_file(const std::filesystem::path& folder,
                                                       int frame);

/// truth/body.ply: the skin at rest of the body that was filmed, m, body frame.
inline constexpr std::string_view kBodySkinFile = "body.ply";

/// The property that carries the von Mises stress, Pa.
inline constexpr std::string_view kVonMisesProperty = "von_mises";

}  // namespace palpable
