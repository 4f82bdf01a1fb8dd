/// @file
/// Full-order solutions of a body under the true hand of a clip, for some of its frames: the truth
/// with which other solutions are compared (docs/benchmark.md).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"
#include "palpable/desk/clip_files/frame_records.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <vector>

namespace palpable {

struct TrueSkinSettings {
  int frames = 24;  ///< at most, spread over touches no deeper than a tenth of the height
  int threads = 2;
  /// Coulomb's coefficient between hand and body; nothing: as the clip states (friction_choice.h).
  std::optional<double> friction = {};
  /// The body file that was baked from the description. Its skin, and the mesh, law and constants
  /// that were stored beside it (solid_file.h), must be those that are solved here. Empty: no
  /// comparison.
  std::filesystem::path baked = {};
};

/// Figures of the solution at one frame.
struct TrueFrame {
  DeformedLine line;
  double largest_displacement = 0;  ///< m
  double largest_von_mises = 0;     ///< Pa
  double entry = 0;                 ///< m, largest penetration of the hand, see ContactState
  double path_change = 0;           ///< relative change of the skin with half the step
  bool was_there = false;           ///< solved by an earlier run; then only `line` is known
};

/// Solves and writes truth/deformed of a clip. The hand is followed from the first frame of each
/// touch, frame by frame, and once more by half frames. Where the two solutions differ by more than
/// 1 % (relative L2 over the skin), the solution depends on the path, and the frame is not scored.
/// Frames that an earlier run has written there are kept.
///
/// The mesh is made from the description, as `bake` makes it. It is compared with the one of the
/// body that was filmed, because another version of the mesher, another machine or an edited
/// description may make a different mesh.
///
/// @return the frames, increasing
/// @throws Error for a clip without a touch; when the description makes another skin than that of
///         the body that was filmed (truth/body.ply, or `baked`), or another mesh, law or constants
///         than are stored beside `baked`; when the hand's touches do not lie on this body; when
///         truth/deformed is of another body; and as pose_body(), read_clip_hands()
[[nodiscard]] std::vector<TrueFrame> write_true_skins(const std::filesystem::path& clip,
                                                      const BodyDescription& description,
                                                      const TrueSkinSettings& settings,
                                                      const Progress& progress);

}  // namespace palpable
