/// @file
/// The full finite-element answer to the true hand of a clip, for some of its frames: what another
/// answer is compared with (docs/benchmark.md).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"
#include "palpable/desk/clip_files/deformed_file.h"

#include <Eigen/Core>

#include <filesystem>
#include <vector>

namespace palpable {

struct TrueSkinSettings {
  int frames = 24;  ///< at most, spread over those that touch no deeper than a tenth of the height
  int threads = 2;
  /// The body file that was baked from the description; empty: it is not asked. Its skin, and what
  /// was kept beside it of its mesh, law and constants (solid_file.h), must be those that are
  /// solved here.
  std::filesystem::path baked = {};
};

/// A frame's answer in figures.
struct TrueFrame {
  DeformedLine line;
  double largest_displacement = 0;  ///< m
  double largest_von_mises = 0;     ///< Pa
  double entry = 0;        ///< m, how deep the hand is in the skin at worst, see ContactState
  double path_change = 0;  ///< relative: how much half the step changes the skin
  bool was_there = false;  ///< from an earlier run; then only `line` is known
};

/// Solves and writes truth/deformed of a clip. The way of the hand is followed from the first frame
/// of each touch, frame by frame, and once more by half frames: where the two differ by more than
/// 1 % (relative L2 over the skin), the answer depends on the way that was taken and the frame is
/// not scored. What an earlier run left there is kept.
///
/// The mesh is made from the description, as `bake` makes it. That it is the one of the body that
/// was filmed is not left to chance: another version of the mesher, another machine or an edited
/// description may make another one.
///
/// @return the frames, rising
/// @throws Error for a clip without a touch; when the description makes another skin than that of
///         the body that was filmed (truth/body.ply, or `baked`), or another mesh, law or constants
///         than were kept beside `baked`; when the hand's touches do not lie on this body; when
///         truth/deformed is of another body; and as pose_body(), read_clip_hands()
[[nodiscard]] std::vector<TrueFrame> write_true_skins(const std::filesystem::path& clip,
                                                      const BodyDescription& description,
                                                      const TrueSkinSettings& settings,
                                                      const Progress& progress);

}  // namespace palpable
