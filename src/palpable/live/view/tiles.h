/// @file
/// Several views of a scene side by side in one picture, each with its name (`live --views`).
#pragma once

#include "palpable/common/geometry/image.h"

#include <array>

namespace palpable {

/// What a tile shows: the views of live_controls.h, in their order, and two more.
enum class Tile {
  kCamera,
  kDepth,
  kMoving,
  kSurface,
  kMap,
  kMask,  ///< where the picture shows a body
  kTruth  ///< where it would with the true depth
};

inline constexpr std::array<const char*, 7> kTileNames{"camera", "depth", "moving", "surface",
                                                       "map",    "mask",  "truth"};

/// White where a body is seen, black elsewhere. @param picture  overwritten, of the mask's size
void draw_mask(const MaskImage& visible, ColorImage& picture);

/// White where a body is not behind what is truly there, black elsewhere; red where `visible`, the
/// mask that was found, says otherwise.
/// @param body_depth  m, NaN beside bodies, of the size of `visible`
/// @param true_depth  m, NaN where nothing is; of that size or half of it
/// @param picture     overwritten
void draw_true_mask(const MaskImage& visible, const DepthImage& body_depth,
                    const DepthImage& true_depth, ColorImage& picture);

/// Puts a picture at half its size into a sheet: up to three in a row, more in two rows.
/// @param number  of `count`, from 0 on; the first one clears the sheet
/// @param sheet   its sides are even, as films want them; keeps its memory
void put_tile(const ColorImage& picture, int number, int count, const char* name,
              ColorImage& sheet);

}  // namespace palpable
