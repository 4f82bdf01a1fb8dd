/// @file
/// Counts of the events of a live run, and its summary in readable lines.
#pragma once

#include "palpable/live/depth/depth_survey.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"
#include "palpable/live/sources/source_guard.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct LiveCounts {
  std::vector<int> processed;   ///< numbers of the processed frames
  std::vector<int> lost;        ///< of these, frames in which the camera's pose was unknown
  std::vector<int> new_worlds;  ///< of these, frames that began a new world, which invalidates
                                ///< all earlier poses
  int moving = 0;               ///< frames in which the camera moved and was followed

  int touching = 0;                ///< frames in which a body was touched
  std::optional<int> first_touch;  ///< number of the first such frame
  int site_changes = 0;            ///< times that a touch was at another site than the previous one
  double deepest = 0;              ///< m, largest press depth of all touches
  int between_bodies = 0;          ///< frames in which bodies pressed each other
  double between = 0;    ///< m, largest penetration between bodies (Scene::mutual_penetration)
  double imbalance = 0;  ///< N, largest (Scene::imbalance)

  double friction_residual = 0;  ///< m, largest (Scene::friction_residual)
  double ringing = 0;            ///< J, largest (Scene::ringing)

  int left_to_move = 0;            ///< frames with Scene::left_to_move
  int later = 0, not_reached = 0;  ///< frames with these Scene::answer
  int dropped = 0;                 ///< frames with Scene::contacts_dropped

  DepthSurvey depth;                 ///< range of the depths, and what was kept of them
  std::vector<float> densities;      ///< of the processed frames (SeenFrame::density)
  std::vector<int> few_depths;       ///< frames with DepthTrouble::kFewDepths
  std::vector<int> rows_off;         ///< frames with DepthTrouble::kRowsOff
  double rows_off_px = 0;            ///< px, largest row error in those frames
  SourceTroubles troubles;           ///< of the source
  std::string last_trouble;          ///< reason why the last unusable frame was skipped
  std::vector<std::string> reports;  ///< of the source and the refiner, one line each

  /// Counts one processed frame.
  void add(const Scene& scene);
  /// Counts one frame in which no camera took part: only what contact has found.
  void add_contact(const Scene& scene);

 private:
  void count_touches(const Scene& scene);

  int last_site_ = -1;  // of the previous touch; -1: there was none
  int last_body_ = 0;   // body of the previous touch
};

/// A summary of a run: number of frames, rate, problems and touches.
/// @param session  that processed the frames
/// @param wall     s, wall-clock time of the run
[[nodiscard]] std::string text_of(const LiveCounts& counts, const Session& session, double wall);

/// The part of the summary that is about touches.
[[nodiscard]] std::string text_of_contact(const LiveCounts& counts);

}  // namespace palpable
