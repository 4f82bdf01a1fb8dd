/// @file
/// truth/deformed of a clip: the skin of a body as the true hand deforms it, for some frames.
///
///     rest.ply        the skin at rest, m, body frame
///     000148.ply      the deformed skin: the same vertices and triangles in the same
///                     order, with the property von_mises (Pa) at each vertex
///     deformed.jsonl  one line per frame:
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

/// One line, including its line end.
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

}  // namespace palpable
