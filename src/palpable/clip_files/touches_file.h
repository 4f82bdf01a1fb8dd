/// @file
/// touches.jsonl of a result: where and how hard the body is pressed, a line for each touch,
///
///     {"frame":7,"time":0.233333,"site":3,"level":0.500000,"force":1.200000,
///      "press_depth":0.0040000,"point":[0.010000,0.020000,0.030000]}        (one line)
///
/// Only "frame" must be there. Several lines may be of one frame.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TouchLine {
  int frame = 0;
  std::optional<double> time = {};            ///< s
  int site = -1;                              ///< index in the body file; -1: not said
  std::optional<double> level = {};           ///< >= 0, share of the site's full load
  std::optional<double> force = {};           ///< N
  std::optional<double> press_depth = {};     ///< m
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame
};

/// One line, its end included; what is not known is left out.
[[nodiscard]] std::string touch_line(const TouchLine& touch);

/// @throws Error naming file and line when frame, site or level make no sense. The other values are
/// read by nothing that is scored: one that makes no sense counts as not known
[[nodiscard]] std::vector<TouchLine> read_touches(const std::filesystem::path& path);

}  // namespace palpable
