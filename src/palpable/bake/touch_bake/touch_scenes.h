/// @file
/// Obstacles that press a body at random positions, for comparing the tables' response to touch
/// with the full-order solution.
#pragma once

#include "palpable/bake/solid/obstacle.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/stated_error.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// An obstacle and the direction in which it enters the body.
struct TouchScene {
  PressingThing thing = PressingThing::kFinger;
  Obstacle touching;                              ///< at depth 0, where it just touches the body
  Eigen::Vector3d way = Eigen::Vector3d::Zero();  ///< unit, into the body
  Obstacle other;  ///< kSqueeze: the second obstacle, which moves along -way
};

/// The obstacle at a depth: how far (m) it has advanced since it just touched.
[[nodiscard]] Obstacle obstacle_at(const TouchScene& scene, double depth);

/// `each` scenes of a thing at random vertices, except held ones and those in the lowest 15 % of
/// the body's height. The thing moves against the skin's mean normal within 12 mm of the vertex.
/// There may be fewer scenes of kSqueeze, where a vertex has no opposite side. The same seed gives
/// the same scenes.
[[nodiscard]] std::vector<TouchScene> touch_scenes(const SkinResponse& skin, PressingThing thing,
                                                   int each, std::uint64_t seed);

}  // namespace palpable
