/// @file
/// Pictures that the user of a window asks to keep.
#pragma once

#include "palpable/common/geometry/image.h"

#include <filesystem>
#include <string>

namespace palpable::app {

/// Writes a picture into the present folder as STEM_WHAT_N.png, STEM being the body's file without
/// its ending and N the first number that is not taken. One that cannot be written is no reason to
/// close the window: that is printed.
/// @return what became of it: the file's name, or why there is none
[[nodiscard]] std::string keep_picture(const std::filesystem::path& body, const std::string& what,
                                       const ColorImage& picture);

}  // namespace palpable::app
