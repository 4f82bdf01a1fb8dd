/// @file
/// Reads one image file, whatever its bytes.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace palpable {

/// Decodes images one after the other and keeps its buffers between them. Not for two threads at
/// once. Nothing throws: a file that is missing, cut off, garbage, larger than 64 Mpx or not an
/// image is a problem that names it. So is a JPEG that is cut off, which decoders silently fill up
/// with gray.
class ImageFileReader {
 public:
  ImageFileReader();
  ~ImageFileReader();
  ImageFileReader(const ImageFileReader&) = delete;
  ImageFileReader& operator=(const ImageFileReader&) = delete;

  /// 8-bit colour; gray files become gray colours. The answer is ok or the problem.
  [[nodiscard]] Result<bool> read_color(const std::filesystem::path& path, ColorImage& image);

  /// 16-bit gray as it is in the file.
  [[nodiscard]] Result<bool> read_16bit(const std::filesystem::path& path,
                                        Image<std::uint16_t>& image);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace palpable
