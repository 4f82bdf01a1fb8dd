/// @file
/// What `live` and `bench live` share: the options of a live run, and what they mean to the library
/// (palpable/live/player/live_run.h).
#pragma once

#include "apps/palpable/board_options.h"
#include "apps/palpable/source_options.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_description.h"
#include "palpable/live/player/live_run.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

/// Of --contact paper.
struct PaperOptions {
  int step = 0;                    ///< px; 0: the usual one
  std::optional<double> press_mm;  ///< none: the usual ones
  std::optional<double> release_mm;
  std::string nodes;     ///< "sites", "all"; empty: the first
  std::string distance;  ///< "grid", "voxmap"; empty: the first

  /// @throws Error when something is asked for that `contact` does not know, or the distances are
  /// not in order
  void check(const std::string& contact) const;
};

struct LiveOptions {
  std::filesystem::path body;      ///< empty: `scene` says which
  std::filesystem::path scene;     ///< empty: `body` alone
  SourceOptions input;             ///< its source may also be "synthetic"
  std::filesystem::path clip;      ///< where a synthetic clip is kept; empty: nowhere
  bool paced = false;              ///< a recording at its own pace instead of the loop's
  std::vector<std::string> place;  ///< words; empty: from the folder's scene.toml
  /// "plane", "board": on the desk or chessboard that is seen; "pose", empty: where `place` says.
  std::string anchor;
  BoardOptions board;  ///< which one
  std::string at;      ///< "320,200": where on the plane; empty: it is looked for
  double scale = 1;
  std::vector<std::string> set;  ///< NAME=VALUE of further parameters
  bool press_static = false;
  bool fixed_camera = false;
  std::string contact;  ///< empty: what the body has tables for
  PaperOptions paper;
  std::string matcher = "census";
  std::filesystem::path refine;  ///< the body's description; empty: nothing is refined
  int refine_latency = 6;        ///< frames
  int threads = 0;               ///< 0: as many as the machine has
  int frames = -1;               ///< at most; negative: all
};

/// Adds the options to a command; "body" is positional, and may be left out for --scene.
void add_live_options(Command command, LiveOptions& options);

/// Lets software that draws use its share of the threads. To be called before anything is drawn.
/// @param threads  LiveOptions::threads
void share_drawing_threads(int threads);

/// The files and folders that the options name.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const LiveOptions& options);

/// A run, and what its bodies were read from, in their order.
struct LiveSetUp {
  LiveRun run;
  std::vector<DescribedBody> bodies;
  LiveSettings settings = {};  ///< with which it was opened
};

/// One of the run's bodies from its file, in its own size.
/// @param contact  LiveOptions::contact. @throws Error
[[nodiscard]] TouchableBody read_live_body(const DescribedBody& wanted, const std::string& contact);

/// What --contact and its options, --matcher, --fixed-camera and --press-static mean.
[[nodiscard]] SessionSettings session_settings(const LiveOptions& options);

/// Reads the bodies, films the synthetic clip if it is wanted and not there yet, opens the images,
/// finds the places. @throws Error for everything that is not as hoped
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options);
/// The same with images that are open already, which options.input names.
[[nodiscard]] LiveSetUp set_up_live(const LiveOptions& options,
                                    std::unique_ptr<FrameSource> images);

}  // namespace palpable::app
