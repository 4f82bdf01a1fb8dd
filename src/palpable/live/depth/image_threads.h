/// @file
/// How many threads OpenCV may use.
#pragma once

namespace palpable {

/// Of this whole process, from now on: of warping, converting and resizing pictures, whose results
/// do not depend on it. @param threads  >= 1
void use_image_threads(int threads);

}  // namespace palpable
