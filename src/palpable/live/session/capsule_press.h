/// @file
/// A body that is pressed by exact capsules, without any camera: what a game or a haptic device
/// has.
#pragma once

#include "palpable/common/contact/skin_contact.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_solver.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Geometry>

#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// The distance to the nearest of some capsules.
class CapsuleGaps {
 public:
  /// @param capsules  body frame; keeps its memory
  void set(std::span<const Capsule> capsules);
  [[nodiscard]] bool gap(const Eigen::Vector3f& place, SurfaceGap& gap) const;
  [[nodiscard]] bool is_near(const Eigen::Vector3f& place, float reach) const;

 private:
  std::vector<CapsuleField> fields_;
  std::vector<Eigen::AlignedBox3f> boxes_;
  Eigen::AlignedBox3f box_;  // of all
};

/// Remembers its state from call to call. Allocates nothing once it has pressed with as many
/// capsules.
class CapsulePress {
 public:
  /// @param body  with tables of touch
  explicit CapsulePress(std::shared_ptr<const TouchableBody> body);
  CapsulePress(const CapsulePress&) = delete;  // the solver knows where the gaps are
  CapsulePress& operator=(const CapsulePress&) = delete;

  /// @param capsules  body frame
  /// @param shown     shape, normals, stress and stated error are overwritten
  /// @param touches   overwritten, the strongest first
  TouchReport advance(std::span<const Capsule> capsules, SceneBody& shown,
                      std::vector<Touch>& touches);
  /// What the shown body has beside the rest from now on; to begin with none of it.
  void keep(const SceneExtras& extras) { extras_ = extras; }
  /// As if nothing had pressed yet.
  void forget() { state_ = TouchState(); }

 private:
  std::shared_ptr<const TouchableBody> body_;
  SkinContact contact_;
  TouchState state_;
  CapsuleGaps gaps_;
  ObjectSurface nothing_;  // no camera sees anything
  SceneExtras extras_;
};

}  // namespace palpable
