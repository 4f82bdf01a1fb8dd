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
  DepthImage truth;  ///< px, left disparity; NaN where unknown or hidden in the right image
};

/// Reads a folder of the 2001/2003 layout (imL, imR, groundtruth, nonocc) or of the 2006 layout
/// (view1, view5, disp1, disp5: occlusion follows from the two disparities). Empty when a file is
/// missing or unreadable.
[[nodiscard]] std::optional<MiddleburyPair> read_middlebury_pair(
    const std::filesystem::path& folder);

}  // namespace palpable::app
