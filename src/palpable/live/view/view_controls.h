/// @file
/// The effects of mouse and keys in `palpable view`. Does not depend on a window or a clock: events
/// and times are passed in, so that a test can be the user.
#pragma once

#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/window_events.h"
#include "palpable/live/view/scene_show.h"
#include "palpable/live/view/show_names.h"

#include <array>
#include <functional>
#include <optional>
#include <string>

namespace palpable {

/// The left button on the body presses it there (or at the nearest site), deeper while it is held
/// or dragged, and lets it spring back when released. Any button beside the body turns the view,
/// the wheel zooms, keys switch. While several buttons are held, the first one counts.
class ViewControls {
 public:
  /// Returns the site at a pixel of the picture, or nothing beside the body. For a body that can be
  /// pressed anywhere it returns any number, and the caller remembers the position.
  using SiteAt = std::function<std::optional<int>(double x_px, double y_px)>;

  /// @param usual, paint  view and field at the start, and after R
  explicit ViewControls(const OrbitCamera& usual, const NamedPaint& paint = kPaints[0])
      : camera(usual),
        field(paint.field),
        component(paint.component),
        usual_(usual),
        usual_paint_(paint) {}

  /// @param time  s, not less than in earlier calls
  void handle(const WindowEvent& event, double time, const SiteAt& site_at);

  /// Returns to view and field of the start and ends the press, as the key R does.
  void reset();

  /// Presses a site at a constant level until another is pressed or R is hit.
  void keep(int site, double level);

  [[nodiscard]] int site() const { return site_; }
  /// The load level, 0..1, at a time (s).
  [[nodiscard]] double level(double time) const;
  /// Whether the level changes with time, without any event.
  [[nodiscard]] bool moving(double time) const;

  [[nodiscard]] static const std::array<std::string, 2>& help();

  OrbitCamera camera;
  SceneShow::Field field;
  SceneShow::Component component;
  bool panel_shown = true;
  bool sites_shown = false;
  bool legend_shown = true;
  bool help_shown = true;
  bool picture_wanted = false;  ///< P was hit; reset by the caller that fulfils it
  std::string note;             ///< a line for the user, until the next press of button or key
  bool quit = false;

 private:
  enum class Press { kNone, kHeld, kReleased, kKept };

  void press(const WindowEvent& event, double time, const SiteAt& site_at);
  void release(int button, double time);
  void key(int key);

  OrbitCamera usual_;
  NamedPaint usual_paint_;
  Press press_ = Press::kNone;
  int site_ = 0;
  double since_ = 0;    // s, start of the press or of springing back
  double from_ = 0;     // the kept level, or the level at release
  double drag_px_ = 0;  // distance from the start of the press
  double x_begin_ = 0, y_begin_ = 0;
  double x_before_ = 0, y_before_ = 0;
  std::optional<int> button_;  // the one that is held, whether it presses or turns
  bool turning_ = false;
};

}  // namespace palpable
