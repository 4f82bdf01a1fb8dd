/// @file
/// The common part of `live` and `bench live`: the options of a live run and their translation to
/// the library's settings (palpable/live/player/live_run.h).
#pragma once

#include "apps/palpable/board_options.h"
#include "apps/palpable/source_options.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/player/live_run.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

/// Options of --contact paper.
struct PaperOptions {
  int step = 0;                    ///< px; 0: default
  std::optional<double> press_mm;  ///< empty: default
  std::optional<double> release_mm;
  std::string nodes;     ///< "sites", "all"; empty: "sites"
  std::string distance;  ///< "grid", "voxmap"; empty: "grid"

  /// @throws Error when an option does not apply to `contact`, or the distances are not in order
  void check(const std::string& contact) const;
};

struct LiveOptions {
  std::filesystem::path body;      ///< empty: given by `scene`
  std::filesystem::path scene;     ///< empty: only `body`
  SourceOptions input;             ///< its source may also be "synthetic"
  std::filesystem::path clip;      ///< folder to keep a synthetic clip in; empty: not kept
  bool paced = false;              ///< play a recording at its own pace, not at the loop's
  std::vector<std::string> place;  ///< words of --place; empty: from the folder's scene.toml
  /// "plane", "board": on the visible desk or chessboard; "pose" or empty: at `place`.
  std::string anchor;
  BoardOptions board;  ///< for "board"
  std::string at;      ///< "320,200": pixel on the plane; empty: a free position is found
  double scale = 1;
  std::vector<std::string> set;  ///< NAME=VALUE of further parameters
  bool press_static = false;
  bool fixed_camera = false;
  std::string contact;  ///< empty: depends on the body's tables
  PaperOptions paper;
  std::string matcher = "census";
  std::filesystem::path refine;  ///< the body's description; empty: no refinement
  int refine_latency = 6;        ///< frames from a request to its solution
  int threads = 0;               ///< 0: one for each processor
  int frames = -1;               ///< largest number; negative: all
};

/// Adds the options to a command; "body" is positional and may be omitted with --scene.
void add_live_options(Command command, LiveOptions& options);

/// Sets the number of threads of a software OpenGL. Must be called before anything is drawn.
/// @param threads  LiveOptions::threads
void share_drawing_threads(int threads);

/// The files and folders that the options name.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const LiveOptions& options);

/// A run, and the descriptions of its bodies in their order.
struct LiveSetUp {
  LiveRun run;
  std::vector<DescribedBody> bodies;
  LiveSettings settings = {};  ///< used to open the run
};

/// Reads one body from its file, without its scale.
/// @param contact  LiveOptions::contact. @throws Error
[[nodiscard]] TouchableBody read_live_body(const DescribedBody& wanted, const std::string& contact);

/// The settings from --contact and its options, --matcher, --fixed-camera and --press-static.
[[nodiscard]] SessionSettings session_settings(const LiveOptions& options);

/// Reads the bodies, renders the synthetic clip if it is required and missing, opens the images and
/// determines the poses. @throws Error for every failure
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options);
/// The same with images that are already open and that options.input names.
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options,
                                    std::unique_ptr<FrameSource> images);

}  // namespace palpable::app
