/// @file
/// What the user of a live run's window changes of the run while it goes on: where bodies stand,
/// what they are made of, a new beginning, a recording.
///
/// Each of them begins a new session, whose world is the camera of its first frame: tracking, map
/// and touches begin anew. A recording is of one session, so that a replay answers the same.
#pragma once

#include "apps/palpable/live_events.h"
#include "apps/palpable/live_play.h"
#include "apps/palpable/live_setup.h"
#include "palpable/live/events/event_lines.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/recorder.h"
#include "palpable/live/view/scene_painter.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {

/// One recording of a run: its file, and what goes into it.
class Recording {
 public:
  /// Begins the file; the run's frames go through it from now on.
  /// @throws Error where it cannot be written
  Recording(const std::filesystem::path& file, const LiveOptions& options, LiveSetUp& setup);
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// @return why the recording has ended early, once
  [[nodiscard]] std::optional<std::string> add(const Scene& scene);
  /// Ends the file. @return what live.json says of its states
  LiveSummary::States finish();
  /// Prints what became of it; after finish().
  void report() const;
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] bool is_finished() const { return finished_; }

 private:
  std::filesystem::path file_;
  EventLines lines_;
  Recorder recorder_;
  const Refiner* refiner_;  // the session's; null: nothing is refined
  RecorderCounts counts_;
  std::string trouble_;
  bool finished_ = false;
};

class LiveChanges {
 public:
  /// @param setup  outlives this
  LiveChanges(const LiveOptions& options, LiveSetUp& setup);

  /// Begins a recording before the run does.
  void begin_recording(const std::filesystem::path& file);
  /// For LivePlay::play(): adds states to the recording, and ends it.
  [[nodiscard]] StateWatch watch();
  /// What became of a recording that went on to the run's end.
  void report() const;

  /// Whether these runs can be changed: a refiner and answers between frames are of one session.
  [[nodiscard]] static bool possible(const LiveOptions& options, const PlayOptions& play);

  /// Does what needs a frame, once it is answered: then the scene is the new session's answer.
  /// @param painter  whose user wants it; told what became of it
  void apply(ScenePainter& painter, Scene& scene, LiveEvents& events);
  /// Begins or ends a recording where that is wanted, between two frames.
  void record(ScenePainter& painter, LiveLoop& loop, LiveEvents& events);

 private:
  // What is to become of the bodies, of which the session knows nothing yet.
  struct Plan {
    std::vector<Rigid3> world_from_body;             // the new world's
    std::vector<std::vector<std::string>> set;       // NAME=VALUE, of each body
    std::vector<std::optional<TouchableBody>> read;  // of those that are no longer what they were
  };
  [[nodiscard]] Plan plan_of(const LiveControls& controls, const Scene* held,
                             const Scene& scene) const;
  void plan_place(const LiveControls& controls, const Scene* held, const Scene& scene,
                  Plan& plan) const;
  void plan_values(const LiveControls& controls, Plan& plan) const;
  void plan_bodies(Plan& plan) const;
  void begin_session(std::vector<PlacedBody> bodies);
  void begin_recorded_session(const std::filesystem::path& file, LiveRun& run);
  [[nodiscard]] bool records() const { return recording_ && !recording_->is_finished(); }
  // For the panel: without its folder, so that a long one does not wrap.
  [[nodiscard]] std::string recording_name() const {
    return recording_->file().filename().string();
  }
  // @return what became of it, in a line for the panel
  std::string end_recording();

  LiveOptions options_;
  LiveSetUp& setup_;
  std::vector<std::vector<std::string>> set_at_first_;  // NAME=VALUE of each body
  std::optional<Recording> recording_;
  std::vector<Rigid3> camera_from_body_;  // of the frame answered last
  bool ended_with_run_ = false;           // the recording
};

}  // namespace palpable::app
