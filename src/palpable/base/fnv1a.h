/// @file
/// A 64-bit name for some bytes: which mesh, which body, whether a file is whole. Against
/// accidents, not against intent.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpable {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

/// FNV-1a: each byte enters by an exclusive or and a multiplication, so that any one changed byte
/// changes the result.
/// @param hash  of the bytes before these; hashing in pieces gives what hashing at once does
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view bytes,
                                            std::uint64_t hash = kFnvStart) {
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace palpable
