/// @file
/// The common part of `live` and `replay`: plays a run, shows it, sends its events and
/// writes its files.
#pragma once

#include "apps/palpable/live_events.h"
#include "apps/palpable/live_setup.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/live/player/live_run.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

struct PlayOptions {
  std::filesystem::path out;  ///< empty: no files
  std::string events = kNoEvents;
  std::string view = "camera";
  std::vector<std::string> views = {};  ///< several in one picture; empty: only `view`
  std::string paint = "stress";         ///< quantity that is painted on bodies
  bool opaque = false;                  ///< paint only, without the material below it
  std::string occlusion = "soft";       ///< how nearer real things hide bodies
  bool forces = false;                  ///< draw contact positions and forces
  bool window = false;
  bool paused = false;  ///< the window opens with the first frame paused
  bool pictures = false;
  std::vector<std::string> frame_pictures = {};  ///< numbers of frames, or "all"
  bool no_masks = false;
  bool no_depth = false;
  bool meshes = false;
  bool overwrite = false;
  bool every_frame = false;
  bool stats = false;
  double contact_rate = 0;  ///< Hz, ticks between frames; 0: none
  bool paced = false;       ///< a replay at the recorded pace, without skipping frames
};

/// Adds the options to a command.
void add_play_options(Command command, PlayOptions& options);

class LiveChanges;

/// Callbacks for the states of a run.
struct StateWatch {
  /// Called with each scene after it was processed, on the playing thread. @return a line for
  /// the user, if any
  std::function<std::optional<std::string>(const Scene&)> answered = {};
  /// Called after the last scene. @return the states for live.json; empty: none
  std::function<std::optional<LiveSummary::States>()> ended = {};
};

/// One run. The constructor acquires the output folder and the socket, before bodies are read.
class LivePlay {
 public:
  /// @param inputs        files and folders that the run reads; it removes none of them
  /// @param other_output  another file to which --overwrite applies; empty: there is none
  /// @throws Error when the options contradict each other, or the folder or socket is not available
  LivePlay(const PlayOptions& options, const std::vector<std::filesystem::path>& inputs,
           const std::filesystem::path& other_output = {});

  /// @throws Error when the options require something that these bodies do not have.
  /// play() calls it, too
  void check(const LiveSetUp& setup) const;

  /// Plays until the source or the user ends the run, and prints a summary.
  /// @param frames   largest number; negative: all
  /// @param scene    the scene's file; empty: one body
  /// @param changes  changes that the window's user may make; null: none
  /// @return whether the user ended it
  bool play(LiveSetUp& setup, int frames, const std::filesystem::path& scene,
            const StateWatch& watch = {}, LiveChanges* changes = nullptr);

 private:
  PlayOptions options_;
  std::optional<FolderLock> lock_;
  std::vector<std::filesystem::path> earlier_;
  LiveEvents events_;
};

}  // namespace palpable::app
