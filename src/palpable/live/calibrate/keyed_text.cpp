#include "palpable/live/calibrate/keyed_text.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

namespace palpable {

struct KeyedTextBuilder {
  static void set(KeyedText& text, const std::string& path, std::string value) {
    text.entries_[path] = std::move(value);
  }
  static std::string& value(KeyedText& text, const std::string& path) {
    return text.entries_[path];
  }
};

namespace {

constexpr std::string_view kBlank = " \t\r\n";

std::string_view stripped(std::string_view text) {
  const std::size_t from = text.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kBlank) - from + 1);
}

std::string_view unquoted(std::string_view text) {
  text = stripped(text);
  const bool quoted = text.size() >= 2 && (text.front() == '"' || text.front() == '\'') &&
                      text.back() == text.front();
  return quoted ? text.substr(1, text.size() - 2) : text;
}

// A text of 1 MB may have 100,000 keys below one of 500,000 letters: both are cut.
std::string joined(const std::string& path, std::string_view key) {
  constexpr std::size_t kLongestKey = 64, kLongestPath = 512;  // bytes; files have "cam0.T_cn_cnm1"
  if (path.size() > kLongestPath) return path;
  key = key.substr(0, kLongestKey);
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

// ---- YAML ------------------------------------------------------------------------------------

// Without its comment, which begins at the line's start or after a space, outside of quotes.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return line.substr(0, i);
    }
  }
  return line;
}

int depth_change(std::string_view text) {
  int change = 0;
  for (const char c : text) change += (c == '[' || c == '{') - (c == ']' || c == '}');
  return change;
}

// Where the colon after a key is; npos if the text does not begin with a key.
std::size_t end_of_key(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ':' && (i + 1 == text.size() || kBlank.find(text[i + 1]) != std::string_view::npos)) {
      return i == 0 ? std::string_view::npos : i;
    }
    const bool of_key = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                        std::string_view("_.-/\"' *").find(c) != std::string_view::npos;
    if (!of_key) return std::string_view::npos;
  }
  return std::string_view::npos;
}

// The marks of a list's elements, "- - 0.5", and a type, "!!opencv-matrix", are no content.
std::string_view without_marks(std::string_view text) {
  for (text = stripped(text);;) {
    if (text.starts_with("- ") || text == "-") {
      text = stripped(text.substr(1));
    } else if (text.starts_with('!')) {
      const std::size_t end = text.find_first_of(kBlank);
      text = end == std::string_view::npos ? std::string_view() : stripped(text.substr(end));
    } else {
      return text;
    }
  }
}

// {rows: 3, data: [1, 2]} becomes a key each.
void add_flow_map(KeyedText& keyed, const std::string& path, std::string_view text, int deepest) {
  if (deepest == 0) return;
  text = stripped(text);
  text.remove_prefix(1);
  if (text.ends_with('}')) text.remove_suffix(1);
  int depth = 0;
  for (std::size_t from = 0, i = 0; i <= text.size(); ++i) {
    if (i < text.size()) depth += depth_change(text.substr(i, 1));
    if (i < text.size() && (depth != 0 || text[i] != ',')) continue;
    const std::string_view entry = stripped(text.substr(from, i - from));
    from = i + 1;
    const std::size_t colon = end_of_key(entry);
    if (colon == std::string_view::npos) continue;
    const std::string key = joined(path, unquoted(entry.substr(0, colon)));
    const std::string_view value = without_marks(entry.substr(colon + 1));
    if (value.starts_with('{')) {
      add_flow_map(keyed, key, value, deepest - 1);
    } else {
      KeyedTextBuilder::set(keyed, key, std::string(value));
    }
  }
}

void add_yaml(KeyedText& keyed, std::string_view text) {
  struct Open {
    std::size_t indent;
    std::string path;
  };
  std::vector<Open> open;
  std::string current;
  int depth = 0;  // of the brackets that the current value has not closed
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = without_comment(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::string_view content = stripped(line);
    if (content.empty() || content == "---" || content == "..." || content.starts_with("%")) {
      continue;
    }
    const std::size_t colon =
        depth > 0 || content.starts_with("- ") ? std::string_view::npos : end_of_key(content);
    if (colon != std::string_view::npos) {
      const std::size_t indent = line.find_first_not_of(" \t");
      while (!open.empty() && open.back().indent >= indent) open.pop_back();
      current = joined(open.empty() ? std::string() : open.back().path,
                       unquoted(content.substr(0, colon)));
      if (open.size() < static_cast<std::size_t>(kDeepestNesting))
        open.push_back({indent, current});
      const std::string_view value = without_marks(content.substr(colon + 1));
      KeyedTextBuilder::set(keyed, current, std::string(value));
      depth = depth_change(value);
    } else if (!current.empty()) {
      std::string& value = KeyedTextBuilder::value(keyed, current);
      value += ' ';
      value += without_marks(content);
      depth += depth_change(content);
    }
  }
  const KeyedText before = keyed;
  for (const auto& [path, value] : before.entries()) {
    if (stripped(value).starts_with('{')) add_flow_map(keyed, path, value, kDeepestNesting);
  }
}

// ---- XML and JSON ----------------------------------------------------------------------------

