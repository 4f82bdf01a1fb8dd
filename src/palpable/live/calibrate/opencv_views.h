/// @file
/// Our images as OpenCV matrices, without copying. Include it in .cpp files only: OpenCV's headers
/// take long to compile.
#pragma once

#include "palpable/common/geometry/image.h"

#include <opencv2/core.hpp>

#include <cstdint>

namespace palpable {

static_assert(sizeof(Rgb) == 3, "three bytes without padding, as CV_8UC3 has it");

inline cv::Mat view(ColorImage& image) {
  return {image.height(), image.width(), CV_8UC3, image.data()};
}
inline cv::Mat view(GrayImage& image) {
  return {image.height(), image.width(), CV_8UC1, image.data()};
}
inline cv::Mat view(DepthImage& image) {
  return {image.height(), image.width(), CV_32FC1, image.data()};
}
/// For reading only; OpenCV has no read-only matrix.
template <class T>
cv::Mat view(const Image<T>& image) {
  return view(const_cast<Image<T>&>(image));  // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

}  // namespace palpable
