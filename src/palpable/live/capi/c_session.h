/// @file
/// The objects behind the handles of palpable.h.
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/capi/setup.h"
#include "palpable/live/session/capsule_press.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/session/scene.h"

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/// A body file that was read, and a pose. Sessions on the same body share the data.
struct palpable_body {
  std::shared_ptr<const palpable::TouchableBody> body;
  palpable::Rigid3 world_from_body = palpable::Rigid3::Identity();
};

/// Either the loop of a camera or capsules that press one body. Both fill a scene.
struct palpable_session {
  /// @param camera  empty for a session without a camera
  /// @throws Failure when the bodies do not suit the session or FrameLoop rejects the settings
  palpable_session(std::vector<palpable_body> bodies, std::optional<palpable::CameraSetup> camera);
  palpable_session(const palpable_session&) = delete;
  palpable_session& operator=(const palpable_session&) = delete;

  /// Back to the state before the first frame.
  void reset();

  /// Processes the frame in `images`.
  /// @param pose  null: the camera stands still or is followed. Else the pose of this frame, empty
  ///              where it is unknown
  void process_images(const std::optional<palpable::Rigid3>* pose);
  static constexpr std::size_t kMostCapsules = 4096;
  void process_capsules(std::span<const palpable_capsule> capsules);

  [[nodiscard]] const palpable::Scene& scene() const { return loop_ ? loop_->scene : pressed_; }

  const std::vector<palpable_body> bodies;
  const std::optional<palpable::CameraSetup> camera;

  palpable::Frame images;  ///< the next frame, filled by the caller
  int frames = 0;          ///< processed so far
  double first_time = 0, time = std::numeric_limits<double>::quiet_NaN();  ///< s, caller's clock
  bool gives_poses = false;  ///< the caller passes a pose with every frame
  bool wrong_pair = false;
  double left_to_go = 0;   ///< m, palpable_frame::left_to_go
  bool is_broken = false;  ///< a call was interrupted by an exception

 private:
  void show_rest(palpable::Scene& scene) const;

  std::optional<palpable::FrameLoop> loop_;
  std::unique_ptr<palpable::CapsulePress> press_;
  std::vector<palpable::Capsule> in_body_;
  palpable::Scene pressed_;
};
