/// @file
/// Damage to files, the same for the same seed on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>

namespace palpable::fuzz {

using Random = std::mt19937_64;

/// A file with one to sixteen defects: bits, bytes, lines and numbers changed, removed, duplicated
/// or repeated; the end truncated; nested brackets or a part of another file inserted.
/// @param bytes      a valid file
/// @param relatives  files whose parts may be inserted: the same file, others of its format
[[nodiscard]] std::string mutated(std::string bytes, std::span<const std::string> relatives,
                                  Random& random);

/// Replaces one number of `size` bytes (1, 2, 4, 8) in binary data by a value that programs often
/// handle wrongly: 0, -1, the largest value, NaN, infinity.
void spoil_number(std::span<char> bytes, std::size_t size, bool floating, Random& random);

}  // namespace palpable::fuzz
