/// @file
/// The user's options on which the results of a run depend, in the words of the command line and of
/// recordings. An option that changes results belongs here: its member, its setting of the library
/// (session_settings), and its key in recordings (add_run_options, run_options_of).
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/session/session.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {

/// Options of --contact paper.
struct PaperOptions {
  int step = 0;                          ///< px; 0: default
  std::optional<double> press_distance;  ///< m; empty: default
  std::optional<double> release_distance;
  std::string nodes;     ///< "sites", "all"; empty: "sites"
  std::string distance;  ///< "grid", "voxmap"; empty: "grid"

  /// @throws Error when an option does not apply to `contact`, or the distances are not in order
  void check(const std::string& contact) const;
};

struct RunOptions {
  std::string contact;  ///< "anywhere", "site", "paper"; empty: depends on the body's tables
  PaperOptions paper;
  std::string matcher = "census";  ///< or "opencv"
  std::string depth;               ///< one of kDepthSizes; empty: the first
  double farthest = 0;             ///< m; 0: the default
  bool fixed_camera = false;
  bool press_static = false;
  /// Coulomb's coefficient of friction of all skins; none: that of each body file
  std::optional<double> friction;
  /// Bodies whose files have vibration modes have inertia; none: only without a camera.
  std::optional<bool> dynamics;
  std::filesystem::path refine;  ///< the body's description; empty: no refinement
};

/// Names of the resolutions of stereo matching; the first is the default.
inline constexpr std::array<std::string_view, 3> kDepthSizes = {"half", "full", "auto"};

/// Sets the resolution and the largest depth. @param size, farthest  as in RunOptions
void set_depth(std::string_view size, double farthest, DepthSettings& depth);

/// The settings from all options except `refine` and `friction` (read_live_body()).
[[nodiscard]] SessionSettings session_settings(const RunOptions& options);

/// Adds the options to the JSON of a recording. Options of --contact paper that were not given are
/// written as their values, so that a replay does not change when a default changes.
void add_run_options(const RunOptions& options, Json& run);
/// Reads them from it. @throws Error, without a file's name, for words that are not known
[[nodiscard]] RunOptions run_options_of(const Json& run);

}  // namespace palpable