// OpenCV's XML: elements without attributes that matter.
void add_xml(KeyedText& keyed, std::string_view text) {
  std::vector<std::string> open;
  while (!text.empty()) {
    const std::size_t tag = std::min(text.find('<'), text.size());
    const std::string_view content = stripped(text.substr(0, tag));
    if (!content.empty() && !open.empty()) {
      std::string& value = KeyedTextBuilder::value(keyed, open.back());
      if (!value.empty()) value += ' ';
      value += content;
    }
    text.remove_prefix(tag);
    const std::size_t end = text.find('>');
    if (end == std::string_view::npos) return;
    const std::string_view inside = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
    if (inside.starts_with('?') || inside.starts_with('!') || inside.ends_with('/')) continue;
    if (inside.starts_with('/')) {
      if (!open.empty()) open.pop_back();
      continue;
    }
    const std::string_view name = inside.substr(0, inside.find_first_of(kBlank));
    if (open.size() >= static_cast<std::size_t>(kDeepestNesting)) return;
    const bool is_root = open.empty() && name == "opencv_storage";
    open.push_back(is_root ? std::string() : joined(open.empty() ? "" : open.back(), name));
    if (!is_root) KeyedTextBuilder::set(keyed, open.back(), "");
  }
}

// Numbers and texts as texts, lists with their elements one after the other.
void add_json(KeyedText& keyed, const std::string& path, const Json& json) {
  if (!json.items().empty()) {
    if (!path.empty()) KeyedTextBuilder::set(keyed, path, "");
    for (const auto& [key, value] : json.items()) add_json(keyed, joined(path, key), value);
    return;
  }
  if (json.size() == 0) {
    std::string& value = KeyedTextBuilder::value(keyed, path);
    if (!value.empty()) value += ' ';
    value += unquoted(json.dump());
    return;
  }
  int index = 0;
  for (const Json& element : json) {
    add_json(keyed, element.items().empty() ? path : joined(path, std::to_string(index)), element);
    ++index;
  }
}

}  // namespace

Result<KeyedText> KeyedText::parse(std::string_view text) {
  KeyedText keyed;
  const std::string_view content = stripped(text);
  const Notation notation = content.starts_with('{')   ? Notation::kJson
                            : content.starts_with('<') ? Notation::kXml
                                                       : Notation::kYaml;
  if (const auto unparsable = why_not_parsed(text, notation)) {
    return Problem{fmt::format("line {}: {}", unparsable->line, unparsable->what)};
  }
  if (notation == Notation::kJson) {
    const Result<Json> json = Json::parse(text);
    if (!json.ok()) return json.problem();
    add_json(keyed, "", json.value());
  } else if (notation == Notation::kXml) {
    add_xml(keyed, text);
  } else {
    add_yaml(keyed, text);
  }
  return keyed;
}

bool KeyedText::has(std::string_view path) const { return entries_.find(path) != entries_.end(); }

bool KeyedText::has_all(const std::vector<std::string_view>& paths) const {
  return std::all_of(paths.begin(), paths.end(), [&](std::string_view path) { return has(path); });
}

std::string KeyedText::first_of(const std::vector<std::string_view>& names) const {
  for (const std::string_view name : names) {
    if (has(name)) return std::string(name);
  }
  return {};
}

std::string KeyedText::word(std::string_view path) const {
  const auto entry = entries_.find(path);
  return entry == entries_.end() ? std::string() : std::string(unquoted(entry->second));
}

std::optional<std::vector<double>> KeyedText::numbers(std::string_view path) const {
  const auto data = entries_.find(std::string(path) + ".data");
  const auto entry = data != entries_.end() ? data : entries_.find(path);
  if (entry == entries_.end()) return std::nullopt;
  std::string text(unquoted(entry->second));
  // "0, -1" with spaces alone, so that no list is taken for numbers with decimal commas.
  std::replace(text.begin(), text.end(), ',', ' ');
  return to_numbers(text);
}

std::optional<double> KeyedText::number(std::string_view path) const {
  const auto all = numbers(path);
  return all && all->size() == 1 ? std::optional(all->front()) : std::nullopt;
}

std::string with_decimal_points(std::string text) {
  constexpr std::string_view kBetween = " \t\r\n[]{}();=:\"'<>";
  std::vector<std::size_t> commas;
  const auto is_digit = [&](std::size_t i) {
    return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
  };
  for (std::size_t at = 0; at < text.size();) {
    const bool of_comment =
        text[at] == '#' || (text[at] == '%' && (at == 0 || text[at - 1] == '\n'));
    if (of_comment) {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (kBetween.find(text[at]) != std::string_view::npos) {
      ++at;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of("# \t\r\n[]{}();=:\"'<>", at), text.size());
    const std::size_t last = text[end - 1] == ',' ? end - 1 : end;
    std::string word = text.substr(at, last - at);
    const std::size_t comma = word.find(',');
    if (comma != std::string::npos && is_digit(at + comma + 1) && comma > 0 &&
        is_digit(at + comma - 1)) {
      if (word.find(',', comma + 1) != std::string::npos) return text;
      word[comma] = '.';
      const bool is_list = at > 0 && text[at - 1] == '[' && end < text.size() && text[end] == ']';
      if (to_number(word) && !is_list) commas.push_back(at + comma);
    } else if (word.find('.') != std::string::npos && to_number(word)) {
      return text;
    }
    at = end;
  }
  for (const std::size_t comma : commas) text[comma] = '.';
  return text;
}

}  // namespace palpable
