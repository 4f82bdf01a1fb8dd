/// @file
/// What happened in a live run, counted.
#pragma once

#include "palpable/live/session/scene.h"
#include "palpable/live/sources/source_guard.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct LiveCounts {
  std::vector<int> processed;   ///< numbers of the answered frames
  std::vector<int> lost;        ///< of these, frames in which it was not known where the camera is
  std::vector<int> new_worlds;  ///< of these, frames with which a new world began: what was placed
                                ///< before them may be anywhere
  int moving = 0;               ///< frames in which the camera moved and was followed

  int touching = 0;                ///< frames in which a body was touched
  std::optional<int> first_touch;  ///< number of the first of them
  int site_changes = 0;            ///< times that a body was touched at another site than before
  double deepest = 0;              ///< m, of all presses
  int between_bodies = 0;          ///< frames in which bodies pressed each other
  double between = 0;              ///< m, deepest of bodies into each other (Scene::between)
  double imbalance = 0;            ///< N, largest (Scene::imbalance)

  int left_to_move = 0;  ///< frames with Scene::left_to_move
  int dropped = 0;       ///< frames with Scene::contacts_dropped

  std::vector<float> densities;      ///< of the answered frames (SeenFrame::density)
  std::vector<int> few_depths;       ///< numbers of the frames with DepthTrouble::kFewDepths
  std::vector<int> rows_off;         ///< and with kRowsOff
  double rows_off_px = 0;            ///< the largest row error in the latter, px
  SourceTroubles troubles;           ///< of the source
  std::string last_trouble;          ///< why the last unusable frame could not be used
  std::vector<std::string> reports;  ///< of the source and the refiner, a line each

  /// Counts one answered frame.
  void add(const Scene& scene);

 private:
  int last_site_ = -1;  // of the touch before, -1: there was none
  int last_body_ = 0;   // and its body
};

}  // namespace palpable
