/// @file
/// The options of `live`. A new one is declared in live_options.cpp, and its value is a member of
///
///   RunOptions     (live/play/run_options.h)  if results depend on it: recordings keep it
///   PlayOptions    (live/play/live_play.h)    of what is shown, sent, written; also of `replay`
///   SourceOptions  (shared_options.h)         of the source of images; other commands share it
///   LiveOptions    (below)                    else: where bodies stand, threads, number of frames
///
/// live_settings.cpp turns them into the settings of the library. tests/cli/programs.py runs them.
#pragma once

#include "apps/palpable/shared_options.h"
#include "palpable/live/play/live_play.h"
#include "palpable/live/play/run_options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

/// The source that is rendered here.
inline constexpr const char* kSynthetic = "synthetic";

/// The source whose lines come from clients of --events.
inline constexpr const char* kSocketSource = "socket";

struct LiveOptions {
  std::filesystem::path body;   ///< empty: given by `scene`
  std::filesystem::path scene;  ///< empty: only `body`
  SourceOptions input{.source = kSynthetic};
  std::filesystem::path clip;      ///< folder of a synthetic clip; empty: in clip_cache()
  int clip_frames = 300;           ///< of a synthetic clip
  bool paced = false;              ///< play a recording at its own pace, not at the loop's
  std::vector<std::string> place;  ///< words of --place; empty: from the folder's scene.toml
  std::string anchor;              ///< "plane", "board": on the visible desk or chessboard
  BoardOptions board;              ///< for "board"
  std::string at;  ///< "320,200": pixel on the plane; empty: a free position is found
  double scale = 1;
  std::vector<std::string> set;  ///< NAME=VALUE of further parameters
  RunOptions run;                ///< `depth` and `farthest` are in `input`
  int refine_latency = 6;        ///< frames from a request to its solution
  int threads = 0;               ///< 0: one for each core
  int frames = -1;               ///< largest number; negative: all
};

/// Adds the options to a command; "body" is positional.
void add_live_options(Command command, LiveOptions& options);

/// Adds the options to a command.
void add_play_options(const Command& command, PlayOptions& options);

}  // namespace palpable::app
