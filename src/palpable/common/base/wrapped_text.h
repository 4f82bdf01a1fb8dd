/// @file
/// Text broken into lines that a terminal shows whole.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace palpable {

/// Breaks at spaces, so that no line is wider than `width` columns; only a single word may be. A
/// text that fits stays as it is, spaces within it too.
/// @param text    one line, UTF-8
/// @param begin   columns that are already taken in the first line
/// @param indent  spaces before each further line
/// @return without a line break at the end
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent,
                                  std::size_t width);

/// Lines, each wrapped on its own. The rest of a line goes below where its text begins, that of a
/// row of a table ("  name   what it is") below its last column.
///
/// A line "Example: command" is broken with a backslash, as a shell wants it, so that it can be
/// copied and run; an option stays beside its value.
[[nodiscard]] std::string wrapped_lines(std::string_view text, std::size_t width);

}  // namespace palpable
