/// @file
/// The true things of a film as obstacles, in the form in which a camera's surface is: balls.
#pragma once

#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touch_state.h"

#include <span>
#include <vector>

namespace palpable::app {

/// N, the size of the sum of a state's forces.
[[nodiscard]] double force_size(const TouchState& state);

/// Adds balls that fill a capsule, 1 mm apart: the ripples on a finger are 0.02 mm high.
/// @param capsule  camera frame, m
void add_balls(const Capsule& capsule, const Rigid3& body_from_camera,
               std::vector<ObjectBall>& balls);

/// The balls of all capsules, body frame.
[[nodiscard]] std::vector<ObjectBall> balls_of(std::span<const Capsule> capsules,
                                               const Rigid3& body_from_camera);

}  // namespace palpable::app
