/// @file
/// Damage to files, the same for the same seed on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>

namespace palpable::fuzz {

using Random = std::mt19937_64;

/// A file with one to sixteen things wrong: bits, bytes, lines and numbers changed, taken away,
/// doubled or repeated, the end cut off, nested brackets put in, a part of another file put in.
/// @param bytes      a valid file
/// @param relatives  files whose parts may be put in: the same one, others of its format
[[nodiscard]] std::string mutated(std::string bytes, std::span<const std::string> relatives,
                                  Random& random);

/// The same for numbers as they lie in memory: of these bytes, one number of `size` bytes (1, 2, 4,
/// 8) becomes one that programs trip over: 0, -1, the largest, NaN, infinity.
void spoil_number(std::span<char> bytes, std::size_t size, bool floating, Random& random);

}  // namespace palpable::fuzz
