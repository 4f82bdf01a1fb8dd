#include "palpable/live/player/live_text.h"

#include <fmt/core.h>

namespace palpable {

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
  if (counts.first_touch) {
    text += fmt::format("touched in {} frames, first in frame {}, at most {:.1f} mm deep\n",
                        counts.touching, *counts.first_touch, counts.deepest * 1e3);
  } else {
    text += "never touched\n";
  }
  if (counts.between_bodies > 0) {
    text += fmt::format(
        "bodies pressed each other in {} frames, at most {:.2f} mm into each other; forces between "
        "them {:.3f} N out of balance at most\n",
        counts.between_bodies, counts.between * 1e3, counts.imbalance);
  }
  if (const Refiner* refiner = session.refiner()) {
    const RefinerCounts& counted = refiner->counts();
    text += fmt::format(
        "refined by {} of {} requested full-order solutions: {} came too late, {} were refused\n",
        counted.taken_up, counted.asked, counted.late, counted.refused);
  }
  return text;
}

}  // namespace palpable
