/// @file
/// A scene as a user writes it (scenes/*.toml): which bodies, where they stand, how they look.
///
///     [[body]]
///     name = "upper"                       # in files and captions; every body another
///     file = "../out/beam.palpable"        # found from the scene file's folder
///     description = "../bodies/beam.toml"  # what it is baked from; says how, where it is missing
///     beside = "lower"                     # or anchor = "scene", "plane", "board" or "place"
///     at = ["0 mm", "0 mm", "75 mm"]       # from the anchor: right, away, up
///     turn = 90                            # degrees about its upright axis
///     scale = 1
///     set = ["stiffness=0.8"]              # its further parameters
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

/// How it is found out where a body stands.
enum class Anchor {
  kPlace,  ///< somebody says it, else the scene.toml beside the images (place.h)
  kPlane,  ///< on the desk that the first frames show (player/anchoring.h)
  kBoard   ///< on the chessboard that they show
};

/// Where one of several bodies stands.
struct BodyPlace {
  std::optional<Anchor> anchor = {};  ///< nothing: where the scene stands
  std::optional<Rigid3> place = {};   ///< of kPlace: camera_from_anchor in the first frame
  int beside = -1;                    ///< number of an earlier body whose frame is the anchor
  Rigid3 anchor_from_body = Rigid3::Identity();
};

/// One of a scene's bodies, before its file is read.
struct DescribedBody {
  std::string name = {};
  std::filesystem::path file;              ///< the body file
  std::filesystem::path description = {};  ///< what it is baked from; empty: not said
  std::string method = {};                 ///< of the bake; empty: the usual one
  BodyPlace place = {};
  double scale = 1;
  std::vector<std::string> set = {};  ///< NAME=VALUE
  std::optional<Rgb> color = {};
};

/// @return at least one body; names differ
/// @throws Error naming file, line and key
[[nodiscard]] std::vector<DescribedBody> read_scene_description(const std::filesystem::path& path);

/// Where the bodies stand in the scene's own frame, which is the anchor of those that name none.
/// @throws Error naming a body that an image has to place
[[nodiscard]] std::vector<Rigid3> scene_from_bodies(const std::vector<DescribedBody>& bodies);

/// @throws Error that says how to make a body file, where it is not there yet.
/// @param scene  the file that names the body
void expect_baked(const DescribedBody& body, const std::filesystem::path& scene);

}  // namespace palpable
