/// @file
/// Middlebury's stereo pairs with their true disparities, as published.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <optional>

namespace palpable::app {

struct MiddleburyPair {
  GrayImage left;
  GrayImage right;
  DepthImage truth;  ///< disparity of the left image, px; NaN where unknown or hidden in the right
};

/// Reads a folder of the 2001/2003 layout (imL, imR, groundtruth, nonocc) or of the 2006 one
/// (view1, view5, disp1, disp5: what is hidden follows from both disparities). Nothing when a file
/// is not there or not readable.
[[nodiscard]] std::optional<MiddleburyPair> read_middlebury_pair(
    const std::filesystem::path& folder);

}  // namespace palpable::app
