/// @file
/// contact.jsonl of a truth: whether the hand reaches into the undeformed body, a line per frame,
///
///     {"frame":7,"touching":false,"depth_m":0,"site":-1,"gap_m":0.012000}
///     {"frame":8,"touching":true,"depth_m":0.004100,"site":3,"point":[0.010000,0.020000,0.030000],
///      "seen_share":0.750}                                                          (one line)
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct ContactLine {
  int frame = 0;
  bool touching = false;
  double depth = 0;                           ///< m; "depth_m"
  int site = -1;                              ///< nearest one; -1: none is near, or nothing touches
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame; of a touch
  /// m, "gap_m": from the nearest thing that moves to the undeformed body, where nothing touches.
  std::optional<double> gap = {};
  /// Of a touch: the share of what touches that a camera can see. See script/seen_share.h.
  std::optional<double> seen_share = {};
};

/// One line, its end included.
[[nodiscard]] std::string contact_line(const ContactLine& contact);

/// Only "frame" and "touching" must be there; the depth is 0 where it is not said.
/// @throws Error naming file and line when frames do not rise, or a value makes no sense
[[nodiscard]] std::vector<ContactLine> read_contacts(const std::filesystem::path& path);

}  // namespace palpable
