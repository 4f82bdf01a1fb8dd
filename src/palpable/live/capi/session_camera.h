/// @file
/// The camera of a session, behind an interface: the core for web pages (web/) has no camera, and
/// links nothing of what one needs.
#pragma once

#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/things/scene_body.h"

#include <memory>
#include <span>
#include <vector>

namespace palpable {

class SessionCamera {
 public:
  virtual ~SessionCamera() = default;
  SessionCamera(const SessionCamera&) = delete;
  SessionCamera& operator=(const SessionCamera&) = delete;

  /// Discards all frames and puts the bodies to where they are.
  /// @throws Failure when the settings do not suit them
  virtual void restart(std::span<const palpable_body> bodies) = 0;
  /// Of the last frame.
  [[nodiscard]] virtual const std::vector<Touch>& touches() const = 0;
  [[nodiscard]] virtual std::vector<SceneBody>& shown() = 0;
  /// Moves the depth of the last frame out.
  [[nodiscard]] virtual DepthImage take_depth() = 0;
  /// Sets what only a session with a camera has: its state and pose, and whether images fit.
  virtual void describe(palpable_frame& frame) const = 0;

 protected:
  SessionCamera() = default;
};

/// @param setup  as taken_in() returned it, with a camera
/// @throws Failure when a number is out of its range or the calibration file is invalid; always
///         where the library was built without cameras
[[nodiscard]] std::unique_ptr<SessionCamera> camera_of(const palpable_setup& setup);

}  // namespace palpable
