/// @file
/// Images packed without loss and fast: each byte as its difference to the row above, and red and
/// blue as theirs to green; plane by plane, through zstd at its quickest. docs/recording_file.md
/// has the layout, and what a 720p pair takes.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/yuyv.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Keeps its memory from image to image. One thread at a time.
class ImagePacker {
 public:
  ImagePacker();
  ImagePacker(ImagePacker&&) noexcept;
  ImagePacker& operator=(ImagePacker&&) noexcept;
  ~ImagePacker();

  /// Appends the packed image. @throws Error when there is no memory for it
  void pack(const ColorImage& image, std::string& bytes);
  void pack(const YuyvImage& image, std::string& bytes);
  /// Depth comes back bit by bit, whatever NaN it is.
  void pack(const DepthImage& image, std::string& bytes);

 private:
  void append_packed(std::string& bytes);

  struct Coder;
  std::unique_ptr<Coder> coder_;
  std::vector<std::uint8_t> planes_;
  std::vector<Rgb> no_colors_;  // the row above the first
  std::vector<Yuyv> no_pairs_;
  std::vector<float> no_depths_;
};

/// The other way round.
class ImageUnpacker {
 public:
  ImageUnpacker();
  ImageUnpacker(ImageUnpacker&&) noexcept;
  ImageUnpacker& operator=(ImageUnpacker&&) noexcept;
  ~ImageUnpacker();

  /// Takes one image off the front of `bytes`. Its size is known beforehand, and no memory is taken
  /// for what the bytes say of theirs.
  /// @return whether the bytes were such an image; otherwise what `image` holds is unspecified
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, ColorImage& image);
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, YuyvImage& image);
  [[nodiscard]] bool unpack(std::string_view& bytes, int width, int height, DepthImage& image);

 private:
  bool take_planes(std::string_view& bytes, std::size_t size);

  struct Coder;
  std::unique_ptr<Coder> coder_;
  std::vector<std::uint8_t> planes_;
  std::vector<Rgb> no_colors_;  // the row above the first
  std::vector<Yuyv> no_pairs_;
  std::vector<float> no_depths_;
};

}  // namespace palpable
