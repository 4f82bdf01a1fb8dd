/// @file
/// The panel of a live run's window: how fast it runs, what touches the bodies, and everything that
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

  /// Takes over what is said of a scene that is about to be shown. Frame rate and times are means
  /// of half a second, so that they can be read.
  void add(const Scene& scene);

  /// Between ImGui's NewFrame and Render.
  void lay_out(LiveControls& controls);

  /// For the user to read: what became of a picture that was to be kept, or of another wish.
  std::string note;
  /// The file's name of the recording that goes on, without its folder; empty: none does.
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
  StageTimes sums_, means_;  // ms: of the present half second, of a frame of the last one
  int frames_ = 0;           // of the present half second
  double rate_ = 0;          // 1/s, of the last one
  Clock::time_point since_ = Clock::now();
};

}  // namespace palpable
