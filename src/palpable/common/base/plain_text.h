/// @file
/// A text as its reader should see it, whatever editor or system wrote it.
///
/// Without this, a byte-order mark becomes a part of the first word (an OBJ loses its first vertex,
/// and all faces refer to the wrong one), a text with the line ends of an old Macintosh is one
/// line, and UTF-16 is a text of unknown words.
#pragma once

#include "palpable/common/base/error.h"

#include <string>
#include <string_view>

namespace palpable {

/// The text without UTF-8's byte-order mark.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// Whether a text begins with the byte-order mark of UTF-16.
[[nodiscard]] bool is_utf16(std::string_view text);

/// What a message says of a zero byte in a text, after the line's number.
inline constexpr std::string_view kZeroByte =
    "a zero byte, which no text has; is it UTF-16 (save it as UTF-8), a file of another kind, or "
    "one "
    "that was cut short?";

enum class TextPart { kAll, kFirst };

/// Why bytes are no text in ASCII or UTF-8, or in a Latin code page: "is UTF-16: ...", "line 3: a
/// zero byte, ..."; empty: nothing is wrong. One zero byte at the very end is allowed, because some
/// programs write a string with its end.
/// @param part  kFirst: the bytes are the beginning of a longer text
[[nodiscard]] std::string why_no_text(std::string_view bytes, TextPart part);

/// The text in UTF-8 without byte-order mark and with "\n" as the end of each line ("\r\n" and a
/// lone "\r" become it), without the zero byte at its end. The problem is that of why_no_text().
[[nodiscard]] Result<std::string> plain_text(std::string bytes);

}  // namespace palpable
