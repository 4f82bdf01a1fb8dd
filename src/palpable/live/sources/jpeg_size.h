/// @file
/// The size of a JPEG, read before it is decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace palpable {

struct JpegSize {
  std::uint32_t width = 0;   ///< px
  std::uint32_t height = 0;  ///< px
};

/// The size in the frame header of a JPEG; empty if there is none (ITU-T T.81, B.2.2).
[[nodiscard]] std::optional<JpegSize> jpeg_size(const std::uint8_t* bytes, std::size_t count);

}  // namespace palpable
