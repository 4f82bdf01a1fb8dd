/// @file
/// The images with which surfaces of the synthetic desk are painted. They are computed from a seed
/// and equal on every machine.
///
/// A value is 255 times the square root of the linear reflectance, which is close to sRGB and fast
/// to invert. All images can be repeated in both directions without a seam unless their comment
/// says otherwise.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Wooden boards along x, with year rings, pores and joints. 2048 px show 0.82 m of the desk.
[[nodiscard]] ColorImage wood_image(int size, std::uint64_t seed);
/// A painted wall with fine grain and hardly any contrast between larger areas.
[[nodiscard]] ColorImage plaster_image(int size, std::uint64_t seed);
/// A printed page. Has seams.
[[nodiscard]] ColorImage page_image(int width, int height, std::uint64_t seed);
/// A book, from left to right: cover (70 % of the width), spine (15 %), edges of the pages (15 %).
/// Has seams.
[[nodiscard]] ColorImage book_image(int size, Rgb color, std::uint64_t seed);
/// A printed cardboard box. Has seams.
[[nodiscard]] ColorImage carton_image(int size, Rgb color, std::uint64_t seed);
/// Glazed pottery with painted bands and dots; x runs round the mug.
[[nodiscard]] ColorImage glaze_image(int size, std::uint64_t seed);
/// Skin with weak blotches, fine lines and pores.
/// @param contrast  ratio to the contrast of a real hand
[[nodiscard]] ColorImage skin_image(int size, double contrast, std::uint64_t seed);
/// A floor of 4 x 4 speckled stone tiles with joints.
[[nodiscard]] ColorImage tile_image(int size, std::uint64_t seed);
/// The front of a cupboard: two doors with sunk panels and handles, worn paint. Has seams.
[[nodiscard]] ColorImage panel_image(int size, std::uint64_t seed);
/// The paint of a pencil: six faces, stripes round it and a printed name along it.
[[nodiscard]] ColorImage pencil_image(int size, std::uint64_t seed);
/// Woven cloth.
[[nodiscard]] ColorImage cloth_image(int size, std::uint64_t seed);

}  // namespace palpable
