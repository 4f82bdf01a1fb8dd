#include "palpable/live/sources/jpeg_size.h"

namespace palpable {

std::optional<JpegSize> jpeg_size(const std::uint8_t* bytes, std::size_t count) {
  const auto two = [&](std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at]) << 8 | bytes[at + 1];
  };
  std::size_t at = 2;
  while (at + 9 <= count && bytes[at] == 0xFF) {
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) return JpegSize{two(at + 7), two(at + 5)};
    at += 2 + two(at + 2);
  }
  return std::nullopt;
}

}  // namespace palpable
