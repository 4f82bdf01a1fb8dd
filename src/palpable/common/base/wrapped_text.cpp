#include "palpable/common/base/wrapped_text.h"

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

constexpr std::string_view kExample = "Example: ";

// Columns that a text takes on the screen: one for each code point.
std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) >> 6) != 2; }));
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t begin = text.find_first_not_of(' '); begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(' ', end);
  }
  return words;
}

// The parts between which a command may be broken: not within quotes, nor between an option and its
// value.
std::vector<std::string_view> parts_of_command(std::string_view text) {
  std::vector<std::string_view> parts;
  std::size_t quotes = 0;
  bool joins = false;
  for (const std::string_view word : words_of(text)) {
    if (joins && (quotes % 2 != 0 || !word.starts_with("-"))) {
      const char* begin = parts.back().data();
      parts.back() = {begin, static_cast<std::size_t>(word.data() + word.size() - begin)};
    } else {
      parts.push_back(word);
    }
    quotes += static_cast<std::size_t>(std::count(word.begin(), word.end(), '"'));
    joins = word.starts_with("-") || quotes % 2 != 0;
  }
  return parts;
}

// Joins words to lines. @param mark  appended to each line that is continued
std::string joined(const std::vector<std::string_view>& words, std::size_t begin,
                   std::size_t indent, std::size_t width, std::string_view mark) {
  std::string text;
  std::size_t at = begin;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t wide = columns(words[i]);
    const std::size_t reserve = i + 1 < words.size() ? mark.size() : 0;
    if (i > 0 && at + 1 + wide + reserve > width) {
      text.append(mark).append("\n").append(indent, ' ');
      at = indent;
    } else if (i > 0) {
      text += ' ';
      ++at;
    }
    text += words[i];
    at += wide;
  }
  return text;
}

// The column in which the text of a line, or the last column of a row of a table, begins.
std::size_t text_begin(std::string_view line) {
  std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  constexpr std::size_t kFarthest = 40;
  for (std::size_t gap = line.find("  ", begin); gap < kFarthest; gap = line.find("  ", begin)) {
    begin = std::min(line.find_first_not_of(' ', gap), line.size());
  }
  return begin;
}

std::string wrapped_line(std::string_view line, std::size_t width) {
  if (columns(line) <= width) return std::string(line);
  if (line.starts_with(kExample)) {
    return std::string(kExample) + joined(parts_of_command(line.substr(kExample.size())),
                                          kExample.size(), kExample.size() + 2, width, " \\");
  }
  const std::size_t begin = text_begin(line);
  return std::string(line.substr(0, begin)) + wrapped(line.substr(begin), begin, begin, width);
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent,
                    std::size_t width) {
  if (begin + columns(text) <= width) return std::string(text);
  return joined(words_of(text), begin, indent, width, "");
}

std::string wrapped_lines(std::string_view text, std::size_t width) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    result += wrapped_line(text.substr(0, end), width) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

}  // namespace palpable
