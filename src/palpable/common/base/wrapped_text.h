/// @file
/// Breaks text into lines that fit a terminal's width.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpable {

/// Breaks a text at spaces, so that no line is wider than `width` columns unless a single word is.
/// A text that fits is returned unchanged, with its spaces.
/// @param text    one line, UTF-8
/// @param begin   columns that are already occupied in the first line
/// @param indent  spaces before each further line
/// @return without a line break at the end
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent,
                                  std::size_t width);

/// Wraps each line of a text on its own. Continuation lines are indented to the beginning of the
/// line's text, or of the last column in a row of a table ("  name   what it is").
///
/// A line "Example: command" is broken with backslashes, so that it can be copied into a shell; an
/// option and its value stay in one line.
[[nodiscard]] std::string wrapped_lines(std::string_view text, std::size_t width);

}  // namespace palpable
