/// @file
/// Fast lossless compression of images: each byte is stored as its difference to the row above, and
/// red and blue as their differences to green; plane by plane, with zstd at its fastest level.
/// docs/recording_file.md has the layout, and size and time of a 720p pair.
#pragma once

#include "palpable/common/geometry/image.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Reuses its memory from image to image. Not thread-safe.
class ImagePacker {
 public:
  ImagePacker();
  ImagePacker(ImagePacker&&) noexcept;
  ImagePacker& operator=(ImagePacker&&) noexcept;
  ~ImagePacker();

  /// Appends the packed image. @throws Error when there is not enough memory
  void pack(const ColorImage& image, std::string& bytes);
  void pack(const YuyvImage& image, std::string& bytes);
  /// Depth is restored bit by bit, the bits of NaN included.
  void pack(const DepthImage& image, std::string& bytes);

 private:
  void append_packed(std::string& bytes);

  struct Coder;
  std::unique_ptr<Coder> coder_;
  std::vector<std::uint8_t> planes_;
  std::vector<Rgb> no_colors_;  // zeros, used as the row above the first
  std::vector<Yuyv> no_pairs_;
  std::vector<float> no_depths_;
};

/// The inverse of ImagePacker.
class ImageUnpacker {
 public:
  ImageUnpacker();
  ImageUnpacker(ImageUnpacker&&) noexcept;
  ImageUnpacker& operator=(ImageUnpacker&&) noexcept;
  ~ImageUnpacker();

  /// Removes one image from the front of `bytes`. The expected size is an argument, so that no
  /// memory is allocated according to sizes in the data.
  /// @return whether the bytes were such an image; if not, the content of `image` is unspecified
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, ColorImage& image);
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, YuyvImage& image);
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, DepthImage& image);

 private:
  bool take_planes(std::string_view& bytes, std::size_t size);

  struct Coder;
  std::unique_ptr<Coder> coder_;
  std::vector<std::uint8_t> planes_;
  std::vector<Rgb> no_colors_;  // zeros, used as the row above the first
  std::vector<Yuyv> no_pairs_;
  std::vector<float> no_depths_;
};

}  // namespace palpable
