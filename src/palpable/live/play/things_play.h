/// @file
/// Plays a run without a camera: what presses is given, line by line (session/things_line.h), by a
/// hands file or by a client of the run's events. Bodies, events and files are those of LivePlay as
/// far as they mean something here.
#pragma once

#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/play/live_play.h"
#include "palpable/live/session/session_body.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace palpable {

/// Where the lines come from.
enum class ThingsFrom {
  kFile,
  kClient  ///< of PlayOptions::events, which are needed (LiveEvents::next_things())
};

/// Bodies that stand in the world in which what presses is given, and where that comes from.
struct ThingsSetUp {
  std::vector<DescribedBody> bodies;  ///< their descriptions, in their order
  std::vector<PlacedBody> standing;   ///< moved from by ThingsPlay::play()
  std::filesystem::path source;       ///< a hands file; of kClient only its name in live.json
  std::filesystem::path scene = {};   ///< the scene's file; empty: one body
  /// Lines are played at their own pace, by their times, without skipping any; else as fast as they
  /// are solved.
  bool paced = false;
  bool dynamics = true;  ///< RunOptions::dynamics
};

/// One run. The constructor acquires the output folder and the sockets, before bodies are read.
class ThingsPlay {
 public:
  /// @param options  of files, RunFiles::data and meshes are written, and of a hands file the film;
  ///                 of what is shown, window, colors and opaque count (ThingsShow)
  /// @param inputs   files that the run reads; it removes none of them
  /// @throws Error when the folder or a socket is not available
  ThingsPlay(const PlayOptions& options, const std::vector<std::filesystem::path>& inputs,
             PlayUser user, ThingsFrom from = ThingsFrom::kFile);

  /// Plays until the end of the file, or until the user ends the run.
  /// @param frames  largest number; negative: all
  /// @return `lost` is the problem of a line that could not be read: the run ended before it, and
  /// its files are complete up to there
  /// @throws Error when a body has no tables of touch, when bodies overlap, or when no line can be
  /// read
  PlayResult play(ThingsSetUp& setup, int frames = -1);

 private:
  ThingsFrom from_;
  PlayOptions options_;
  PlayUser user_;
  RunFolder folder_;
  LiveEvents events_;
  LivePage page_;
};

}  // namespace palpable
