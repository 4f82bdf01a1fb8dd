/// @file
/// Images as plain arrays.
#pragma once

#include "palpable/common/base/contract.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// Row-major, tightly packed, top row first. Pixel (0, 0) is the first; x runs right, y down.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T{}) : width_(width), height_(height) {
    PALPABLE_EXPECT(width >= 0 && height >= 0, "an image has no negative size");
    pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool empty() const { return pixels_.empty(); }
  [[nodiscard]] std::size_t size() const { return pixels_.size(); }

  [[nodiscard]] T* data() { return pixels_.data(); }
  [[nodiscard]] const T* data() const { return pixels_.data(); }
  [[nodiscard]] T* row(int y) { return data() + offset(0, y); }
  [[nodiscard]] const T* row(int y) const { return data() + offset(0, y); }
  [[nodiscard]] T& operator()(int x, int y) { return pixels_[offset(x, y)]; }
  [[nodiscard]] const T& operator()(int x, int y) const { return pixels_[offset(x, y)]; }

  /// Changes the size. Keeps the memory if it suffices, so that a frame loop may call it in each
  /// frame. Afterwards the content is unspecified unless the size has not changed.
  void resize(int width, int height) {
    PALPABLE_EXPECT(width >= 0 && height >= 0, "an image has no negative size");
    width_ = width;
    height_ = height;
    pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  [[nodiscard]] auto begin() { return pixels_.begin(); }
  [[nodiscard]] auto end() { return pixels_.end(); }
  [[nodiscard]] auto begin() const { return pixels_.begin(); }
  [[nodiscard]] auto end() const { return pixels_.end(); }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  [[nodiscard]] std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  int width_ = 0;
  int height_ = 0;
  std::vector<T> pixels_;
};

/// 8-bit sRGB.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

using ColorImage = Image<Rgb>;
using GrayImage = Image<std::uint8_t>;
using MaskImage = Image<std::uint8_t>;  ///< 0 or 255, or the values kShows... below
using DepthImage = Image<float>;        ///< Z in m; NaN where the depth is unknown

/// Bits of the label of a pixel in the truth of a film.
inline constexpr std::uint8_t kMovesLabel = 1;    ///< hand, sleeve, pencil or cup
inline constexpr std::uint8_t kBothSeeLabel = 2;  ///< the right eye sees the same point

/// Values of a mask that says which pixels of a frame show something that may press a body
/// (found by seen_object/pressing_mask.h).
inline constexpr std::uint8_t kShowsRoom = 0;  ///< the room: the space in front of it is free
/// The room, too, known from the colours beside the outline of a thing and not from depth alone
/// (seen_object/color_outline.h).
inline constexpr std::uint8_t kShowsRoomByColor = 1;
/// The room, too, beside an outline that was found in the picture, to a fraction of a pixel
/// (seen_object/outline_search.h).
inline constexpr std::uint8_t kShowsRoomByEdge = 2;
inline constexpr std::uint8_t kShowsUnknown = 128;  ///< neither the thing nor its depth is known
inline constexpr std::uint8_t kShowsPresser = 255;  ///< a thing that may press, with its depth
[[nodiscard]] constexpr bool shows_room(std::uint8_t shows) { return shows <= kShowsRoomByEdge; }

/// Two neighbouring pixels in the format in which many cameras send them, YUYV in memory: luma for
/// each pixel, colour for each two. BT.601: luma 16 .. 235; U, V about 128.
struct Yuyv {
  std::uint8_t y0 = 16;
  std::uint8_t u = 128;
  std::uint8_t y1 = 16;
  std::uint8_t v = 128;
  friend bool operator==(const Yuyv&, const Yuyv&) = default;
};
static_assert(sizeof(Yuyv) == 4, "as it lies in a camera's memory");

using YuyvImage = Image<Yuyv>;  ///< half as wide as the picture

/// Depth in the integer units of its file: Z = count * unit; the unit, in metres, goes with the
/// folder (docs/benchmark.md).
using DepthCounts = Image<std::uint16_t>;

inline constexpr std::uint16_t kNoDepth = 0;
/// In measured images: the pixel shows something that is too near to be measured. In images of a
/// truth this is an ordinary count.
inline constexpr std::uint16_t kTooClose = 65535;

}  // namespace palpable
