#include "palpable/live/sources/packed_image.h"

#include "palpable/common/base/error.h"
#include "palpable/live/sources/little_endian.h"

#include <fmt/core.h>

#include <bit>
#include <cstring>
#include <zstd.h>

namespace palpable {
namespace {

constexpr int kLevel = 1;  // of zstd: the fastest
constexpr std::size_t kColorBytes = 3;
constexpr std::size_t kDepthBytes = sizeof(float);

std::uint8_t byte_of(int value) { return static_cast<std::uint8_t>(value); }  // modulo 256

}  // namespace

struct ImagePacker::Coder {
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context{ZSTD_createCCtx(), ZSTD_freeCCtx};
};

ImagePacker::ImagePacker() : coder_(std::make_unique<Coder>()) {}
ImagePacker::ImagePacker(ImagePacker&&) noexcept = default;
ImagePacker& ImagePacker::operator=(ImagePacker&&) noexcept = default;
ImagePacker::~ImagePacker() = default;

void ImagePacker::pack(const ColorImage& image, std::string& bytes) {
  const std::size_t count = image.size();
  planes_.resize(kColorBytes * count);
  std::uint8_t* green = planes_.data();
  std::uint8_t* red = green + count;
  std::uint8_t* blue = red + count;
  no_colors_.assign(static_cast<std::size_t>(image.width()), Rgb{});
  for (int y = 0; y < image.height(); ++y) {
    const Rgb* row = image.row(y);
    const Rgb* above = y > 0 ? image.row(y - 1) : no_colors_.data();
    for (int x = 0; x < image.width(); ++x) {
      const int g = row[x].g - above[x].g;
      green[x] = byte_of(g);
      red[x] = byte_of(row[x].r - above[x].r - g);
      blue[x] = byte_of(row[x].b - above[x].b - g);
    }
    green += image.width();
    red += image.width();
    blue += image.width();
  }
  append_packed(bytes);
}

void ImagePacker::pack(const YuyvImage& image, std::string& bytes) {
  const std::size_t count = image.size();
  planes_.resize(sizeof(Yuyv) * count);
  no_pairs_.assign(static_cast<std::size_t>(image.width()), Yuyv{0, 0, 0, 0});
  std::uint8_t* plane = planes_.data();
  for (int y = 0; y < image.height(); ++y) {
    const Yuyv* row = image.row(y);
    const Yuyv* above = y > 0 ? image.row(y - 1) : no_pairs_.data();
    for (int x = 0; x < image.width(); ++x) {
      plane[x] = byte_of(row[x].y0 - above[x].y0);
      plane[count + static_cast<std::size_t>(x)] = byte_of(row[x].u - above[x].u);
      plane[2 * count + static_cast<std::size_t>(x)] = byte_of(row[x].y1 - above[x].y1);
      plane[3 * count + static_cast<std::size_t>(x)] = byte_of(row[x].v - above[x].v);
    }
    plane += image.width();
  }
  append_packed(bytes);
}

void ImagePacker::pack(const DepthImage& image, std::string& bytes) {
  const std::size_t count = image.size();
  planes_.resize(kDepthBytes * count);
  no_depths_.assign(static_cast<std::size_t>(image.width()), 0.0F);
  std::size_t at = 0;
  for (int y = 0; y < image.height(); ++y) {
    const float* row = image.row(y);
    const float* above = y > 0 ? image.row(y - 1) : no_depths_.data();
    for (int x = 0; x < image.width(); ++x, ++at) {
      const auto step =
          std::bit_cast<std::uint32_t>(row[x]) - std::bit_cast<std::uint32_t>(above[x]);
      for (std::size_t k = 0; k < kDepthBytes; ++k) {
        planes_[k * count + at] = static_cast<std::uint8_t>(step >> 8 * k);
      }
    }
  }
  append_packed(bytes);
}

void ImagePacker::append_packed(std::string& bytes) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + sizeof(std::uint64_t) + ZSTD_compressBound(planes_.size()));
  char* packed = bytes.data() + begin + sizeof(std::uint64_t);
  const std::size_t size =
      ZSTD_compressCCtx(coder_->context.get(), packed, bytes.data() + bytes.size() - packed,
                        planes_.data(), planes_.size(), kLevel);
  if (ZSTD_isError(size) != 0) {
    throw Error(fmt::format("an image cannot be packed: {}", ZSTD_getErrorName(size)));
  }
  const std::uint64_t stated = size;
  std::memcpy(bytes.data() + begin, &stated, sizeof stated);
  bytes.resize(begin + sizeof stated + size);
}

