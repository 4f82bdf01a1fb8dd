/// @file
/// Full-order solutions of all bodies of a scene under the true hand of a clip. They are solved
/// together, since a body that the hand presses may press the one below it.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/frame_records.h"

#include <filesystem>
#include <optional>
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
  int frames = 10;  ///< at most, evenly spread over the touching ones
  int threads = 2;
  /// Coulomb's coefficient of all contacts; nothing: as the clip states (friction_choice.h).
  std::optional<double> friction = {};
};

/// Figures of the solution of one body at one frame.
struct TrueSceneFrame {
  std::string body;
  DeformedLine line = {};           ///< its force: of the hand and the other bodies together
  double largest_displacement = 0;  ///< m
  double between = 0;               ///< N, force of the other bodies
  bool was_there = false;           ///< solved by an earlier run; then only `line` is known
};

/// Solves and writes truth/bodies/NAME/deformed of each body. The hand is followed from the first
/// frame of each touch, frame by frame, and once more by half frames. Where the two solutions
/// differ by more than 1 % (relative L2 over all skins), the frame is not scored. Frames that an
/// earlier run has written there are kept.
///
/// @return the frames, increasing, body by body
/// @throws Error for a clip without a touch, of another scene, or whose bodies were another size;
/// for
///         solutions with another coefficient of friction;
///         for bodies under their own weight, of 10-node tetrahedra, or, if turned, with supports
///         that hold some directions only; and as pose_body(), read_clip_hands()
[[nodiscard]] std::vector<TrueSceneFrame> write_scene_skins(const std::filesystem::path& clip,
                                                            const std::vector<SceneSolid>& solids,
                                                            const SceneSkinSettings& settings,
                                                            const Progress& progress);

}  // namespace palpable
