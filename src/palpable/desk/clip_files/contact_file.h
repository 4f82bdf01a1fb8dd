/// @file
/// contact.jsonl of a truth: whether the hand reaches into the undeformed body, one line per frame:
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
  int site = -1;                              ///< nearest site; -1: no touch, or no site near
  std::optional<Eigen::Vector3d> point = {};  ///< m, body frame; only of a touch
  /// m, "gap_m": distance of the undeformed body from the nearest moving thing; only without a
  /// touch.
  std::optional<double> gap = {};
  /// Share of the touching surface that the cameras can see (script/seen_share.h); only of a touch.
  std::optional<double> seen_share = {};
};

/// One line, including its line end.
[[nodiscard]] std::string contact_line(const ContactLine& contact);

/// Only "frame" and "touching" are required; a missing depth is read as 0.
/// @throws Error naming file and line when frame numbers do not increase or a value is out of range
[[nodiscard]] std::vector<ContactLine> read_contacts(const std::filesystem::path& path);

}  // namespace palpable
