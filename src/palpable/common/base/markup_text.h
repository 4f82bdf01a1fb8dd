/// @file
/// Text between tags and in quotes, of XML and of HTML.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// & < > " as entities, so that a text stays text. What XML has no way to write, control characters
/// and bytes that are no UTF-8, becomes U+FFFD: a reader would refuse the whole file for it.
[[nodiscard]] std::string markup_text(std::string_view text);

/// Whether markup_text() keeps every character.
[[nodiscard]] bool fits_in_markup(std::string_view text);

}  // namespace palpable
