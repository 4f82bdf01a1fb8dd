/// @file
/// The panel of a live run's window: its frame rate, the touches of the bodies, and everything that
/// live_controls.h switches.
#pragma once

#include "palpable/common/base/stage_clock.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"
#include "palpable/live/view/live_controls.h"

#include <chrono>
#include <string>
#include <vector>

namespace palpable {

/// Adding a scene and laying out allocate nothing once as many touches have been seen.
class LivePanel {
 public:
  /// @param names  of the bodies
  explicit LivePanel(std::vector<std::string> names) : names_(std::move(names)) {}

  /// Takes over touches and times of a scene that is about to be shown. Frame rate and times are
  /// means over half a second, so that they can be read.
  void add(const Scene& scene);

  /// Lays out the panel; to be called between ImGui's NewFrame and Render.
  void lay_out(LiveControls& controls);

  /// A line for the user, such as the result of keeping a picture or of another wish.
  std::string note;
  /// The file name of the present recording, without its folder; empty: there is none.
  std::string recording;

 private:
  using Clock = std::chrono::steady_clock;
  void lay_out_rate();
  void lay_out_buttons(LiveControls& controls) const;
  void lay_out_run(LiveControls& controls) const;
  void lay_out_parameters(LiveControls& controls) const;
  void lay_out_look(LiveControls& controls) const;
  void lay_out_touches(LiveControls& controls) const;

  std::vector<std::string> names_;
  std::vector<Touch> touches_;
  StageTimes sums_, means_;  // ms: sums over the present half second, means over the last one
  int frames_ = 0;           // in the present half second
  double rate_ = 0;          // frames per s in the last half second
  Clock::time_point since_ = Clock::now();
};

}  // namespace palpable
