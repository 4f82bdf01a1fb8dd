#include "palpable/live/player/live_counts.h"

#include <algorithm>
#include <cmath>

namespace palpable {

void LiveCounts::add(const Scene& scene) {
  processed.push_back(scene.number);
  if (scene.camera.state == TrackState::kLost) lost.push_back(scene.number);
  if (scene.camera.new_world) new_worlds.push_back(scene.number);
  if (scene.camera.state == TrackState::kTracking) ++moving;
  densities.push_back(static_cast<float>(scene.seen.density));
  if (scene.seen.trouble == DepthTrouble::kFewDepths) few_depths.push_back(scene.number);
  if (scene.seen.trouble == DepthTrouble::kRowsOff) {
    rows_off.push_back(scene.number);
    const double rows = std::abs(scene.seen.row_error_px);
    if (!std::isnan(rows)) rows_off_px = std::max(rows_off_px, rows);
  }
  left_to_move += scene.left_to_move > 0;
  dropped += scene.contacts_dropped > 0;
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

}  // namespace palpable
