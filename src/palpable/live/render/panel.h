/// @file
/// A panel of text, boxes and buttons over a window's picture, by Dear ImGui. Window owns it,
/// passes the mouse's events to it and draws it; its content is a function by the user of Window.
///
/// With Dear ImGui the content is defined by calling this function repeatedly. "Laid out" below
/// means that it was called once. It is called after each event, so that a press and a release that
/// arrive together count as a click, and before the panel is shown.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/render/window_events.h"

#include <functional>
#include <memory>

namespace palpable {

class Panel {
 public:
  /// Calls functions of ImGui that define the panel's content, and acts on clicks.
  using Layout = std::function<void()>;

  /// Makes a panel for the current OpenGL context. A problem when its shaders do not compile.
  [[nodiscard]] static Result<Panel> make(Layout layout);
  Panel(Panel&&) noexcept;
  Panel& operator=(Panel&&) noexcept;
  ~Panel();

  /// Sets the window's size, px. The panel is scaled with it: panel_letters().
  void resize(int width, int height);

  /// Handles an event. @return whether the event concerns the panel only: the mouse is on the
  /// panel, or drags something from there
  bool handle(const WindowEvent& event);
  void lay_out();

  /// Whether the panel differs from the one that draw() drew last.
  [[nodiscard]] bool changed() const;
  /// Draws the panel into the window's framebuffer. An unchanged panel is not uploaded again.
  /// @param width, height  of the framebuffer, px
  void draw(int width, int height);

 private:
  struct State;
  explicit Panel(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Height of the panel's letters (px per em) in a window of that size. It grows with the window, so
/// that the panel covers the same share of the picture on a laptop and on a screen of 2160 rows.
[[nodiscard]] int panel_letters(int window_width, int window_height);

}  // namespace palpable
