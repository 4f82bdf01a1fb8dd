/// @file
/// live.json of a result: what was run, which frames were processed, and totals over all of them.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/geometry/rigid.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// The values that `palpable live` writes, in the order of the file.
struct LiveSummary {
  struct Tracking {
    int frames_moving = 0;
    std::vector<int> frames_lost;  ///< frame numbers
    int times_found_again = 0;     ///< "relocalizations"
    int loops_closed = 0;
    int keyframes = 0;
    int landmarks = 0;
    /// Numbers of the frames at which a new world frame began (TrackedPose::new_world).
    std::vector<int> new_worlds = {};
  };
  struct Map {
    int blocks = 0;
    std::int64_t refused = 0;             ///< "blocks_refused"
    std::int64_t free_space_refused = 0;  ///< "free_space_blocks_refused"
  };
  /// How well depth could be measured (depth/depth_watch.h).
  struct Depth {
    double median_density = 0;  ///< share of the pixels with a depth
    /// Frame numbers; hardly any pixel had a depth; "frames_sparse_depth".
    std::vector<int> frames_few_depths;
    /// Frame numbers; rows of the two views misaligned; "frames_rows_misaligned".
    std::vector<int> frames_rows_off;
    double rows_off_px = 0;  ///< largest misalignment, px; "row_misalignment_px"
    /// Median shares of the pixels: those of which the sensor or the matcher measured a depth, and
    /// those in whose depth image one is left; "median_measured", "median_kept".
    double measured = 0, kept = 0;
    /// m, of all depths that were measured; 0: none. "median_m", and the two in "range_m", between
    /// which 90 % lie.
    double median = 0, low = 0, high = 0;
    double unit = 0;            ///< m, FrameFormat::depth_unit; 0 is null: "unit_m"
    bool unit_assumed = false;  ///< nothing stated it
    /// Median share of the pixels that have a depth in depth/, which ends at 16.4 m; nothing:
    /// depth/ was not written. "median_written".
    std::optional<double> written = std::nullopt;
  };
  struct Troubles {
    int back_in_time = 0;
    int dropped = 0;
    int stalls = 0;
    int losses = 0;
    std::vector<std::string> reports;  ///< messages of the source
  };

  struct Body {
    std::string name;  ///< name in the other files; unused if there is one body
    std::string file;
    std::string contact;
    /// Whether bodies that it presses press back on it; false: it acts on them in one direction
    /// only.
    bool takes_reactions = false;
    double scale = 1;
    double friction = 0;  ///< Coulomb's coefficient of its skin; the key is left out for 0
    Rigid3 camera_from_body = Rigid3::Identity();  ///< in the first frame
  };

  /// Speed of the run (player/run_stats.h).
  struct Stats {
    double frames_per_second = 0;  ///< "frames_per_s"
    double age_p50_ms = 0;
    double age_p99_ms = 0;
    double cpu_ms_per_frame = 0;
    std::vector<std::pair<std::string, double>> stage_p50_ms;
    std::vector<std::pair<std::string, double>> stage_p99_ms;
  };

  /// Hash over the results of all frames, for a run that is recorded or replayed
  /// (player/state_hash.h).
  struct States {
    std::string hash;
    int frames = 0;
  };

  std::string scene;         ///< scene file; empty: the run has one body without a scene file
  std::vector<Body> bodies;  ///< at least one
  std::string source;
  std::string view;
  /// Whether things that were already present when the bodies were anchored pressed them, too.
  bool press_static = false;
  /// Relates trajectory.txt, the path of the colour camera, to published paths of a depth camera.
  std::optional<Rigid3> color_from_depth;
  std::optional<Tracking> tracking;  ///< nothing: the camera was assumed fixed
  std::optional<Map> map;
  Depth depth;
  int unreadable = 0;  ///< number of frames that could not be read; "frames_unreadable"
  Troubles source_troubles;
  int frames_touching = 0;
  std::optional<int> first_touch_frame;
  double deepest_press = 0;       ///< m; "deepest_press_m"
  int frames_between_bodies = 0;  ///< in which bodies pressed each other; "frames_bodies_touching"
  double deepest_between = 0;     ///< m, penetration between bodies; "deepest_interpenetration_m"
  double imbalance = 0;           ///< N, of the forces between bodies; "force_imbalance_n"
  /// m, by how much the conditions of friction were not met, largest of all frames;
  /// "friction_residual_m", left out without friction.
  double friction_residual = 0;
  /// J, the largest energy of the bodies' motion around their static states; "ringing_j", left out
  /// where no body had inertia.
  double ringing = 0;
  /// Frames in which a body did not reach its equilibrium: contact had not converged, or an
  /// obstacle moved farther than the step limit of the body.
  int frames_step_limited = 0;
  /// Frames in which more contact points were near something than there is room for.
  int frames_contacts_dropped = 0;
  int site_changes = 0;
  std::string video_codec;
  std::vector<std::string> pictures;
  int left_out = 0;        ///< frames without pictures, only in the text files; "frames_left_out"
  int lines_left_out = 0;  ///< frames missing in the text files, too; "lines_left_out"
  double color_scale = 0;  ///< Pa; "color_scale_pa"
  double wall = 0;         ///< s; "wall_s"
  std::optional<States> states;
  Stats stats;
  std::vector<std::pair<std::string, double>> median_ms;  ///< for each stage
  std::vector<int> processed;                             ///< numbers of the processed frames
};

/// The content of live.json.
[[nodiscard]] Json json_of(const LiveSummary& summary);
/// @throws Error when the file cannot be written
void write_live_summary(const std::filesystem::path& path, const LiveSummary& summary);

/// How fast a run was, and how it moved, as far as its live.json states it.
struct RunSpeed {
  std::optional<double> frames_per_second;  ///< "stats.frames_per_s", else "frames" by "wall_s"
  std::optional<double> cpu_ms_per_frame;   ///< "stats.cpu_ms_per_frame"
  std::optional<double> age_p50_ms;         ///< "stats.age_p50_ms"
  std::optional<double> age_p99_ms;         ///< "stats.age_p99_ms"
  std::optional<int> dropped;               ///< "source_troubles.dropped"
  std::optional<double> ringing;            ///< J, "ringing_j": a body had inertia
};

/// The part of live.json that scores need. Other systems may write such files, too.
struct LiveFile {
  RunSpeed speed;
  std::optional<std::vector<int>> processed;  ///< numbers of the processed frames; nothing: all
  std::optional<Rigid3> camera_from_body;     ///< of a body that does not move
  std::optional<Rigid3> color_from_depth;     ///< as in LiveSummary
};

/// @throws Error naming the file when it is no JSON object or one of these values is invalid
[[nodiscard]] LiveFile read_live_file(const std::filesystem::path& path);

}  // namespace palpable
