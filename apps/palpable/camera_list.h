/// @file
/// What palpable cameras says: what is plugged in, and what it can do.
#pragma once

#include "palpable/sources/video_system.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

/// Of each device sizes, formats and rates, whether its picture looks like two eyes side by side,
/// whether exposure and gain can be fixed, which calibration is known of it, and how it is used; of
/// a device that cannot be asked, why.
/// @param folders  where calibrations are kept
/// @param json     one object for programs, not lines for people
[[nodiscard]] std::string camera_list(VideoSystem& system,
                                      const std::vector<std::filesystem::path>& folders, bool json);

}  // namespace palpable::app
