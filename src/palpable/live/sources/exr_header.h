/// @file
/// What is wrong with an OpenEXR file of depths according to its header, before it is decoded.
#pragma once

#include <string>

namespace palpable {

/// Judges the bytes of a file and prepares them for OpenCV, which knows few names of channels: the
/// only channel is called Y afterwards. Accepted are scan lines of one channel of 16- or 32-bit
/// floats, as programs for phones export depth (m).
/// @return "is no OpenEXR file", "has 3 channels, where one of depths is wanted", ...; empty:
///         nothing is wrong so far
[[nodiscard]] std::string prepare_exr(std::string& bytes);

}  // namespace palpable
