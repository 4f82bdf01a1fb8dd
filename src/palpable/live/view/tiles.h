/// @file
/// Several views of a scene side by side in one picture, each with its name (`live --view` with
/// several names).
#pragma once

#include "palpable/common/geometry/image.h"

#include <array>

namespace palpable {

/// The content of a tile: the views of live_controls.h, in their order, and two more.
enum class Tile {
  kCamera,
  kDepth,
  kMoving,
  kSurface,
  kMap,
  kMask,  ///< where the picture shows a body
  kTruth  ///< where it would show a body with the true depth
};

inline constexpr std::array<const char*, 7> kTileNames{"camera", "depth", "moving", "surface",
                                                       "map",    "mask",  "truth"};

/// Draws white where a body is visible, black elsewhere.
/// @param picture  overwritten, of the mask's size
void draw_mask(const MaskImage& visible, ColorImage& picture);

/// Draws white where a body is not behind a true surface, black elsewhere; red where `visible`, the
/// mask that was found, differs.
/// @param body_depth  m, NaN beside bodies, of the size of `visible`
/// @param true_depth  m, NaN where there is no surface; of that size or half of it
/// @param picture     overwritten
void draw_true_mask(const MaskImage& visible, const DepthImage& body_depth,
                    const DepthImage& true_depth, ColorImage& picture);

/// Puts a picture at half its size into a sheet with one row for up to three pictures, else two
/// rows.
/// @param number  of the picture, 0 .. count - 1; number 0 clears the sheet
/// @param sheet   its sides are even, as film formats require; keeps its memory
void put_tile(const ColorImage& picture, int number, int count, const char* name,
              ColorImage& sheet);

}  // namespace palpable
