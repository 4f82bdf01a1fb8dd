/// @file
/// The output of a perfect depth camera for one frame: the true depth, and which pixels show a
/// thing that may press.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable {

struct TrueView {
  DepthImage depth;  ///< m
  MaskImage shows;   ///< kShowsPresser where labels/ have kMovesLabel, else kShowsRoom
};

/// Reads truth/depth and truth/labels; nothing if one of the two images is missing.
/// @param truth  folder of the truth
/// @param unit   m per count, TruthCamera::depth_unit
/// @throws Error naming the image that cannot be read
[[nodiscard]] std::optional<TrueView> read_true_view(const std::filesystem::path& truth, int frame,
                                                     double unit);

}  // namespace palpable
