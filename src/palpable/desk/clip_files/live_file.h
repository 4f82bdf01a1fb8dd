/// @file
/// live.json of a result: what was run, which frames it looked at and what happened in all of them.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// What `palpable live` writes, in the order of the file.
struct LiveSummary {
  struct Tracking {
    int frames_moving = 0;
    std::vector<int> frames_lost;  ///< numbers
    int times_found_again = 0;
    int loops_closed = 0;
    int keyframes = 0;
    int landmarks = 0;
    /// Numbers of the frames with which a new world began (TrackedPose::new_world).
    std::vector<int> new_worlds = {};
  };
  struct Map {
    int blocks = 0;
    std::int64_t refused = 0;
    std::int64_t free_space_refused = 0;
  };
  /// How well depth could be measured (depth/depth_watch.h).
  struct Depth {
    double median_density = 0;           ///< share of the pixels with a depth
    std::vector<int> frames_few_depths;  ///< numbers: hardly any pixel had one
    std::vector<int> frames_rows_off;    ///< numbers: the eyes' rows were out of line
    double rows_off_px = 0;              ///< by how much at most
  };
  struct Troubles {
    int back_in_time = 0;
    int dropped = 0;
    int stalls = 0;
    int losses = 0;
    std::vector<std::string> reports;  ///< of the source, in its words
  };

  struct Body {
    std::string name;  ///< as the other files call it; of one body alone they do not
    std::string file;
    std::string contact;
    bool takes_reactions = false;  ///< of bodies that it presses; false: it presses them one way
    double scale = 1;
    Rigid3 camera_from_body = Rigid3::Identity();  ///< in the first frame
  };

  /// How fast it went (player/run_stats.h).
  struct Stats {
    double frames_per_second = 0;  ///< "frames_per_s"
    double age_p50_ms = 0;
    double age_p99_ms = 0;
    double cpu_ms_per_frame = 0;
    std::vector<std::pair<std::string, double>> stage_p50_ms;
    std::vector<std::pair<std::string, double>> stage_p99_ms;
  };

  /// All states that were answered, of a run that is recorded or replayed (player/state_hash.h).
  struct States {
    std::string hash;
    int frames = 0;
  };

  std::string scene;         ///< its file; empty: one body
  std::vector<Body> bodies;  ///< at least one
  std::string source;
  std::string view;
  bool press_static = false;  ///< what was there when bodies were anchored pressed them, too
  /// For paths that are published of the depth camera: trajectory.txt is the colour camera's.
  std::optional<Rigid3> color_from_depth;
  std::optional<Tracking> tracking;  ///< nothing: the camera was taken for fixed
  std::optional<Map> map;
  Depth depth;
  int unreadable = 0;  ///< frames
  Troubles source_troubles;
  int frames_touching = 0;
  std::optional<int> first_touch_frame;
  double deepest_press = 0;       ///< m; "deepest_press_m"
  int frames_between_bodies = 0;  ///< in which bodies pressed each other
  double deepest_between = 0;     ///< m, of bodies into each other; "deepest_between_m"
  double imbalance = 0;           ///< N, of the forces between them; "imbalance_n"
  /// Frames at whose end a body had some of its way still to go: contact had not converged, or an
  /// obstacle came farther than a body may move in one frame.
  int frames_step_limited = 0;
  int frames_contacts_dropped =
      0;  ///< in which more points were near something than there is room for
  int site_changes = 0;
  std::string video_codec;
  std::vector<std::string> pictures;
  int left_out = 0;        ///< frames that are in the texts only; "frames_left_out"
  int lines_left_out = 0;  ///< frames that are not even there; "lines_left_out"
  double color_scale = 0;  ///< Pa; "color_scale_pa"
  double wall = 0;         ///< s; "wall_s"
  std::optional<States> states;
  Stats stats;
  std::vector<std::pair<std::string, double>> median_ms;  ///< of each stage
  std::vector<int> processed;                             ///< numbers of the frames looked at
};

/// @throws Error when the file cannot be written
void write_live_summary(const std::filesystem::path& path, const LiveSummary& summary);

/// What scores need of live.json, which other systems may write too.
struct LiveFile {
  std::optional<std::vector<int>> processed;  ///< numbers of the frames looked at; nothing: all
  std::optional<Rigid3> camera_from_body;     ///< of a body that stays where it is
  std::optional<Rigid3> color_from_depth;     ///< trajectory.txt is the colour camera's
};

/// @throws Error naming the file when it is no JSON object, or when one of these makes no sense
[[nodiscard]] LiveFile read_live_file(const std::filesystem::path& path);

}  // namespace palpable
