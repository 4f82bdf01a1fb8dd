/// @file
/// Plays a run: pulls its frames, draws them, sends its events, makes the changes that its user
/// wishes, and writes its files. Used by `palpable live` and `palpable replay`.
///
///     LivePlay play(options, inputs, user);      // output folder and socket
///     LiveSetUp setup = ...;                     // reads bodies, opens the source
///     const PlayResult result = play.play(setup);
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/image.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/live/events/live_events.h"
#include "palpable/live/live_page/live_page.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/play/live_set_up.h"
#include "palpable/live/play/run_output.h"
#include "palpable/live/player/state_hash.h"
#include "palpable/live/view/show_names.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// What is shown, sent and written of a run, in the words of the command line. Does not change
/// results.
struct PlayOptions {
  std::filesystem::path out;                   ///< empty: no files
  std::string events = kNoEvents;              ///< LiveEvents
  std::optional<LivePageSettings> serve = {};  ///< LivePage
  /// One of kViewNames (view/live_controls.h), or up to seven of kTileNames (view/tiles.h) side by
  /// side.
  std::vector<std::string> view = {"camera"};
  std::string paint = "stress";              ///< one of kPaints (view/show_names.h)
  std::string colors = kColorScaleNames[0];  ///< one of them (view/show_names.h)
  bool opaque = false;                       ///< paint only, without the material below it
  std::string occlusion = "soft";            ///< one of kOcclusionNames (view/show_names.h)
  bool forces = false;                       ///< draw contact positions and forces
  bool window = false;
  bool paused = false;  ///< the window opens with the first frame paused
  RunFiles files = {};
  std::vector<std::string> frame_pictures = {};  ///< numbers of frames, or "all"
  bool overwrite = false;
  bool every_frame = false;
  bool stats = false;
  double contact_rate = 0;  ///< Hz, ticks between frames; 0: none
  bool paced = false;       ///< a replay at the recorded pace, without skipping frames
};

/// Sets which pictures are written by themselves. @param words  PlayOptions::frame_pictures
/// @throws Error for a word that is neither the number of a frame nor "all"
void read_frame_pictures(const std::vector<std::string>& words, LiveOutputSettings& settings);

/// How a run speaks to its user, because the library prints nothing. All are called on the thread
/// that plays; `progress` may be empty, and so may `keep_picture` where there is no window.
struct PlayUser {
  std::function<void(const std::string& text)> print;  ///< results: lines with their line breaks
  std::function<void(const std::string& line)> say;    ///< a message between lines of progress
  Progress progress;
  std::function<void()> begin;         ///< the run begins: it can be ended in order from now on
  std::function<bool()> asked_to_end;  ///< whether the user wishes to end the run
  /// Writes a picture of the window to a file. @return a line about the result
  /// @param body  the file of the run's first body
  std::function<std::string(const std::filesystem::path& body, const ColorImage& picture)>
      keep_picture = {};
};

/// Receives the states of a run, on the thread that plays.
class StateWatch {
 public:
  virtual ~StateWatch() = default;
  /// Called with each scene after it was processed. @return a line for the user, if any
  virtual std::optional<std::string> add(const Scene& scene) = 0;
  /// Called after the last scene. @return the states for live.json; empty: none
  virtual std::optional<LiveSummary::States> end() = 0;
};

struct PlayResult {
  std::string text;         ///< a summary in readable lines
  Json summary;             ///< what live.json has
  bool user_ended = false;  ///< whether the user ended the run
  /// Why the recording of the run is not as it was written; empty: it is, or there is none.
  std::string lost = {};
};

class LiveChanges;

/// One run. The constructor acquires the output folder and the sockets, before bodies are read.
class LivePlay {
 public:
  /// @param inputs  files and folders that the run reads; it removes none of them
  /// @param record  the recording to be written (play()); empty: none
  /// @throws Error when the options contradict each other, or the folder, a socket or the
  /// recording's file is not available
  LivePlay(const PlayOptions& options, const std::vector<std::filesystem::path>& inputs,
           PlayUser user, const std::filesystem::path& record = {});

  /// Plays until the source or the user ends the run. In a window the user may change bodies, begin
  /// anew and record (live_changes.h), unless the run has a refiner or ticks between frames, which
  /// are bound to one session.
  /// @param frames  largest number; negative: all
  /// @throws Error when the options require something that these bodies do not have, or no frame
  /// can be read
  PlayResult play(LiveSetUp& setup, int frames = -1);

  /// Plays a recording and compares the states with the live run's. Frames after the last processed
  /// one are in the recording, too, but are not played.
  PlayResult replay(LiveSetUp& setup, StateComparison& comparison);

 private:
  void check(const LiveSetUp& setup) const;
  PlayResult run(LiveSetUp& setup, int frames, StateWatch& watch, LiveChanges* changes);

  std::filesystem::path record_;
  PlayOptions options_;
  PlayUser user_;
  RunFolder folder_;
  LiveEvents events_;
  LivePage page_;
};

}  // namespace palpable
