/// @file
/// A body in a window, turned and pressed by mouse and keys, as `palpable view` shows it.
#pragma once

#include "palpable/common/response/touchable_body.h"
#include "palpable/live/render/window.h"
#include "palpable/live/view/show_names.h"
#include "palpable/live/view/studio_scene.h"

#include <functional>
#include <memory>
#include <string>

namespace palpable {

struct BodyWindowSettings {
  PictureSize size{1280, 720};
  int site = -1;                  ///< held at `level` until another is pressed; -1: none is
  double level = 1;               ///< 0 .. 1 of the site's full load
  NamedPaint paint = kPaints[0];  ///< to begin with, and after R
  double close_after = 0;         ///< s; 0: when the user wants
};

/// Shows the body until the user closes the window (view_controls.h says what the user can do; a
/// panel switches the same). The mouse presses a body with tables of touch anywhere, as a finger
/// does (finger_press.h), and another one at its sites.
/// Draws only when something changes; waits for events otherwise.
/// @param keep_picture  called with the picture that is shown when the user asks to keep it;
/// returns
///                      what became of it, in a line that the window then shows
/// @throws Error when OpenGL reported errors
void show_body(Window& window, const std::shared_ptr<const TouchableBody>& body,
               const BodyWindowSettings& settings,
               const std::function<std::string(const ColorImage&)>& keep_picture);

}  // namespace palpable
