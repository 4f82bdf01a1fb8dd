#include "palpable/live/view/live_controls.h"

#include "palpable/common/base/contract.h"

namespace palpable {
namespace {

constexpr std::array<LiveKey, 16> kKeys{
    {{"1 .. 5", "which view", 0, nullptr},
     {"F", "what is painted", 'F', [](auto& c) { c.next_field(); }},
     {"O", "occlusion", 'O', [](auto& c) { c.next_occlusion(); }},
     {"C", "contact points", 'C', [](auto& c) { c.show.contacts ^= true; }},
     {"N", "arrows of forces", 'N', [](auto& c) { c.show.forces ^= true; }},
     {"L", "legend", 'L', [](auto& c) { c.show.legend ^= true; }},
     {"B", "which body", 'B', [](auto& c) { c.next_body(); }},
     {"A", "place it by a click", 'A', [](auto& c) { c.begin_placing(); }},
     {"E", "begin anew", 'E', [](auto& c) { c.begin_anew(); }},
     {"V", "record, stop", 'V', [](auto& c) { c.wishes.recording = c.run_may_change; }},
     {"Space", "pause, go on", ' ', [](auto& c) { c.paused ^= true; }},
     {"S", "one frame on", 'S', [](auto& c) { c.step(); }},
     {"P", "keep the picture", 'P', [](auto& c) { c.picture_wanted = true; }},
     {"R", "view as at the start", 'R', [](auto& c) { c.reset(); }},
     {"T", "this panel", 'T', [](auto& c) { c.panel_shown ^= true; }},
     {"Esc, Q", "end", 0, nullptr}}};

}  // namespace

LiveControls::LiveControls(LiveView the_view, const SceneShow& the_show, int bodies)
    : view(the_view),
      show(the_show),
      first_view_(the_view),
      first_show_(the_show),
      bodies_(bodies) {
  PALPABLE_EXPECT(bodies > 0, "there is a body");
}

std::span<const LiveKey> LiveControls::keys() { return kKeys; }

void LiveControls::handle(const WindowEvent& event) {
  if (placing && event.kind == WindowEvent::Kind::kPress && event.button == 0 && shows_camera()) {
    placing = false;
    wishes.place = {event.x_px, event.y_px};
    return;
  }
  if (event.kind != WindowEvent::Kind::kKey) return;
  if (event.key >= '1' && event.key < '1' + static_cast<int>(kViewNames.size())) {
    view = static_cast<LiveView>(event.key - '1');
    return;
  }
  if (event.key == 'H') {
    // The help is on the panel, so the panel is shown as well.
    help_shown = !help_shown || !panel_shown;
    panel_shown |= help_shown;
  } else if (event.key == 'Q' || event.key == WindowEvent::kEscape) {
    ended = !placing || event.key == 'Q';
    placing = false;
  }
  for (const LiveKey& key : kKeys) {
    if (key.press != nullptr && key.code == event.key) key.press(*this);
  }
}

void LiveControls::next_field() { show.field = next_of(show.field, kFieldNames); }

void LiveControls::next_occlusion() { show.occlusion = next_of(show.occlusion, kOcclusionNames); }

void LiveControls::next_body() {
  ++body;
  if (body == bodies_ || bodies_ == 1) body = -1;
}

bool LiveControls::shows_camera() const {
  return view != LiveView::kSurface && view != LiveView::kMap;
}

void LiveControls::begin_placing() {
  placing = run_may_change && !placing;
  if (placing && !shows_camera()) view = LiveView::kCamera;  // else a click has no camera pixel
}

void LiveControls::begin_anew() { wishes.anew = run_may_change; }

void LiveControls::reset() {
  view = first_view_;
  show = first_show_;
  body = -1;
}

void LiveControls::step() {
  step_wanted = paused;
  paused = true;
}

}  // namespace palpable
