#include "palpable/live/view/view_controls.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kLeft = 0;
constexpr double kFullAfter = 1.2;      // s from the start of a press until the full load
constexpr double kFullDrag_px = 280.0;  // px of dragging until the full load
constexpr double kSpring = 28.0;        // rad/s, critically damped: springs back in 0.2 s
constexpr double kNothing = 1e-3;       // a level below this is not visible and counts as 0

}  // namespace

void ViewControls::handle(const WindowEvent& event, double time, const SiteAt& site_at) {
  switch (event.kind) {
    case WindowEvent::Kind::kPress:
      press(event, time, site_at);
      break;
    case WindowEvent::Kind::kRelease:
      release(event.button, time);
      break;
    case WindowEvent::Kind::kMove:
      if (turning_) camera.turn(event.x_px - x_before_, event.y_px - y_before_);
      if (press_ == Press::kHeld) {
        drag_px_ = std::hypot(event.x_px - x_begin_, event.y_px - y_begin_);
      }
      break;
    case WindowEvent::Kind::kWheel:
      camera.zoom(event.wheel, usual_.distance);
      break;
    case WindowEvent::Kind::kKey:
      key(event.key);
      break;
  }
  x_before_ = event.x_px;
  y_before_ = event.y_px;
}

void ViewControls::press(const WindowEvent& event, double time, const SiteAt& site_at) {
  note.clear();
  if (button_) return;
  button_ = event.button;
  const std::optional<int> site =
      event.button == kLeft ? site_at(event.x_px, event.y_px) : std::nullopt;
  if (!site) {
    turning_ = true;
    return;
  }
  site_ = *site;
  press_ = Press::kHeld;
  since_ = time;
  drag_px_ = 0;
  x_begin_ = event.x_px;
  y_begin_ = event.y_px;
}

void ViewControls::release(int button, double time) {
  if (button != button_) return;
  button_.reset();
  turning_ = false;
  if (press_ != Press::kHeld) return;
  from_ = level(time);
  since_ = time;
  press_ = Press::kReleased;
}

void ViewControls::key(int key) {
  note.clear();
  switch (key) {
    case 'S':
      sites_shown = !sites_shown;
      break;
    case 'L':
      legend_shown = !legend_shown;
      break;
    case 'H':
      help_shown = !help_shown;
      break;
    case 'P':
      picture_wanted = true;
      break;
    case 'F':
      field = next_of(field, kFieldNames);
      break;
    case 'T':
      panel_shown = !panel_shown;
      break;
    case 'R':
      reset();
      break;
    case 'Q':
    case WindowEvent::kEscape:
      quit = true;
      break;
    default:
      break;
  }
}

void ViewControls::reset() {
  camera = usual_;
  press_ = Press::kNone;
  field = usual_paint_.field;
  component = usual_paint_.component;
}

void ViewControls::keep(int site, double level) {
  site_ = site;
  from_ = level;
  press_ = Press::kKept;
}

double ViewControls::level(double time) const {
  const double t = time - since_;
  switch (press_) {
    case Press::kNone:
      return 0;
    case Press::kKept:
      return from_;
    case Press::kHeld:
      return std::min(t / kFullAfter + drag_px_ / kFullDrag_px, 1.0);
    case Press::kReleased: {
      const double level = from_ * (1.0 + kSpring * t) * std::exp(-kSpring * t);
      return level > kNothing ? level : 0.0;
    }
  }
  return 0;
}

bool ViewControls::moving(double time) const {
  return (press_ == Press::kHeld && level(time) < 1) ||
         (press_ == Press::kReleased && level(time) > 0);
}

const std::array<std::string, 2>& ViewControls::help() {
  static const std::array<std::string, 2> lines{
      "Click the body and hold or drag: press    Drag beside it: turn    Wheel: zoom",
      "F field    S sites    L legend    R reset    P picture    T panel    H hide this    Esc "
      "quit"};
  return lines;
}

}  // namespace palpable