struct ImageUnpacker::Coder {
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context{ZSTD_createDCtx(), ZSTD_freeDCtx};
};

ImageUnpacker::ImageUnpacker() : coder_(std::make_unique<Coder>()) {}
ImageUnpacker::ImageUnpacker(ImageUnpacker&&) noexcept = default;
ImageUnpacker& ImageUnpacker::operator=(ImageUnpacker&&) noexcept = default;
ImageUnpacker::~ImageUnpacker() = default;

// Removes the next packed block from the front and unpacks it to `size` bytes.
bool ImageUnpacker::take_planes(std::string_view& bytes, std::size_t size) {
  const auto packed = take<std::uint64_t>(bytes);
  if (!packed || *packed > bytes.size()) return false;
  planes_.resize(size);
  const std::size_t unpacked =
      ZSTD_decompressDCtx(coder_->context.get(), planes_.data(), size, bytes.data(), *packed);
  bytes.remove_prefix(*packed);
  return unpacked == size;
}

bool ImageUnpacker::unpack(std::string_view& bytes, int width, int height, ColorImage& image) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!take_planes(bytes, kColorBytes * count)) return false;
  image.resize(width, height);
  const std::uint8_t* green = planes_.data();
  const std::uint8_t* red = green + count;
  const std::uint8_t* blue = red + count;
  no_colors_.assign(static_cast<std::size_t>(width), Rgb{});
  for (int y = 0; y < height; ++y) {
    Rgb* row = image.row(y);
    const Rgb* above = y > 0 ? image.row(y - 1) : no_colors_.data();
    for (int x = 0; x < width; ++x) {
      row[x] = {byte_of(above[x].r + green[x] + red[x]), byte_of(above[x].g + green[x]),
                byte_of(above[x].b + green[x] + blue[x])};
    }
    green += width;
    red += width;
    blue += width;
  }
  return true;
}

bool ImageUnpacker::unpack(std::string_view& bytes, int width, int height, YuyvImage& image) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!take_planes(bytes, sizeof(Yuyv) * count)) return false;
  image.resize(width, height);
  no_pairs_.assign(static_cast<std::size_t>(width), Yuyv{0, 0, 0, 0});
  const std::uint8_t* plane = planes_.data();
  for (int y = 0; y < height; ++y) {
    Yuyv* row = image.row(y);
    const Yuyv* above = y > 0 ? image.row(y - 1) : no_pairs_.data();
    for (int x = 0; x < width; ++x) {
      const auto step = [&](std::size_t k) {
        return plane[k * count + static_cast<std::size_t>(x)];
      };
      row[x] = {byte_of(above[x].y0 + step(0)), byte_of(above[x].u + step(1)),
                byte_of(above[x].y1 + step(2)), byte_of(above[x].v + step(3))};
    }
    plane += width;
  }
  return true;
}

bool ImageUnpacker::unpack(std::string_view& bytes, int width, int height, DepthImage& image) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!take_planes(bytes, kDepthBytes * count)) return false;
  image.resize(width, height);
  no_depths_.assign(static_cast<std::size_t>(width), 0.0F);
  std::size_t at = 0;
  for (int y = 0; y < height; ++y) {
    float* row = image.row(y);
    const float* above = y > 0 ? image.row(y - 1) : no_depths_.data();
    for (int x = 0; x < width; ++x, ++at) {
      std::uint32_t bits = std::bit_cast<std::uint32_t>(above[x]);
      for (std::size_t k = 0; k < kDepthBytes; ++k) {
        bits += std::uint32_t{planes_[k * count + at]} << 8 * k;
      }
      row[x] = std::bit_cast<float>(bits);
    }
  }
  return true;
}

}  // namespace palpable
