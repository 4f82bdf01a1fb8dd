/// @file
/// Pictures that the user saves from a window.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <string>

namespace palpable::app {

/// Writes a picture to the current folder as STEM_WHAT_N.png, where STEM is the body file's
/// name without extension and N the first unused number. A failure is printed, as it must not
/// close the window.
/// @return a line for the user: the file's name, or why there is none
[[nodiscard]] std::string keep_picture(const std::filesystem::path& body, const std::string& what,
                                       const ColorImage& picture);

}  // namespace palpable::app
