/// @file
/// Text between tags and in quotes, of XML and of HTML.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// & < > " as entities, so that a text stays text.
[[nodiscard]] std::string markup_text(std::string_view text);

}  // namespace palpable
