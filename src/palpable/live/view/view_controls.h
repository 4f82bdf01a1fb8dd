/// @file
/// What mouse and keys mean to `palpable view`. Knows no window and no clock: events and times come
/// in, so that a test can be the user.
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

/// Left button on the body presses it there (or its nearest site), deeper while it is held or
/// dragged, and lets it spring back when released. Any button beside the body turns, the wheel
/// zooms, keys switch. Of several buttons the first one counts until it is released.
class ViewControls {
 public:
  /// The site at a pixel of the picture, or nothing where the body is not. Of a body that is
  /// pressed anywhere any number; where it was pressed is then the caller's to remember.
  using SiteAt = std::function<std::optional<int>(double x_px, double y_px)>;

  /// @param usual, paint  with which to begin, and to return to with R
  explicit ViewControls(const OrbitCamera& usual, const NamedPaint& paint = kPaints[0])
      : camera(usual),
        field(paint.field),
        component(paint.component),
        usual_(usual),
        usual_paint_(paint) {}

  /// @param time  s, never before that of an earlier call
  void handle(const WindowEvent& event, double time, const SiteAt& site_at);

  /// Everything as at the start, as the key R.
  void reset();

  /// Holds a site at a level until another is pressed or R is hit.
  void keep(int site, double level);

  [[nodiscard]] int site() const { return site_; }
  /// 0..1 at a time (s).
  [[nodiscard]] double level(double time) const;
  /// Whether the level is still changing without any event.
  [[nodiscard]] bool moving(double time) const;

  [[nodiscard]] static const std::array<std::string, 2>& help();

  OrbitCamera camera;
  SceneShow::Field field;
  SceneShow::Component component;
  bool panel_shown = true;
  bool sites_shown = false;
  bool legend_shown = true;
  bool help_shown = true;
  bool picture_wanted = false;  ///< P was hit; the reader resets it
  std::string note;             ///< for the user to read, until the next press of button or key
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
  double since_ = 0;    // s: begin of holding, or of springing back
  double from_ = 0;     // level kept, or at release
  double drag_px_ = 0;  // from where the press began
  double x_begin_ = 0, y_begin_ = 0;
  double x_before_ = 0, y_before_ = 0;
  std::optional<int> button_;  // that is held, whether it presses or turns
  bool turning_ = false;
};

}  // namespace palpable
