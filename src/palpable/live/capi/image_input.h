/// @file
/// Conversion of a caller's images to the library's.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/capi/palpable.h"

#include <optional>
#include <string>

namespace palpable {

/// Why an image is not accepted; empty when it is.
/// @param image    as taken_in() returned it
/// @param what     name of the image in the text, e.g. "left image"
/// @param width    px, required; `height` too
/// @param is_depth whether depths are required, else colours
[[nodiscard]] std::optional<std::string> trouble_of(const palpable_image& image, const char* what,
                                                    int width, int height, bool is_depth);

/// Both reuse the memory of `into`. @pre trouble_of() found nothing
void copy_color(const palpable_image& image, ColorImage& into);
void copy_depth(const palpable_image& image, DepthImage& into);

/// Colours for a depth camera without a colour image. With a camera that stands still, a pixel
/// whose colour does not change belongs to the room (map/static_picture.h), so that another depth
/// must have another colour: red and green rise and fall with Z every 20 cm, a quarter of a period
/// apart, and blue falls slowly with Z. Unknown depth is black.
void draw_depth(const DepthImage& depth, ColorImage& into);

}  // namespace palpable
