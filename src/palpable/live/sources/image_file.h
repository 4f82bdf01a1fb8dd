/// @file
/// Reads image files; damaged files are reported, never fatal.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace palpable {

/// Decodes one image after the other and reuses its buffers. Not thread-safe. Never throws: a file
/// that is missing, truncated, garbage, larger than 64 Mpx or not an image is a problem that names
/// it. That includes a truncated JPEG, which decoders silently complete with grey.
class ImageFileReader {
 public:
  ImageFileReader();
  ~ImageFileReader();
  ImageFileReader(const ImageFileReader&) = delete;
  ImageFileReader& operator=(const ImageFileReader&) = delete;

  /// Reads 8-bit colour; grey files become grey colours. Returns true, or the problem.
  [[nodiscard]] Result<bool> read_color(const std::filesystem::path& path, ColorImage& image);

  /// Reads 16-bit grey without conversion.
  [[nodiscard]] Result<bool> read_16bit(const std::filesystem::path& path,
                                        Image<std::uint16_t>& image);

  /// Reads 8-bit grey without conversion.
  [[nodiscard]] Result<bool> read_8bit(const std::filesystem::path& path, MaskImage& image);

  /// Reads depths in metres from an OpenEXR file (prepare_exr()); NaN where they are not positive
  /// and finite.
  [[nodiscard]] Result<bool> read_metres(const std::filesystem::path& path, DepthImage& image);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace palpable
