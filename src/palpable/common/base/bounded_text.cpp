#include "palpable/common/base/bounded_text.h"

#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

constexpr std::size_t kMegabyte = 1'000'000;

// Finds the line where the nesting of a text exceeds the limit.
class Depth {
 public:
  void next_line() { ++line_; }
  void see(std::size_t depth) {
    if (depth <= kDeepestNesting || passed_at_ != 0) return;
    passed_at_ = line_;
  }
  [[nodiscard]] bool passed() const { return passed_at_ != 0; }
  [[nodiscard]] std::size_t line() const { return passed_at_; }

 private:
  std::size_t line_ = 1, passed_at_ = 0;
};

// The position after the string that begins at `at`: behind its closing quotes. A one-line string
// also ends at the end of its line, where the parser refuses it.
std::size_t end_of_string(std::string_view text, std::size_t at, bool toml, Depth& depth) {
  const char quote = text[at];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool many_lines = toml && text.substr(at, 3) == three;
  at += many_lines ? 3 : 1;
  while (at < text.size()) {
    if (text[at] == '\n') {
      if (!many_lines) return at;
      depth.next_line();
    }
    if (escapes && text[at] == '\\') {
      if (at + 1 < text.size() && text[at + 1] == '\n') depth.next_line();
      at += 2;
      continue;
    }
    if (many_lines ? text.substr(at, 3) == three : text[at] == quote) {
      return at + (many_lines ? 3 : 1);
    }
    ++at;
  }
  return text.size();
}

void measure_json(std::string_view text, Depth& depth) {
  std::size_t open = 0;
  for (std::size_t at = 0; at < text.size() && !depth.passed();) {
    const char c = text[at];
    if (c == '"') {
      at = end_of_string(text, at, false, depth);
      continue;
    }
    if (c == '\n') depth.next_line();
    if (c == '[' || c == '{') depth.see(++open);
    if ((c == ']' || c == '}') && open > 0) --open;
    ++at;
  }
}

// A dotted key, a.b.c, counts as three nested tables; so does a heading [a.b.c].
void measure_toml(std::string_view text, Depth& depth) {
  std::vector<std::size_t> outside;  // the depth around each open bracket
  std::size_t base = 0, dots = 0;
  for (std::size_t at = 0; at < text.size() && !depth.passed();) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at = end_of_string(text, at, true, depth);
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '.') depth.see(base + ++dots);
    if (c == '[' || c == '{') {
      outside.push_back(base);
      base += dots + 1;
      depth.see(base);
    }
    if ((c == ']' || c == '}') && !outside.empty()) {
      base = outside.back();
      outside.pop_back();
    }
    if (c == '\n') depth.next_line();
    if (c == '\n' || c == ',' || c == '[' || c == '{' || c == ']' || c == '}') dots = 0;
    ++at;
  }
}

// Overestimates the depth: each "key: " and each "- " of a line may open a block within the one
// before it, and the line itself may be in one block for each column of its indentation. Closing
// brackets in a line with quotes or a comment are not counted, since they may be part of those.
void measure_yaml(std::string_view text, Depth& depth) {
  std::size_t open = 0;
  for (std::size_t begin = 0; begin < text.size() && !depth.passed();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    const bool counts_closing = line.find_first_of("\"'#") == std::string_view::npos;
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    const bool comment = line.substr(first).starts_with('#');
    std::size_t blocks = open > 0 || comment ? 0 : first;
    for (std::size_t i = comment ? line.size() : first; i < line.size(); ++i) {
      const char c = line[i];
      const bool last = i + 1 == line.size();
      if (c == ':' || (c == '-' && (last || line[i + 1] == ' ' || line[i + 1] == '-'))) ++blocks;
      if (c == '[' || c == '{') ++open;
      depth.see(blocks + open);
      if ((c == ']' || c == '}') && counts_closing && open > 0) --open;
    }
    depth.next_line();
    begin = end + 1;
  }
}

// The position after the next `mark`, or the end of the text; counts the lines on the way.
std::size_t behind(std::string_view text, std::size_t at, std::string_view mark, Depth& depth) {
  const std::size_t found = text.find(mark, at);
  const std::size_t end = found == std::string_view::npos ? text.size() : found + mark.size();
  for (std::size_t i = at; i < end; ++i) {
    if (text[i] == '\n') depth.next_line();
  }
  return end;
}

// The position after the > of the tag that begins at `at`; a > within quotes does not end the tag.
std::size_t end_of_tag(std::string_view text, std::size_t at, Depth& depth) {
  char quote = '\0';
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '\n') depth.next_line();
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at + 1;
    }
  }
  return text.size();
}

void measure_xml(std::string_view text, Depth& depth) {
  std::size_t open = 0;
  for (std::size_t at = 0; at < text.size() && !depth.passed();) {
    if (text[at] != '<') {
      if (text[at++] == '\n') depth.next_line();
      continue;
    }
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, at, "-->", depth);
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, at, "]]>", depth);
    } else if (rest.starts_with("<?")) {
      at = behind(text, at, "?>", depth);
    } else {
      const std::size_t end = end_of_tag(text, at, depth);
      const bool closes = rest.starts_with("</");
      const bool empty = end >= 2 && text[end - 1] == '>' && text[end - 2] == '/';
      if (closes && open > 0) --open;
      if (!closes && !rest.starts_with("<!") && !empty) depth.see(++open);
      at = end;
    }
  }
}

}  // namespace

std::size_t longest_text(Notation notation) {
  switch (notation) {
    case Notation::kToml:
      return 16 * kMegabyte;  // a description with thousands of points
    case Notation::kJson:
      return 256 * kMegabyte;  // reports on a week of frames
    case Notation::kYaml:
      return kMegabyte;  // a calibration has two thousand bytes
    case Notation::kXml:
      break;
  }
  return 2000 * kMegabyte;  // a mesh of ten million nodes as text
}

std::optional<Unparsable> why_not_parsed(std::string_view text, Notation notation) {
  if (text.size() > longest_text(notation)) {
    return Unparsable{1, fmt::format("{} MB, where {} are read at most", text.size() / kMegabyte,
                                     longest_text(notation) / kMegabyte)};
  }
  Depth depth;
  switch (notation) {
    case Notation::kToml:
      measure_toml(text, depth);
      break;
    case Notation::kJson:
      measure_json(text, depth);
      break;
    case Notation::kYaml:
      measure_yaml(text, depth);
      break;
    case Notation::kXml:
      measure_xml(text, depth);
      break;
  }
  if (!depth.passed()) return std::nullopt;
  return Unparsable{depth.line(),
                    fmt::format("nested more than {} deep, which is not read", kDeepestNesting)};
}

Result<std::string> read_bounded_text(const std::filesystem::path& path, Notation notation) {
  Result<std::string> text = read_text_file(path, {.most = longest_text(notation)});
  if (!text) return Problem{fmt::format("{}: {}", path.string(), text.problem().message)};
  if (const auto unparsable = why_not_parsed(text.value(), notation)) {
    return Problem{
        fmt::format("{}: line {}: {}", path.string(), unparsable->line, unparsable->what)};
  }
  return text;
}

}  // namespace palpable
