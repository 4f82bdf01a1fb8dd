/// @file
/// Ratios that are undefined for an empty whole.
#pragma once

#include <cstdint>
#include <optional>

namespace palpable {

/// part / whole; nothing when the whole is 0.
[[nodiscard]] inline std::optional<double> share_of(std::int64_t part, std::int64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace palpable
