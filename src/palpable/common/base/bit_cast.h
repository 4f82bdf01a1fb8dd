/// @file
/// std::bit_cast, which the standard library of Debian 12's emscripten does not have.
#pragma once

#include <type_traits>

namespace palpable {

/// The value of another type with the same bytes.
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  static_assert(std::is_trivially_copyable_v<To> && std::is_trivially_copyable_v<From>);
  return __builtin_bit_cast(To, from);
}

}  // namespace palpable
