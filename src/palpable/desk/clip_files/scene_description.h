/// @file
/// A scene as a user writes it (scenes/*.toml): its bodies, their poses and their appearance.
///
///     [[body]]
///     name = "upper"                       # in files and captions; unique
///     file = "../out/beam.palpable"        # relative to the scene file's folder
///     description = "../bodies/beam.toml"  # its source; for the hint if the file is missing
///     beside = "lower"                     # or anchor = "scene", "plane", "board" or "place"
///     at = ["0 mm", "0 mm", "75 mm"]       # from the anchor: right, away, up
///     turn = 90                            # degrees about its upright axis
///     scale = 1
///     set = ["stiffness=0.8"]              # values of its parameters
///     color = [200, 120, 80]               # of its material
///
/// docs/scenes.md explains every key.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// What determines the pose of a body.
enum class Anchor {
  kPlace,  ///< the user, else the scene.toml beside the images (place.h)
  kPlane,  ///< the desk top that the first frames show (player/anchoring.h)
  kBoard   ///< the chessboard that they show
};

/// The position of one of several bodies.
struct BodyPlace {
  std::optional<Anchor> anchor = {};  ///< nothing: the scene's own frame
  std::optional<Rigid3> place = {};   ///< camera_from_anchor in the first frame, for a given place
  int beside = -1;  ///< index of an earlier body whose frame is the anchor; -1: none
  Rigid3 anchor_from_body = Rigid3::Identity();
};

/// One body of a scene before its file is read.
struct DescribedBody {
  std::string name = {};
  std::filesystem::path file;              ///< the body file
  std::filesystem::path description = {};  ///< what it is baked from; empty: not given
  std::string method = {};                 ///< of the bake; empty: the default
  BodyPlace place = {};
  double scale = 1;
  std::vector<std::string> set = {};  ///< NAME=VALUE
  std::optional<Rgb> color = {};
};

/// @return at least one body; their names differ
/// @throws Error naming file, line and key
[[nodiscard]] std::vector<DescribedBody> read_scene_description(const std::filesystem::path& path);

/// The poses of the bodies in the scene's own frame, which is the anchor of bodies without one.
/// @throws Error naming a body whose anchor is only known from images
[[nodiscard]] std::vector<Rigid3> scene_from_bodies(const std::vector<DescribedBody>& bodies);

/// @throws Error that says how to bake the body file if it does not exist yet
/// @param scene  the scene file that names the body
void expect_baked(const DescribedBody& body, const std::filesystem::path& scene);

}  // namespace palpable
