/// @file
/// A body that is pressed by exact capsules instead of what a camera sees, as in a game or with a
/// haptic device.
#pragma once

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/session/scene.h"

#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// Keeps the body's state from call to call. Allocates nothing once as many capsules have pressed.
class CapsulePress {
 public:
  /// @param body  with tables of touch
  explicit CapsulePress(std::shared_ptr<const TouchableBody> body);
  CapsulePress(const CapsulePress&) = delete;  // one state, one owner
  CapsulePress& operator=(const CapsulePress&) = delete;

  /// @param capsules  body frame
  /// @param shown     shape, normals, stress and stated error are overwritten
  /// @param touches   overwritten, the strongest first
  TouchReport advance(std::span<const Capsule> capsules, SceneBody& shown,
                      std::vector<Touch>& touches);
  /// The additional arrays that shown bodies have from now on; none at first.
  void keep(const SceneExtras& extras) { extras_ = extras; }
  /// Sets the body back to rest.
  void forget() { state_ = TouchState(); }

 private:
  std::shared_ptr<const TouchableBody> body_;
  SkinContact contact_;
  TouchState state_;
  CapsuleObstacles obstacles_;
  SceneExtras extras_;
};

}  // namespace palpable
