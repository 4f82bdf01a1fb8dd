/// @file
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
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

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
};

struct TouchesLine {
  int frame = 0;
  std::vector<FeltTouch> touches;
  /// Stated errors of displacement and stress, relative (1 = 100 %).
  std::optional<double> displacement_error = {}, stress_error = {};
  std::string body = {};  ///< name of the body; empty: there is only one
};

/// One line, including its line end; unknown values are left out.
[[nodiscard]] std::string touches_line(const TouchesLine& line);

/// @return sorted by frame; the touches of several lines with the same frame are joined in one list
/// @param body  lines that name another body are skipped
/// @throws Error naming file and line when a frame, site, level or a force in a list is invalid.
/// The other values affect no score: invalid ones count as unknown
[[nodiscard]] std::vector<TouchesLine> read_touches(const std::filesystem::path& path,
                                                    const std::string& body = {});

}  // namespace palpable
