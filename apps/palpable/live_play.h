/// @file
/// What `live` and `replay` share: a run that is set up is played, shown, told of and written.
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
  std::filesystem::path out;  ///< empty: nothing is written
  std::string events = kNoEvents;
  std::string view = "camera";
  std::vector<std::string> views = {};  ///< several in one picture; none: `view` alone
  std::string paint = "stress";         ///< on bodies
  bool opaque = false;                  ///< the paint alone, without the material below it
  std::string occlusion = "soft";       ///< of bodies by what is real and nearer
  bool forces = false;                  ///< where and how hard bodies are pressed is drawn
  bool window = false;
  bool paused = false;  ///< the window begins with the first frame held
  bool pictures = false;
  std::vector<std::string> frame_pictures = {};  ///< numbers of frames, or "all"
  bool no_masks = false;
  bool no_depth = false;
  bool meshes = false;
  bool overwrite = false;
  bool every_frame = false;
  bool stats = false;
  double contact_rate = 0;  ///< Hz, of answers between frames; 0: there are none
  bool paced = false;       ///< a replay that keeps time, though no frame is left out
};

/// Adds the options to a command.
void add_play_options(Command command, PlayOptions& options);

class LiveChanges;

/// Who looks at each state.
struct StateWatch {
  /// Gets each scene once it is answered, on the thread that plays. @return a line for the user, if
  /// there is something to say
  std::function<std::optional<std::string>(const Scene&)> answered = {};
  /// Called when the last one was answered. @return what live.json says of all states; nothing: it
  /// says nothing
  std::function<std::optional<LiveSummary::States>()> ended = {};
};

/// One run. Its folder and its socket are taken when it is made, before bodies are read.
class LivePlay {
 public:
  /// @param inputs        files and folders that the run reads; it removes none of them
  /// @param other_output  another file that --overwrite is about; empty: there is none
  /// @throws Error when the options make no sense, or the folder or socket cannot be had
  LivePlay(const PlayOptions& options, const std::vector<std::filesystem::path>& inputs,
           const std::filesystem::path& other_output = {});

  /// @throws Error when the options ask for what these bodies do not do. play() asks, too
  void check(const LiveSetUp& setup) const;

  /// Plays to the end, or to the user's, and prints what came of it.
  /// @param frames  at most so many; negative: all
  /// @param scene   the file of the scene; empty: one body
  /// @param changes  what the window's user may change of the run; null: nothing
  /// @return whether it was the user who ended it
  bool play(LiveSetUp& setup, int frames, const std::filesystem::path& scene,
            const StateWatch& watch = {}, LiveChanges* changes = nullptr);

 private:
  PlayOptions options_;
  std::optional<FolderLock> lock_;
  std::vector<std::filesystem::path> earlier_;
  LiveEvents events_;
};

}  // namespace palpable::app
