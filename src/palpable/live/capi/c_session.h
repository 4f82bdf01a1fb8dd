/// @file
/// What stands behind the handles of palpable.h.
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

/// Sessions share what was read.
struct palpable_body {
  std::shared_ptr<const palpable::TouchableBody> body;
  palpable::Rigid3 world_from_body = palpable::Rigid3::Identity();
};

/// A camera's loop, or capsules that press one body: both fill a scene.
struct palpable_session {
  /// @param camera  nothing: there is none
  /// @throws Failure when these bodies or numbers make no session
  palpable_session(std::vector<palpable_body> bodies, std::optional<palpable::CameraSetup> camera);
  palpable_session(const palpable_session&) = delete;
  palpable_session& operator=(const palpable_session&) = delete;

  /// As if no frame had come yet.
  void reset();

  /// Answers the images in `images`.
  /// @param pose  of this frame, nothing where it is not known; null: the camera stands or is
  ///              followed
  void answer_images(const std::optional<palpable::Rigid3>* pose);
  static constexpr std::size_t kMostCapsules = 4096;
  void answer_capsules(std::span<const palpable_capsule> capsules);

  [[nodiscard]] const palpable::Scene& scene() const { return loop_ ? loop_->scene : pressed_; }

  const std::vector<palpable_body> bodies;
  const std::optional<palpable::CameraSetup> camera;

  palpable::Frame images;                                                  ///< the next ones
  int frames = 0;                                                          ///< answered so far
  double first_time = 0, time = std::numeric_limits<double>::quiet_NaN();  ///< s, the caller's
  bool gives_poses = false;  ///< the caller does, since the first frame
  bool wrong_pair = false;
  double left_to_go = 0;   ///< m
  bool is_broken = false;  ///< something was thrown half way

 private:
  void show_rest(palpable::Scene& scene) const;

  std::optional<palpable::FrameLoop> loop_;
  std::unique_ptr<palpable::CapsulePress> press_;
  std::vector<palpable::Capsule> in_body_;
  palpable::Scene pressed_;
};
