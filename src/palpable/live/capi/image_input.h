/// @file
/// Conversion of a caller's images to the library's.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/capi/palpable.h"

#include <cstddef>
#include <optional>
#include <string>

namespace palpable {

/// Bytes from row to row, at most: 16 times a row of 16384 pixels of 4 bytes, for views into large
/// pictures.
inline constexpr std::size_t kMostStride = std::size_t{1} << 20;

/// Why an image is not accepted; empty when it is.
/// @param image    as taken_in() returned it
/// @param what     name of the image in the text, e.g. "left image"
/// @param width    px, required; `height` too
/// @param is_depth whether depths are required, else colours
///
/// A stride is refused unless every row lies behind the one before and within memory: smaller than
/// a row, larger than kMostStride (a negative stride, as of pictures whose bottom row comes first,
/// is near 2^64), not a multiple of 4 for depths, or so large that the image would not end in the
/// address space.
[[nodiscard]] std::optional<std::string> trouble_of(const palpable_image& image, const char* what,
                                                    int width, int height, bool is_depth);

/// What speaks against a depth image in metres, in one line: most of its depths are beyond 100 m.
/// @param depth  after trouble_of()
[[nodiscard]] std::optional<std::string> doubt_about_unit(const palpable_image& depth);

/// Both reuse the memory of `into`. @pre trouble_of() found nothing
void copy_color(const palpable_image& image, ColorImage& into);
void copy_depth(const palpable_image& image, DepthImage& into);

/// Colours for a depth camera without a colour image. With a camera that stands still, a pixel
/// whose colour does not change belongs to the room (map/static_picture.h), so that another depth
/// must have another colour: red and green rise and fall with Z every 20 cm, a quarter of a period
/// apart, and blue falls slowly with Z. Unknown depth is black.
void draw_depth(const DepthImage& depth, ColorImage& into);

}  // namespace palpable
