#include "palpable/live/capi/image_input.h"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace palpable {
namespace {

// Bytes of a pixel; 0 for an unknown format.
std::size_t bytes_of_pixel(int format) {
  switch (format) {
    case PALPABLE_GRAY8:
      return 1;
    case PALPABLE_RGB8:
    case PALPABLE_BGR8:
      return 3;
    case PALPABLE_RGBA8:
    case PALPABLE_DEPTH_F32:
      return 4;
    default:
      return 0;
  }
}

std::size_t bytes_of_row(const palpable_image& image) {
  return static_cast<std::size_t>(image.width) * bytes_of_pixel(image.format);
}

const std::uint8_t* row_of(const palpable_image& image, int y) {
  const std::size_t stride = image.stride > 0 ? image.stride : bytes_of_row(image);
  return static_cast<const std::uint8_t*>(image.pixels) + static_cast<std::size_t>(y) * stride;
}

Rgb color_at(const std::uint8_t* pixel, int format) {
  switch (format) {
    case PALPABLE_GRAY8:
      return {pixel[0], pixel[0], pixel[0]};
    case PALPABLE_BGR8:
      return {pixel[2], pixel[1], pixel[0]};
    default:
      return {pixel[0], pixel[1], pixel[2]};
  }
}

std::optional<std::string> trouble_of_stride(const palpable_image& image, const char* what) {
  const std::size_t row = bytes_of_row(image);
  const std::size_t stride = image.stride > 0 ? image.stride : row;
  const auto wrong = [&](std::string why) {
    return fmt::format("the {} has a stride of {} bytes from row to row; {}", what, stride, why);
  };
  if (stride > std::numeric_limits<std::size_t>::max() / 2) {
    return wrong(fmt::format("as a signed number that is {}: the top row is to come first",
                             static_cast<std::ptrdiff_t>(stride)));
  }
  if (stride < row) return wrong(fmt::format("a row of {} px takes {}", image.width, row));
  if (stride > kMostStride) return wrong(fmt::format("at most {} are possible", kMostStride));
  if (image.format == PALPABLE_DEPTH_F32 && stride % sizeof(float) != 0) {
    return wrong("floats take a multiple of 4");
  }
  const std::size_t all = static_cast<std::size_t>(image.height - 1) * stride + row;
  const auto first = reinterpret_cast<std::uintptr_t>(image.pixels);
  if (all > std::numeric_limits<std::uintptr_t>::max() - first) {
    return wrong(fmt::format("with it {} rows end beyond the memory that there is", image.height));
  }
  return std::nullopt;
}

// A triangle wave: from 0 to 255 and back to 0 as x grows by 1.
std::uint8_t rise_and_fall(float x) {
  const float within = x - std::floor(x);
  return static_cast<std::uint8_t>(255.0f * (1.0f - std::abs(2.0f * within - 1.0f)));
}

}  // namespace

std::optional<std::string> trouble_of(const palpable_image& image, const char* what, int width,
                                      int height, bool is_depth) {
  if (image.pixels == nullptr) return fmt::format("the {} has no pixels", what);
  if (image.width != width || image.height != height) {
    return fmt::format("the {} has {} x {} px; this session's have {} x {}", what, image.width,
                       image.height, width, height);
  }
  if (bytes_of_pixel(image.format) == 0 || (image.format == PALPABLE_DEPTH_F32) != is_depth) {
    return fmt::format("the {} has pixels of format {}, which is none of {}", what, image.format,
                       is_depth ? "depth" : "colour");
  }
  return trouble_of_stride(image, what);
}

std::optional<std::string> doubt_about_unit(const palpable_image& depth) {
  // m. Depth cameras measure less than kFarAway; a room has at most kFarthest in mm. Larger numbers
  // mark unknown pixels.
  constexpr float kFarAway = 100, kFarthest = 1e5F;
  std::size_t known = 0, far_away = 0;
  for (int y = 0; y < depth.height; ++y) {
    const std::uint8_t* bytes = row_of(depth, y);
    for (int x = 0; x < depth.width; ++x) {
      float Z = 0;  // rows need not be aligned
      std::memcpy(&Z, bytes + static_cast<std::size_t>(x) * sizeof Z, sizeof Z);
      known += std::isfinite(Z) && Z > 0;
      far_away += Z > kFarAway && Z < kFarthest;
    }
  }
  if (known == 0 || 2 * far_away <= known) return std::nullopt;
  return fmt::format(
      "the depth image: {} of {} depths are beyond {} m; PALPABLE_DEPTH_F32 is in metres: are "
      "these "
      "millimetres?",
      far_away, known, kFarAway);
}

void copy_color(const palpable_image& image, ColorImage& into) {
  static_assert(sizeof(Rgb) == 3);
  into.resize(image.width, image.height);
  const std::size_t step = bytes_of_pixel(image.format);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* pixel = row_of(image, y);
    Rgb* to = into.row(y);
    if (image.format == PALPABLE_RGB8) {
      std::memcpy(to, pixel, bytes_of_row(image));
      continue;
    }
    for (int x = 0; x < image.width; ++x, pixel += step) to[x] = color_at(pixel, image.format);
  }
}

void copy_depth(const palpable_image& image, DepthImage& into) {
  into.resize(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(into.row(y), row_of(image, y), bytes_of_row(image));  // rows need not be aligned
  }
}

void draw_depth(const DepthImage& depth, ColorImage& into) {
  constexpr float kPeriod = 0.2f, kFar = 20.0f;  // m
  into.resize(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float Z = depth.data()[i];
    const bool known = Z > 0 && Z < kFar;  // false for NaN
    into.data()[i] = known ? Rgb{rise_and_fall(Z / kPeriod), rise_and_fall(Z / kPeriod + 0.25f),
                                 static_cast<std::uint8_t>(255.0f / (1.0f + Z))}
                           : Rgb{};
  }
}

}  // namespace palpable
