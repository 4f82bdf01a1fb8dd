/// @file
/// contact.jsonl of a truth: whether the hand reaches into the undeformed body, a line per frame,
///
///     {"frame":7,"touching":false,"depth_m":0,"site":-1}
///     {"frame":8,"touching":true,"depth_m":0.004100,"site":3,"point":[0.010000,0.020000,0.030000]}
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
};

/// One line, its end included.
[[nodiscard]] std::string contact_line(const ContactLine& contact);

/// Depth and point are scored by nothing and 0 or nothing where they are not said.
/// @throws Error naming file and line when frames do not rise or "touching" is neither true nor
/// false
[[nodiscard]] std::vector<ContactLine> read_contacts(const std::filesystem::path& path);

}  // namespace palpable
