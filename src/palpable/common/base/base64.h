/// @file
/// Bytes as letters, for pages that hold everything in one file.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// Base64 of RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace palpable
