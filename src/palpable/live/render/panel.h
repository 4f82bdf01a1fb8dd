/// @file
/// A panel of text, boxes and buttons that lies over a window's picture, by Dear ImGui. Window owns
/// it, hands it what the mouse does and draws it; who wants a panel says what is on it.
///
/// Dear ImGui asks for everything that is on a panel again and again: "laid out" below means that
/// the panel's function was called once. It is called after each event, so that a press and a
/// release that come together are a click, and before the panel is shown.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/live/render/window_events.h"

#include <functional>
#include <memory>

namespace palpable {

class Panel {
 public:
  /// Says what is on the panel, by functions of ImGui, and acts on what was clicked.
  using Layout = std::function<void()>;

  /// For the OpenGL context that is current. A problem when its shaders do not compile.
  [[nodiscard]] static Result<Panel> make(Layout layout);
  Panel(Panel&&) noexcept;
  Panel& operator=(Panel&&) noexcept;
  ~Panel();

  /// px of the window. Letters and all else grow with it: panel_letters().
  void resize(int width, int height);

  /// Tells it of an event. @return whether it is the panel's alone: the mouse is on it, or drags
  /// what began on it
  bool handle(const WindowEvent& event);
  void lay_out();

  /// Whether it looks different from what draw() drew last.
  [[nodiscard]] bool changed() const;
  /// Draws it into the window's framebuffer. What is the same as last time is not uploaded again.
  /// @param width, height  of the framebuffer, px
  void draw(int width, int height);

 private:
  struct State;
  explicit Panel(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Height of the panel's letters (px per em) in a window of that size: on a laptop and on a screen
/// of 2160 rows the panel covers the same share of the picture.
[[nodiscard]] int panel_letters(int window_width, int window_height);

}  // namespace palpable
