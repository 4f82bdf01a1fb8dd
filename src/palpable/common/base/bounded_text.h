/// @file
/// Checks the length and nesting depth of a text before it is parsed. The parsers of TOML, JSON,
/// XML and OpenCV's YAML are recursive: a text of 60,000 brackets would overflow the stack, which
/// cannot be caught. All checks of this kind are here.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {

enum class Notation { kToml, kJson, kYaml, kXml };

/// How many tables, lists, maps or elements may be nested. Real files have at most ten levels; one
/// level costs 6 KB of stack in OpenCV's YAML reader, which needs the most.
inline constexpr int kDeepestNesting = 64;

/// Largest size of a text in this notation, bytes: far above that of any file that Palpable reads.
[[nodiscard]] std::size_t longest_text(Notation notation);

/// Why a text must not be parsed.
struct Unparsable {
  std::size_t line = 0;  ///< from 1
  std::string what;
};

/// Nothing if the text may be parsed: it need not be well-formed, but it is neither too long nor
/// nested too deep for a parser that stops at the first error. The depth is never underestimated;
/// in YAML it may be overestimated if brackets are closed within quotes.
[[nodiscard]] std::optional<Unparsable> why_not_parsed(std::string_view text, Notation notation);

/// The whole text of a file as plain_text(), or a problem that names the file (and line) if it
/// cannot be read or must not be parsed.
[[nodiscard]] Result<std::string> read_bounded_text(const std::filesystem::path& path,
                                                    Notation notation);

}  // namespace palpable
