/// @file
/// Things that press a body at random places, for comparing answers to touch with the full one.
#pragma once

#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/held_out_touch.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// A thing and its way into the body: one that just touches at depth 0.
struct TouchScene {
  PressingThing thing = PressingThing::kFinger;
  Obstacle touching;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();  ///< unit
  Obstacle other;                                 ///< of a squeeze: comes the other way
};

/// The obstacle at a depth, m: how far it has gone on since it just touched.
[[nodiscard]] Obstacle obstacle_at(const TouchScene& scene, double depth);

/// `each` scenes of a thing, at random vertices that are not held and not in the lowest 15 % of the
/// body's height, along the skin's mean normal within 12 mm. The same for the same seed.
[[nodiscard]] std::vector<TouchScene> touch_scenes(const SkinResponse& skin, PressingThing thing,
                                                   int each, std::uint64_t seed);

}  // namespace palpable
