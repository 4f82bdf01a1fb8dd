/// @file
/// Pictures of a reduced body, drawn without a window: presses, and its modes.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/view/mode_shapes.h"
#include "palpable/live/view/show_names.h"
#include "palpable/live/view/studio_scene.h"

#include <functional>
#include <string>
#include <vector>

namespace palpable {

/// Draws a body at rest, its sites, presses at `site` and the sites from behind; then all of them
/// once more, half as large, as one sheet. Needs a current OpenGL context.
/// @param site   pressed at a third, two thirds and all of `level`; -1: three sites that show the
///               body best, at `level`
/// @param level  0 .. 1 of the site's full load
/// @param paint, colors  on the pressed body
/// @param show   called for each picture, with a name such as "3_press_site_4_level_100"
void draw_presses(const ReducedBody& body, int site, double level, const NamedPaint& paint,
                  ColorScale colors, PictureSize size,
                  const std::function<void(const std::string& name, const ColorImage&)>& show);

/// Draws modes side by side, and below each its function of the load position (paper Figs. 11 and
/// 13). Modes of displacement are enlarged so that they are visible. Needs a current OpenGL
/// context.
/// @param shapes  at least one: first_modes() of the body
/// @param size    of a picture twice as wide and high as each cell of the sheet
[[nodiscard]] ColorImage draw_modes(const ReducedBody& body, const std::vector<ModeShape>& shapes,
                                    PictureSize size);

}  // namespace palpable
