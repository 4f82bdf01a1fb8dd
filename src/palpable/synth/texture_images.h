/// @file
/// Painted surfaces of the synthetic desk: procedural, the same for the same seed on every machine.
///
/// Values are square roots of linear reflectance times 255 (close to sRGB, and cheap to undo). All
/// tile in both directions unless they say otherwise.
#pragma once

#include "palpable/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Boards along x, with year rings, pores and joints; 1 px is 0.4 mm on the desk.
[[nodiscard]] ColorImage wood_image(int size, std::uint64_t seed);
/// A painted wall: fine grain, hardly any contrast at large scale.
[[nodiscard]] ColorImage plaster_image(int size, std::uint64_t seed);
/// A printed page (does not tile).
[[nodiscard]] ColorImage page_image(int width, int height, std::uint64_t seed);
/// A book: left 70 % cover, then 15 % spine, then 15 % edges of the pages (does not tile).
[[nodiscard]] ColorImage book_image(int size, Rgb color, std::uint64_t seed);
/// A printed cardboard box (does not tile).
[[nodiscard]] ColorImage carton_image(int size, Rgb color, std::uint64_t seed);
/// Glazed pottery with painted bands; x runs round the mug.
[[nodiscard]] ColorImage glaze_image(int size, std::uint64_t seed);
/// Skin: weak blotches and finer lines, `contrast` 1 is a real hand's.
[[nodiscard]] ColorImage skin_image(int size, double contrast, std::uint64_t seed);
/// A floor of stone tiles, 4 x 4 in the image, speckled, with joints.
[[nodiscard]] ColorImage tile_image(int size, std::uint64_t seed);
/// The front of a cupboard or a door: two panels with a frame, a handle, worn paint (does not
/// tile).
[[nodiscard]] ColorImage panel_image(int size, std::uint64_t seed);
/// The paint of a pencil: stripes round it and a printed name along it.
[[nodiscard]] ColorImage pencil_image(int size, std::uint64_t seed);
/// Woven cloth.
[[nodiscard]] ColorImage cloth_image(int size, std::uint64_t seed);

}  // namespace palpable
