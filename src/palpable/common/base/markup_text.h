/// @file
/// Escapes text for XML and HTML, between tags and in quotes.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// Replaces & < > " by entities. Control characters and bytes that are not valid UTF-8, which XML
/// cannot hold and for which a reader would refuse the whole file, become U+FFFD.
[[nodiscard]] std::string markup_text(std::string_view text);

/// Whether markup_text() keeps every character.
[[nodiscard]] bool fits_in_markup(std::string_view text);

}  // namespace palpable
