/// @file
/// Changes that the user of a live run's window makes during the run: the bodies' poses and
/// materials, a restart, a recording.
///
/// Each change begins a new session, whose world frame is the camera of its first frame:
/// tracking, map and touches start again. A recording contains one session, so that a replay has
/// the same results.
#pragma once

#include "palpable/live/events/event_lines.h"
#include "palpable/live/play/live_play.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/recorder.h"
#include "palpable/live/view/scene_painter.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// One recording of a run: its file and its content.
class RunRecording {
 public:
  /// Begins the file and wraps the run's source, so that its frames are recorded.
  /// @param opening  what becomes of a file that is there
  /// @throws Error when the file cannot be written
  RunRecording(const std::filesystem::path& file, LiveSetUp& setup, Opening opening);
  RunRecording(const RunRecording&) = delete;
  RunRecording& operator=(const RunRecording&) = delete;

  /// Adds the results of a frame. @return the reason when the recording has ended early, once
  [[nodiscard]] std::optional<std::string> add(const Scene& scene);
  /// Completes the file. @return the states for live.json
  LiveSummary::States finish();
  /// Why the recording ended early; empty if it did not, or if add() has returned the reason. To be
  /// called after finish().
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  /// A summary in readable lines, empty if lost() is not; to be called after finish().
  [[nodiscard]] std::string text() const;
  /// Why the file does not hold what was recorded, read back from it (player/recorder.h); empty: it
  /// does. To be called after finish().
  [[nodiscard]] const std::string& lost() const { return lost_; }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] bool is_finished() const { return finished_; }

 private:
  std::filesystem::path file_;
  EventLines lines_;
  Recorder recorder_;
  const Refiner* refiner_;  // the session's; null: no refinement
  RecorderCounts counts_;
  std::string trouble_;
  std::string lost_;
  bool finished_ = false;
};

class LiveChanges : public StateWatch {
 public:
  /// @param setup, user  must outlive this
  LiveChanges(LiveSetUp& setup, const PlayUser& user);

  /// Begins a recording, before the run begins.
  void begin_recording(const std::filesystem::path& file, Opening opening);
  /// Adds a state to the recording, if there is one.
  std::optional<std::string> add(const Scene& scene) override;
  std::optional<LiveSummary::States> end() override;
  /// A summary of a recording that lasted to the run's end; else empty.
  [[nodiscard]] std::string text() const { return ended_with_run_ ? recording_->text() : ""; }
  /// Why that recording's file does not hold what was recorded; empty: it does, or there was none.
  [[nodiscard]] std::string lost() const { return ended_with_run_ ? recording_->lost() : ""; }

  /// Applies the changes that need a frame; called after the frame was processed. The scene then
  /// has the results of the new session.
  /// @param painter  has the user's wishes and gets a note of the outcome
  /// @return whether a new session has begun
  bool apply(ScenePainter& painter, Scene& scene);
  /// Begins or ends a recording if the user wishes it; called between two frames.
  /// @return whether a new session has begun
  bool record(ScenePainter& painter, LiveLoop& loop);

 private:
  // The new state of the bodies, before the session is changed.
  struct Plan {
    std::vector<Rigid3> world_from_body;             // in the new world frame
    std::vector<std::vector<std::string>> set;       // NAME=VALUE, for each body
    std::vector<std::optional<TouchableBody>> read;  // bodies with new values, read again
  };
  [[nodiscard]] Plan plan_of(const LiveControls& controls, const Scene* held,
                             const Scene& scene) const;
  void plan_place(const LiveControls& controls, const Scene* held, const Scene& scene,
                  Plan& plan) const;
  void plan_bodies(Plan& plan) const;
  void begin_session(std::vector<PlacedBody> bodies);
  void begin_recorded_session(const std::filesystem::path& file, LiveRun& run);
  [[nodiscard]] bool records() const { return recording_ && !recording_->is_finished(); }
  // Without the folder, because a long name would wrap in the panel.
  [[nodiscard]] std::string recording_name() const {
    return recording_->file().filename().string();
  }
  // @return a line for the panel
  std::string end_recording();
  LiveSummary::States finish_recording();

  LiveSetUp& setup_;
  const PlayUser& user_;
  std::vector<std::vector<std::string>> set_at_first_;  // NAME=VALUE for each body
  std::optional<RunRecording> recording_;
  std::vector<Rigid3> camera_from_body_;  // of the last processed frame
  bool ended_with_run_ = false;           // the recording lasted to the run's end
};

}  // namespace palpable
