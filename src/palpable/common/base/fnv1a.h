/// @file
/// A 64-bit checksum. It identifies meshes and bodies and shows whether a file is complete; it
/// detects accidental changes, not deliberate ones.
#pragma once

#include <cstdint>
#include <string_view>

namespace palpable {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

/// FNV-1a: each byte enters by an exclusive or and a multiplication, so that any one changed byte
/// changes the result.
/// @param hash  the result for the bytes before these, so that bytes can be hashed in pieces
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view bytes,
                                            std::uint64_t hash = kFnvStart) {
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace palpable
