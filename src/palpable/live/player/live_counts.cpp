#include "palpable/live/player/live_counts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {

void LiveCounts::add(const Scene& scene) {
  processed.push_back(scene.number);
  if (scene.camera.state == TrackState::kLost) lost.push_back(scene.number);
  if (scene.camera.new_world) new_worlds.push_back(scene.number);
  if (scene.camera.state == TrackState::kTracking) ++moving;
  depth.add(scene.seen);
  densities.push_back(static_cast<float>(scene.seen.density));
  if (scene.seen.trouble == DepthTrouble::kFewDepths) few_depths.push_back(scene.number);
  if (scene.seen.trouble == DepthTrouble::kRowsOff) {
    rows_off.push_back(scene.number);
    const double rows = std::abs(scene.seen.row_error_px);
    if (!std::isnan(rows)) rows_off_px = std::max(rows_off_px, rows);
  }
  count_touches(scene);
}

void LiveCounts::add_contact(const Scene& scene) {
  processed.push_back(scene.number);
  count_touches(scene);
}

void LiveCounts::count_touches(const Scene& scene) {
  left_to_move += scene.left_to_move > 0;
  dropped += scene.contacts_dropped > 0;
  friction_residual = std::max(friction_residual, scene.friction_residual);
  ringing = std::max(ringing, scene.ringing);
  later += scene.answer == Reached::kLater;
  not_reached += scene.answer == Reached::kNot;
  if (scene.touches.empty()) return;
  ++touching;
  if (!first_touch) first_touch = scene.number;
  const int site = scene.touches.front().site, body = scene.touches.front().body;
  if (last_site_ >= 0 && last_body_ == body && last_site_ != site) ++site_changes;
  last_site_ = site;
  last_body_ = body;
  for (const Touch& touch : scene.touches) deepest = std::max(deepest, touch.press_depth);
  between_bodies += std::any_of(scene.touches.begin(), scene.touches.end(),
                                [](const Touch& touch) { return touch.by >= 0; });
  between = std::max(between, scene.mutual_penetration);
  imbalance = std::max(imbalance, scene.imbalance);
}

std::string text_of(const LiveCounts& counts, const Session& session, double wall) {
  std::string text = fmt::format(
      "{} frames in {:.1f} s ({:.0f} ms each), {} unreadable\n", counts.processed.size(), wall,
      1e3 * wall / static_cast<double>(counts.processed.size()), counts.troubles.unreadable);
  if (counts.troubles.unreadable > 0) {
    text += fmt::format("last unreadable: {}\n", counts.last_trouble);
  }
  if (!counts.lost.empty()) {
    text += fmt::format("the camera was lost in {} frames, first in frame {}\n", counts.lost.size(),
                        counts.lost.front());
  }
  if (counts.depth.frames() > 0) text += text_of(counts.depth.figures());
  if (!counts.rows_off.empty()) {
    text += fmt::format(
        "the eyes' rows were up to {:.1f} px out of line in {} frames, first in frame {}: "
        "calibrate "
        "the camera again\n",
        counts.rows_off_px, counts.rows_off.size(), counts.rows_off.front());
  }
  if (!counts.few_depths.empty()) {
    text += fmt::format(
        "hardly any depth was found in {} frames, first in frame {}: dark, plain, blurred, or the "
        "calibration is another camera's\n",
        counts.few_depths.size(), counts.few_depths.front());
  }
  if (!counts.new_worlds.empty()) {
    text += fmt::format(
        "a new world began {}, first in frame {}: where bodies stood before is not known in it\n",
        counts.new_worlds.size() == 1 ? "once" : fmt::format("{} times", counts.new_worlds.size()),
        counts.new_worlds.front());
  }
  if (const SurfaceMap* room = session.slam().map();
      room != nullptr && (room->refused() > 0 || session.slam().space()->blocked() > 0)) {
    text += fmt::format(
        "the map was full ({} blocks): in ground seen later, moving things are found less well\n",
        room->blocks());
  }
  text += text_of_contact(counts);
  if (const Refiner* refiner = session.refiner()) {
    const RefinerCounts& counted = refiner->counts();
    text += fmt::format(
        "refined by {} of {} requested full-order solutions: {} came too late, {} were refused\n",
        counted.taken_up, counted.asked, counted.late, counted.refused);
  }
  return text;
}

std::string text_of_contact(const LiveCounts& counts) {
  std::string text;
  if (counts.first_touch) {
    text += fmt::format("touched in {} frames, first in frame {}, at most {:.1f} mm deep\n",
                        counts.touching, *counts.first_touch, counts.deepest * 1e3);
  } else {
    text += "never touched\n";
  }
  if (counts.later + counts.not_reached > 0) {
    text += fmt::format(
        "in {} frames the skin had not given way yet, in {} it could not: \"answer\" in "
        "touches.jsonl names them, and their forces are not to be used\n",
        counts.later, counts.not_reached);
  }
  if (counts.dropped > 0) {
    text += fmt::format(
        "in {} frames more contact points were near obstacles than are solved at a time: only the "
        "deepest ones pressed\n",
        counts.dropped);
  }
  if (counts.between_bodies > 0) {
    text += fmt::format(
        "bodies pressed each other in {} frames, at most {:.2f} mm into each other; forces between "
        "them {:.3f} N out of balance at most\n",
        counts.between_bodies, counts.between * 1e3, counts.imbalance);
  }
  return text;
}

}  // namespace palpable
