/// @file
/// Texts that a parser may be given: TOML, JSON, XML and OpenCV's YAML are read by recursion, and a
/// text of 60,000 brackets would overflow the stack, which nothing can catch. So length and depth
/// are looked at before, here and nowhere else.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {

enum class Notation { kToml, kJson, kYaml, kXml };

/// How many tables, lists, maps or elements may stand within each other. Real files have ten at
/// most; a level costs OpenCV's YAML reader, the hungriest, 6 KB of stack.
inline constexpr int kDeepestNesting = 64;

/// Bytes that a file in this notation may have: far above any that Palpable reads.
[[nodiscard]] std::size_t longest_text(Notation notation);

/// Why a text is not parsed.
struct Unparsable {
  std::size_t line = 0;  ///< from 1
  std::string what;
};

/// Nothing when the text may be parsed: it need not be well-formed, but is neither too long nor
/// nested too deep for a parser that stops at the first error. Never says less than the depth that
/// a parser reaches; in YAML it may say more, where brackets are closed within quotes.
[[nodiscard]] std::optional<Unparsable> why_not_parsed(std::string_view text, Notation notation);

/// The whole text of a file. A problem that names the file (and line) when it cannot be read or is
/// not to be parsed.
[[nodiscard]] Result<std::string> read_bounded_text(const std::filesystem::path& path,
                                                    Notation notation);

}  // namespace palpable
