/// @file
/// A window that shows pictures and returns events of mouse and keyboard as plain data.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/panel.h"
#include "palpable/live/render/window_events.h"

#include <memory>
#include <span>
#include <string>

namespace palpable {

/// A window with an OpenGL 4.5 core context. Move-only; use it on the main thread only.
class Window {
 public:
  /// Opens a window and makes its context current. The problem says why it cannot be opened, for
  /// instance because there is no display.
  [[nodiscard]] static Result<Window> open(const std::string& title, int width, int height);

  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  /// Puts a panel over the picture. It is laid out anew whenever a picture is shown and after each
  /// event, and is drawn in the window only, not into the pictures.
  /// @param layout  everything it refers to must outlive the window or the next set_panel(); empty:
  ///                no panel
  /// @throws Error when the panel's shaders do not compile
  void set_panel(Panel::Layout layout);

  /// Shows a picture as large as the window allows with its proportions kept. Waits for the
  /// screen's next refresh. events() paints the picture again when the window was resized or
  /// uncovered.
  void show(const ColorImage& picture);
  /// Returns the events since the last call; valid until the next call. If there are none, waits up
  /// to `wait` seconds for one. Keys are named by the user's keyboard layout; repeats of a key that
  /// is held, and keys together with Ctrl, Alt or Super, are left out. A window that loses the
  /// keyboard reports its buttons as released. Events of the mouse on the panel are handled by the
  /// panel and left out; their effect is visible with the next picture, or after the next call.
  [[nodiscard]] std::span<const WindowEvent> events(double wait = 0);
  /// True once the user has asked to close the window.
  [[nodiscard]] bool closed() const;

  /// Makes the window's context current on the calling thread, as open() does.
  void make_current();
  [[nodiscard]] const GlErrorLog& gl_errors() const;

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable
