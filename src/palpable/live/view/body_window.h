/// @file
/// A window in which a body is turned and pressed by mouse and keys (`palpable view`).
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
  int site = -1;                  ///< pressed at `level` until another is pressed; -1: none
  double level = 1;               ///< 0 .. 1 of the site's full load
  NamedPaint paint = kPaints[0];  ///< at the start, and after R
  ColorScale colors = ColorScale::kBlueYellow;
  double close_after = 0;  ///< s; 0: only when the user closes the window
};

/// Shows the body until the user closes the window. The controls are those of view_controls.h; a
/// panel switches the same. The mouse presses a body with tables of touch anywhere, as a finger
/// does (finger_press.h), and another body at its sites. Draws only when something changes; waits
/// for events otherwise.
/// @param keep_picture  called with the present picture when the user wants to keep it; returns a
///                      line about the result, which the window then shows
/// @throws Error when OpenGL reported errors
void show_body(Window& window, const std::shared_ptr<const TouchableBody>& body,
               const BodyWindowSettings& settings,
               const std::function<std::string(const ColorImage&)>& keep_picture);

}  // namespace palpable
