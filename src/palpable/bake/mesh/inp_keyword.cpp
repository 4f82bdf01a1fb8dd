#include "palpable/bake/mesh/inp_keyword.h"

#include <utility>

namespace palpable::inp {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t comma = line.find(',');
    words.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  // A comma at the end of a line means that more follows; it adds no word here.
  if (words.size() > 1 && words.back().empty()) words.pop_back();
  return words;
}

Keyword parse_keyword(std::string_view all, std::size_t line) {
  Keyword keyword;
  keyword.line = line;
  bool first = true;
  for (const std::string_view word : split(all)) {
    const std::size_t equals = word.find('=');
    std::string key = upper(trimmed(word.substr(0, equals)));
    if (std::exchange(first, false)) {
      keyword.name = key;
      continue;
    }
    std::string_view value =
        equals == std::string_view::npos ? std::string_view{} : trimmed(word.substr(equals + 1));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"') {
      value = value.substr(1, value.size() - 2);
    }
    keyword.parameters[key] = std::string(value);
  }
  return keyword;
}

}  // namespace palpable::inp
