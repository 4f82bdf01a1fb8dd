/// @file
/// The number of threads that OpenCV may use.
#pragma once

namespace palpable {

/// Sets the number of threads with which OpenCV warps, converts and resizes pictures, for the whole
/// process. The results do not depend on it.
/// @param threads  >= 1
void use_image_threads(int threads);

}  // namespace palpable
