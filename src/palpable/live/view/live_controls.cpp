#include "palpable/live/view/live_controls.h"

#include "palpable/common/base/contract.h"

namespace palpable {
namespace {

constexpr std::array<KeyMeaning, 16> kKeys{{{"1 .. 5", "which view"},
                                            {"F", "what is painted"},
                                            {"O", "occlusion"},
                                            {"C", "contact points"},
                                            {"N", "arrows of forces"},
                                            {"L", "legend"},
                                            {"B", "which body"},
                                            {"A", "place it by a click"},
                                            {"E", "begin anew"},
                                            {"V", "record, stop"},
                                            {"Space", "pause, go on"},
                                            {"S", "one frame on"},
                                            {"P", "keep the picture"},
                                            {"R", "view as at the start"},
                                            {"T", "this panel"},
                                            {"Esc, Q", "end"}}};

}  // namespace

LiveControls::LiveControls(LiveView the_view, const SceneShow& the_show, int bodies)
    : view(the_view),
      show(the_show),
      first_view_(the_view),
      first_show_(the_show),
      bodies_(bodies) {
  PALPABLE_EXPECT(bodies > 0, "there is a body");
}

std::span<const KeyMeaning> LiveControls::keys() { return kKeys; }

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
  handle_key(event.key);
}

void LiveControls::handle_key(int key) {
  switch (key) {
    case 'F':
      next_field();
      break;
    case 'O':
      next_occlusion();
      break;
    case 'C':
      show.contacts = !show.contacts;
      break;
    case 'N':
      show.forces = !show.forces;
      break;
    case 'L':
      show.legend = !show.legend;
      break;
    case 'B':
      next_body();
      break;
    case ' ':
      paused = !paused;
      break;
    case 'S':
      step();
      break;
    case 'P':
      picture_wanted = true;
      break;
    case 'R':
      reset();
      break;
    case 'T':
      panel_shown = !panel_shown;
      break;
    case 'H':
      // The help is on the panel, so the panel is shown as well.
      help_shown = !help_shown || !panel_shown;
      panel_shown |= help_shown;
      break;
    case 'A':
      begin_placing();
      break;
    case 'E':
      begin_anew();
      break;
    case 'V':
      wishes.recording = run_may_change;
      break;
    case 'Q':
    case WindowEvent::kEscape:
      ended = !placing || key == 'Q';
      placing = false;
      break;
    default:
      break;
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
