/// @file
/// The poses of a run's bodies, and checks of them.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/map/free_place.h"
#include "palpable/live/session/session.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// A body of a run.
struct LiveBody {
  TouchableBody body;
  std::string name = {};  ///< empty: the name in the body file
  BodyPlace place = {};
  std::optional<Rgb> color = {};  ///< of the material; empty: rubber
};

/// The poses of bodies with these places, in the same order.
/// @param world_from_anchor  called only for anchors that a body uses; its exceptions are passed on
[[nodiscard]] std::vector<Rigid3> world_from_bodies(
    const std::vector<BodyPlace>& places, Anchor of_run,
    const std::function<Rigid3(Anchor)>& world_from_anchor);

/// The area that all bodies on a plane need around its anchor (free_place.h), at
/// most 1 m in radius.
/// @param skins  at rest, of each body, in the order of `places`
[[nodiscard]] Footprint footprint_of(const std::vector<BodyPlace>& places,
                                     const std::vector<const SurfaceMesh*>& skins, Anchor of_run);

/// The bodies with their poses, in the same order.
/// @param world_from_anchor  called only for anchors that a body uses; its exceptions are passed on
[[nodiscard]] std::vector<PlacedBody> placed(
    std::vector<LiveBody> bodies, Anchor of_run,
    const std::function<Rigid3(Anchor)>& world_from_anchor);

/// A message if two bodies at rest penetrate each other by more than 0.2 mm; else empty.
[[nodiscard]] std::optional<std::string> overlap_of(const std::vector<PlacedBody>& bodies);

/// A message with both sizes if the body is larger than the field of view at the body's distance.
/// Empty if it is not, or if the body stands behind the camera.
/// @param body              at rest, body frame; not empty
/// @param camera_from_body  pose of the body in the first frame
[[nodiscard]] std::optional<std::string> larger_than_view(const SurfaceMesh& body,
                                                          const Rigid3& camera_from_body,
                                                          const PinholeCamera& camera);

/// A message if no vertex of the body lies in the camera's picture in the first frame; else empty.
/// @param body, camera_from_body, camera  as above
[[nodiscard]] std::optional<std::string> outside_of_view(const SurfaceMesh& body,
                                                         const Rigid3& camera_from_body,
                                                         const PinholeCamera& camera);

}  // namespace palpable
