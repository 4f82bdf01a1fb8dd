/// @file
/// A caller's images as those of the library.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/capi/palpable.h"

#include <optional>
#include <string>

namespace palpable {

/// Why an image cannot be taken in; nothing when it can.
/// @param image    as take_in() gave it
/// @param what     "left image", for the text
/// @param width    px, wanted; `height` too
/// @param is_depth it is to hold depths, else colours
[[nodiscard]] std::optional<std::string> trouble_of(const palpable_image& image, const char* what,
                                                    int width, int height, bool is_depth);

/// Keeps the memory of `into`. @pre trouble_of() has found none
void copy_color(const palpable_image& image, ColorImage& into);
void copy_depth(const palpable_image& image, DepthImage& into);

/// Colours for a camera that has none. A camera that stands takes what looks as the room ever did
/// for the room (map/static_picture.h), so that something nearer has to look otherwise: red and
/// green rise and fall with Z every 20 cm, a quarter of that apart, blue falls slowly. Unknown:
/// black.
void draw_depth(const DepthImage& depth, ColorImage& into);

}  // namespace palpable
