/// @file
/// touches.jsonl of a result: where and how hard the body is pressed, a line for each frame that
/// feels something,
///
///     {"frame":7,"touches":[{"site":3,"level":0.500000,"press_depth":0.0040000,
///      "force":[0.1,0.2,-1.3],"point":[0.010000,0.020000,0.030000],"time":0.233333}]}  (one line)
///
/// The strongest touch stands first. Where touches are answered anywhere there is no site and no
/// level, but "area" and "assumed", and behind the list "displacement_error" and "stress_error".
/// Where several bodies are played each has its own lines, which name it: "body":"upper"; and a
/// touch by another of them names that: "by":"lower".
///
/// Only "frame" must be there; a list without an entry feels nothing. Until issue 24 a line held
/// one touch, {"frame":7,"site":3,"level":0.5,...}, with the size of its force: such lines are
/// still read, without the force.
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct FeltTouch {
  int site = -1;                              ///< index in the body file; -1: not said
  std::optional<double> level = {};           ///< >= 0, share of the site's full load
  std::optional<double> press_depth = {};     ///< m
  std::optional<Eigen::Vector3d> force = {};  ///< N, on the body, body frame
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame
  std::optional<double> time = {};            ///< s
  std::optional<double> area = {};            ///< m^2 of the skin that is pressed
  /// Share of the force at places of the object that the camera does not see.
  std::optional<double> assumed = {};
  std::string by = {};  ///< which other body presses; empty: something real
};

struct TouchesLine {
  int frame = 0;
  std::vector<FeltTouch> touches;
  /// How far displacement and stress are off, relative, by what the answer tells of itself.
  std::optional<double> displacement_error = {}, stress_error = {};
  std::string body = {};  ///< which of several; empty: there is one
};

/// One line, its end included; what is not known is left out.
[[nodiscard]] std::string touches_line(const TouchesLine& line);

/// By frame, rising; what several lines say of one frame is one list.
/// @param body  lines that name another one are left out
/// @throws Error naming file and line when frame, site, level or the force of a list make no sense.
/// The other values are read by nothing that is scored: one that makes no sense counts as not known
[[nodiscard]] std::vector<TouchesLine> read_touches(const std::filesystem::path& path,
                                                    const std::string& body = {});

}  // namespace palpable
