#include "palpable/desk/clip_files/mask_image_file.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/opencv_writer.h"
#include "palpable/live/sources/image_file.h"

#include <algorithm>
#include <cstdint>

namespace palpable {
namespace {

cv::Mat mask_matrix(const GrayImage& image) {
  // The matrix is only read; cv::Mat has no const view, hence the cast.
  return {image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data())};
}

}  // namespace

void write_mask(const std::filesystem::path& path, const MaskImage& mask) {
  write_image(path, mask_matrix(mask), png_of_runs());
}

std::optional<MaskImage> read_mask(const std::filesystem::path& path) {
  std::optional<MaskImage> mask = read_labels(path);
  if (!mask) return std::nullopt;
  for (std::uint8_t& value : *mask) value = value > 127 ? 255 : 0;
  return mask;
}

void write_labels(const std::filesystem::path& path, const GrayImage& labels) {
  write_image(path, mask_matrix(labels), png_of_repetitions());
}

std::optional<GrayImage> read_labels(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  ImageFileReader reader;
  ColorImage colors;
  (void)value_or_throw(reader.read_color(path, colors));
  GrayImage gray(colors.width(), colors.height());
  std::transform(colors.begin(), colors.end(), gray.begin(), [](Rgb c) { return c.r; });
  return gray;
}

}  // namespace palpable
