/// @file
/// The camera of a session as this library has it: the frame loop of the live program.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/capi/session_camera.h"
#include "palpable/live/capi/setup.h"
#include "palpable/live/session/frame_loop.h"
#include "palpable/live/session/scene.h"

#include <optional>
#include <span>
#include <vector>

namespace palpable {

class LoopCamera final : public SessionCamera {
 public:
  explicit LoopCamera(CameraSetup its_setup) : setup(std::move(its_setup)) {}

  void restart(std::span<const palpable_body> bodies) override;
  [[nodiscard]] const std::vector<Touch>& touches() const override { return scene().touches; }
  [[nodiscard]] std::vector<SceneBody>& shown() override { return loop_->scene.bodies; }
  [[nodiscard]] DepthImage take_depth() override;
  void describe(palpable_frame& frame) const override;

  /// Processes the frame in `images`.
  /// @param pose  null: the camera stands still or is followed. Else the pose of this frame, empty
  ///              where it is unknown
  void process_images(const std::optional<Rigid3>* pose);
  [[nodiscard]] const Scene& scene() const { return loop_->scene; }

  const CameraSetup setup;
  Frame images;              ///< the next frame, filled by the caller
  double first_time = 0;     ///< s, caller's clock
  bool gives_poses = false;  ///< the caller passes a pose with every frame

 private:
  std::optional<FrameLoop> loop_;  // since the first restart()
  bool has_frame_ = false;
  bool wrong_pair_ = false;
};

}  // namespace palpable
