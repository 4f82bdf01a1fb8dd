/// @file
/// 64-bit checksums. They detect accidental changes, not deliberate ones.
#pragma once

#include "palpable/common/base/error.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <type_traits>

namespace palpable {

inline constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325u;

/// FNV-1a, which identifies meshes and bodies and shows whether a file is complete: each byte
/// enters by an exclusive or and a multiplication, so that any one changed byte changes the result.
/// @param hash  the result for the bytes before these, so that bytes can be hashed in pieces
[[nodiscard]] constexpr std::uint64_t fnv1a(std::string_view bytes,
                                            std::uint64_t hash = kFnvStart) {
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  return hash;
}

static_assert(std::endian::native == std::endian::little, "words are hashed as they lie in memory");

/// A checksum for large data: like fnv1a(), but eight bytes at a time, so that the images of a
/// frame take one millisecond instead of six. Hashes one piece after another. Each step is
/// invertible, both in the word and in the hash before it, so that changing any one word changes
/// the result.
class WordHash {
 public:
  /// The size of each piece is hashed, too: "ab" and "c" give another result than "a" and "bc".
  void add(const void* bytes, std::size_t count) {
    add_word(count);
    const char* at = static_cast<const char*>(bytes);
    for (; count >= sizeof(std::uint64_t); at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, at, sizeof word);
      add_word(word);
      count -= sizeof word;
    }
    if (count == 0) return;
    std::uint64_t rest = 0;
    std::memcpy(&rest, at, count);
    add_word(rest);
  }

  /// A number, by its bits.
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T number) {
    std::uint64_t word = 0;
    std::memcpy(&word, &number, sizeof number);
    add_word(word);
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  // The product moves changes towards higher bits only, and the shift brings them down again.
  // Without the shift, changed signs (highest bits) of two numbers could cancel.
  void add_word(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x9e3779b97f4a7c15U;
    value_ ^= value_ >> 32;
  }

  std::uint64_t value_ = 0xcbf29ce484222325U;
};

/// The WordHash of a file's bytes, read piece by piece; takes 0.1 s for 200 MB that
/// the system has in memory. The problem is a reason without the file's name, for the caller's
/// message.
[[nodiscard]] Result<std::uint64_t> file_checksum(const std::filesystem::path& path);

}  // namespace palpable
