/// @file
/// The full finite-element answer of a scene's bodies to the true hand of a clip, all of them
/// solved together: what the hand presses presses what lies below it.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/deformed_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// One of the bodies, as a scene describes it.
struct SceneSolid {
  std::string name;
  BodyDescription description;
  double scale = 1;
  Rigid3 scene_from_body = Rigid3::Identity();
};

struct SceneSkinSettings {
  int frames = 10;  ///< at most, spread over those that touch
  int threads = 2;
};

/// A frame's answer in figures, of one body.
struct TrueSceneFrame {
  std::string body;
  DeformedLine line = {};           ///< force: of the hand and of the other bodies together
  double largest_displacement = 0;  ///< m
  double between = 0;               ///< N, of the other bodies
  bool was_there = false;           ///< from an earlier run; then only `line` is known
};

/// Solves and writes truth/bodies/NAME/deformed of each body. The way of the hand is followed from
/// the first frame of each touch, frame by frame, and once more by half frames: where the two
/// differ by more than 1 % (relative L2 over all skins), the frame is not scored. What
/// an earlier run left there is kept.
///
/// @return the frames, rising, body by body
/// @throws Error for a clip without a touch, of another scene, or whose bodies were another size;
///         for bodies under their own weight, of 10-node tetrahedra, or with supports that hold
///         some directions only where they are turned; and as pose_body(), read_clip_hands()
[[nodiscard]] std::vector<TrueSceneFrame> write_scene_skins(const std::filesystem::path& clip,
                                                            const std::vector<SceneSolid>& solids,
                                                            const SceneSkinSettings& settings,
                                                            const Progress& progress);

}  // namespace palpable
