/// @file
/// Lines of the input decks of Abaqus and CalculiX: words between commas, and keywords with their
/// parameters.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::inp {

/// Without blanks and tabs at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// In capitals: names and keywords are case-insensitive.
[[nodiscard]] std::string upper(std::string_view text);

/// The words between commas, trimmed. A comma at the end of a line means that more follows; it adds
/// no word.
[[nodiscard]] std::vector<std::string_view> split(std::string_view line);

/// "*ELEMENT, TYPE=C3D4, ELSET=BODY"
struct Keyword {
  std::string name;                               ///< "*ELEMENT"
  std::map<std::string, std::string> parameters;  ///< "TYPE" -> "C3D4" as written, without quotes
  std::size_t line = 0;

  [[nodiscard]] bool has(const char* key) const { return parameters.contains(key); }
  [[nodiscard]] std::string get(const char* key) const {
    const auto at = parameters.find(key);
    return at == parameters.end() ? "" : at->second;
  }
};

/// @param all  the keyword's line with those that continue it
[[nodiscard]] Keyword parse_keyword(std::string_view all, std::size_t line);

}  // namespace palpable::inp
