/// @file
/// Numbers as bytes in little-endian order.
#pragma once

#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace palpable {

static_assert(std::endian::native == std::endian::little,
              "numbers are copied as they lie in memory");

/// Appends a number.
template <class T>
requires std::is_arithmetic_v<T>
void put(std::string& bytes, T number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Removes a number from the front and returns it; empty if there are too few bytes.
template <class T>
requires std::is_arithmetic_v<T>
[[nodiscard]] std::optional<T> take(std::string_view& bytes) {
  if (bytes.size() < sizeof(T)) return std::nullopt;
  T number;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

}  // namespace palpable
