#include "palpable/live/sources/exr_header.h"

#include "palpable/live/sources/image_header.h"

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpable {
namespace {

// The attributes of the header that decide: openexr.com, "OpenEXR File Layout".
struct ExrHeader {
  std::size_t channels = 0;
  std::size_t name_at = 0, name_size = 0;  // of the first channel
  std::int64_t width = 0, height = 0;      // px
  int compression = -1;
  bool complete = false;  // its end was found
};

class ExrText {
 public:
  explicit ExrText(std::string_view bytes) : bytes_(bytes) {}

  std::size_t at = 0;

  // A text that ends with a zero byte; empty also at the end of the bytes.
  std::string_view text() {
    const std::size_t end = bytes_.find('\0', at);
    if (end == std::string_view::npos) {
      at = bytes_.size();
      return {};
    }
    const std::string_view found = bytes_.substr(at, end - at);
    at = end + 1;
    return found;
  }

  // The little-endian number of 32 bits; 0 behind the end.
  std::int32_t number(std::size_t from) const {
    if (from > bytes_.size() || bytes_.size() - from < 4) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) {
      value = value << 8 | static_cast<unsigned char>(bytes_[from + i]);
    }
    return static_cast<std::int32_t>(value);
  }

  std::size_t size() const { return bytes_.size(); }
  bool ended() const { return at >= bytes_.size(); }

 private:
  std::string_view bytes_;
};

void read_channels(ExrText text, std::size_t end, ExrHeader& header) {
  constexpr std::size_t kBehindName = 16;  // type, linear and 3 reserved bytes, two samplings
  while (text.at < end) {
    const std::size_t name_at = text.at;
    const std::string_view name = text.text();
    if (name.empty()) return;
    if (header.channels == 0) {
      header.name_at = name_at;
      header.name_size = name.size();
    }
    ++header.channels;
    text.at += kBehindName;
  }
}

ExrHeader read_exr_header(std::string_view bytes) {
  constexpr std::size_t kBegin = 8;  // magic number and version
  ExrHeader header;
  ExrText text(bytes);
  text.at = kBegin;
  while (!text.ended()) {
    const std::string_view name = text.text();
    if (name.empty()) {
      header.complete = !text.ended();
      return header;
    }
    (void)text.text();  // its type
    const std::int32_t size = text.number(text.at);
    text.at += 4;
    if (size < 0 || text.at > text.size() ||
        static_cast<std::size_t>(size) > text.size() - text.at) {
      return header;
    }
    const std::size_t value = text.at, end = value + static_cast<std::size_t>(size);
    if (name == "channels") read_channels(text, end, header);
    if (name == "compression" && size >= 1) {
      header.compression = static_cast<unsigned char>(bytes[value]);
    }
    if (name == "dataWindow") {
      header.width = std::int64_t{text.number(value + 8)} - text.number(value) + 1;
      header.height = std::int64_t{text.number(value + 12)} - text.number(value + 4) + 1;
    }
    text.at = end;
  }
  return header;
}

}  // namespace

std::string prepare_exr(std::string& bytes) {
  constexpr std::string_view kMagic = "v/1\x01";
  constexpr std::int32_t kLowByte = 0xff;  // version; above it are the kinds of layout
  if (!bytes.starts_with(kMagic)) return "is no OpenEXR file";
  if ((ExrText(bytes).number(4) & ~kLowByte) != 0) {
    return "is an OpenEXR file of tiles or parts; one of scan lines is read";
  }
  const ExrHeader header = read_exr_header(bytes);
  if (!header.complete) return "is cut off";
  const auto most = static_cast<std::int64_t>(kMostImagePixels);
  if (header.width < 1 || header.height < 1 || header.width > most || header.height > most ||
      header.width * header.height > most) {
    return fmt::format("says it has {} x {} pixels", header.width, header.height);
  }
  if (header.channels != 1) {
    return fmt::format("has {} channels, where one of depths is wanted", header.channels);
  }
  constexpr int kPixarLossy = 5;  // and B44, DWA: they change depths
  if (header.compression < 0 || header.compression >= kPixarLossy) {
    return "is packed with loss, or in an unknown way; export depth without loss";
  }
  if (header.name_size != 1) {
    return "has a channel with a long name; one of one letter (Y, R or Z) is read";
  }
  bytes[header.name_at] = 'Y';
  return {};
}

}  // namespace palpable
