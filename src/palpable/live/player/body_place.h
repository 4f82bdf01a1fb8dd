/// @file
/// Where the bodies of a run are to stand, and what of that cannot be.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_description.h"
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
  std::string name = {};  ///< empty: the body's own
  BodyPlace place = {};
  std::optional<Rgb> color = {};  ///< of its material; none: rubber
};

/// Where bodies with these places stand, in the same order.
/// @param world_from_anchor  asked only where a body needs it; what it throws is passed on
[[nodiscard]] std::vector<Rigid3> world_from_bodies(
    const std::vector<BodyPlace>& places, Anchor of_run,
    const std::function<Rigid3(Anchor)>& world_from_anchor);

/// The room that all bodies take that stand on a plane, around its anchor (free_place.h). At most 1
/// m around.
/// @param skins  at rest, of each body that has a place, in the same order
[[nodiscard]] Footprint footprint_of(const std::vector<BodyPlace>& places,
                                     const std::vector<const SurfaceMesh*>& skins, Anchor of_run);

/// The bodies where they stand, in the same order.
/// @param world_from_anchor  asked only where a body needs it; what it throws is passed on
[[nodiscard]] std::vector<PlacedBody> placed(
    std::vector<LiveBody> bodies, Anchor of_run,
    const std::function<Rigid3(Anchor)>& world_from_anchor);

/// What to say of two bodies of which one stands in the other, at rest, by more than 0.2 mm;
/// nothing where none does.
[[nodiscard]] std::optional<std::string> overlap_of(const std::vector<PlacedBody>& bodies);

}  // namespace palpable
