#include "palpable/live/sources/image_header.h"

#include "palpable/live/sources/jpeg_size.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace palpable {
namespace {

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegStart = "\xff\xd8";
constexpr std::string_view kLittleTiff("II*\0", 4);
constexpr std::string_view kBigTiff("MM\0*", 4);

// What a header announces. `fewest_bytes`: the pixels take at least as many bytes of the file.
struct Announced {
  std::uint64_t width = 0, height = 0, fewest_bytes = 0;
};

bool is_netpbm(std::string_view bytes) {  // PBM, PGM, PPM
  return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6';
}

// Whether the first bytes are those of a format listed in folder_source.h. OpenCV supports many
// more and passes unknown files to GDAL, which would try about a hundred formats on a broken file.
bool is_known_format(std::string_view bytes) {
  for (const std::string_view start :
       {kPng, kJpegStart, std::string_view("BM"), kLittleTiff, kBigTiff}) {
    if (bytes.starts_with(start)) return true;
  }
  return is_netpbm(bytes);
}

// The end mark is searched in the last kilobyte, because some writers append padding.
bool ends_with_mark(std::string_view bytes, std::string_view mark) {
  constexpr std::size_t kTail = 1024;
  const std::string_view tail = bytes.substr(bytes.size() - std::min(kTail, bytes.size()));
  return tail.find(mark) != std::string_view::npos;
}

enum class FirstByte { kLow, kHigh };

// The number in `count` bytes from `at` on; 0 behind the end.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t count,
                        FirstByte first) {
  std::uint64_t value = 0;
  if (at > bytes.size() || bytes.size() - at < count) return 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = first == FirstByte::kHigh ? i : count - 1 - i;
    value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  }
  return value;
}

// BITMAPFILEHEADER (14 bytes) and BITMAPCOREHEADER (12) or a longer one behind it.
Announced bmp_header(std::string_view bytes) {
  const auto number = [&](std::size_t at, std::size_t count) {
    return number_at(bytes, at, count, FirstByte::kLow);
  };
  constexpr std::uint64_t kCore = 12;
  if (number(14, 4) == kCore) return {number(18, 2), number(20, 2), 0};
  // A negative height: the top row comes first.
  const auto height = static_cast<std::int32_t>(number(22, 4));
  Announced size{number(18, 4),
                 static_cast<std::uint64_t>(std::abs(static_cast<std::int64_t>(height))), 0};
  constexpr std::uint64_t kPlain = 0, kBitFields = 3;  // others: run lengths, JPEG, PNG
  const bool plain = number(30, 4) == kPlain || number(30, 4) == kBitFields;
  if (plain) size.fewest_bytes = size.width * size.height / 8 * number(28, 2);
  return size;
}

// The numbers of the text after "P5": width, height and, except for PBM, the largest value.
std::optional<Announced> netpbm_header(std::string_view bytes) {
  std::uint64_t numbers[2] = {};
  std::size_t at = 2;
  for (std::uint64_t& number : numbers) {
    while (at < bytes.size() && (bytes[at] == '#' || bytes[at] <= ' ')) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    const std::size_t end = std::min(bytes.find_first_not_of("0123456789", at), bytes.size());
    constexpr std::size_t kMostDigits = 9;
    if (end == at || end - at > kMostDigits) return std::nullopt;
    for (; at < end; ++at) number = 10 * number + static_cast<std::uint64_t>(bytes[at] - '0');
  }
  const std::uint64_t pixels = numbers[0] * numbers[1];
  const std::uint64_t channels = bytes[1] == '3' || bytes[1] == '6' ? 3 : 1;
  const bool bits = bytes[1] == '1' || bytes[1] == '4';
  return Announced{numbers[0], numbers[1], bits ? pixels / 8 : pixels * channels};
}

// The first directory of a TIFF, which may lie anywhere; empty if it is not within the bytes.
std::optional<Announced> tiff_header(std::string_view bytes) {
  const FirstByte order = bytes.starts_with(kBigTiff) ? FirstByte::kHigh : FirstByte::kLow;
  const auto number = [&](std::size_t at, std::size_t count) {
    return number_at(bytes, at, count, order);
  };
  constexpr std::size_t kEntry = 12;  // tag (2), type (2), count (4), value (4)
  const std::size_t directory = number(4, 4);
  const std::size_t entries = number(directory, 2);
  if (directory + 2 + entries * kEntry > bytes.size()) return std::nullopt;
  Announced size;
  for (std::size_t e = 0; e < entries; ++e) {
    const std::size_t at = directory + 2 + e * kEntry;
    constexpr std::uint64_t kShort = 3, kWidth = 256, kHeight = 257;
    const std::uint64_t value = number(at + 8, number(at + 2, 2) == kShort ? 2 : 4);
    if (number(at, 2) == kWidth) size.width = value;
    if (number(at, 2) == kHeight) size.height = value;
  }
  return size;
}

}  // namespace

std::string why_no_image(std::string_view bytes, std::uint64_t size) {
  if (size == 0) return "is empty";
  if (!is_known_format(bytes)) return "is no image";
  const bool whole = bytes.size() == size;
  std::optional<Announced> announced;
  if (bytes.starts_with(kPng)) {
    constexpr std::size_t kHeader = 33;  // bytes: the signature and the chunk IHDR
    if (bytes.size() < kHeader || (whole && !ends_with_mark(bytes, "IEND"))) return "is cut off";
    announced = {number_at(bytes, 16, 4, FirstByte::kHigh),
                 number_at(bytes, 20, 4, FirstByte::kHigh)};
  } else if (bytes.starts_with(kJpegStart)) {
    if (whole && !ends_with_mark(bytes, "\xff\xd9")) return "is cut off";
    const std::optional<JpegSize> declared =
        jpeg_size(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    if (!declared && whole) return "is damaged";
    if (declared) announced = {declared->width, declared->height};
  } else if (bytes.starts_with("BM")) {
    announced = bmp_header(bytes);
  } else if (is_netpbm(bytes)) {
    announced = netpbm_header(bytes);
    if (!announced) return "is damaged";
  } else {
    announced = tiff_header(bytes);
    if (!announced && whole) return "is damaged";
  }
  if (!announced) return {};
  const auto& [width, height, fewest_bytes] = *announced;
  if (width == 0 || height == 0 || width > kMostImagePixels || width * height > kMostImagePixels) {
    return fmt::format("says it has {} x {} pixels", width, height);
  }
  if (fewest_bytes > size) {
    return fmt::format("is cut off: {} x {} pixels do not fit into its {} bytes", width, height,
                       size);
  }
  return {};
}

}  // namespace palpable
