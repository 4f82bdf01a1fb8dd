#include "palpable/bake/mesh/inp_include.h"

#include "palpable/bake/mesh/inp_keyword.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

namespace palpable::inp {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDeepest = 10, kMostFiles = 1000;

// A text, line by line.
class DeckLines {
 public:
  explicit DeckLines(std::string_view text) : rest_(text) {}

  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return line;
  }
  [[nodiscard]] std::size_t number() const { return number_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

bool is_keyword(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.starts_with('*') && !text.starts_with("**");
}

// Whether a keyword's lines are in a file of their own.
bool has_data_in_file(const Keyword& keyword) {
  constexpr std::array<std::string_view, 6> kKeywords{"*INCLUDE", "*NODE",  "*ELEMENT",
                                                      "*NSET",    "*ELSET", "*SURFACE"};
  return !keyword.get("INPUT").empty() &&
         std::find(kKeywords.begin(), kKeywords.end(), keyword.name) != kKeywords.end();
}

class DeckBuilder {
 public:
  DeckBuilder(fs::path main, std::uintmax_t most, const ReadText& read)
      : main_(std::move(main)), left_(most), read_(read) {}

  Result<Deck> build(std::string_view text) {
    if (auto problem = add(text, main_)) return std::move(*problem);
    return std::move(deck_);
  }

 private:
  // Appends a file's lines and those of the files that it includes.
  std::optional<Problem> add(std::string_view text, const fs::path& path) {
    within_.push_back(path);
    DeckLines lines(text);
    begin_part(path, 1);
    while (const auto line = lines.next()) {
      if (!is_keyword(*line)) {
        append(*line);
        continue;
      }
      if (auto problem = add_keyword(*line, lines, path)) return problem;
    }
    within_.pop_back();
    return std::nullopt;
  }

  // Appends a keyword with the lines that continue it, and the file that it names.
  std::optional<Problem> add_keyword(std::string_view line, DeckLines& lines,
                                     const fs::path& path) {
    const std::size_t first = lines.number();
    std::vector<std::string_view> mine{line};
    std::string all(line);
    while (trimmed(all).ends_with(',')) {
      DeckLines ahead = lines;
      const auto more = ahead.next();
      if (!more || trimmed(*more).starts_with('*')) break;
      lines = ahead;
      mine.push_back(*more);
      all += *more;
    }
    const Keyword keyword = parse_keyword(all, first);
    const bool is_include = keyword.name == "*INCLUDE" && keyword.has("INPUT");
    // As a comment, an *INCLUDE may stand within the data of another keyword.
    for (const std::string_view part : mine) append(is_include ? "**" : part);
    if (!has_data_in_file(keyword)) return std::nullopt;
    if (auto problem = include(keyword.get("INPUT"), path, first)) return problem;
    begin_part(path, lines.number() + 1);
    return std::nullopt;
  }

  std::optional<Problem> include(const std::string& file, const fs::path& from, std::size_t line) {
    const auto refuse = [&](const std::string& why) {
      return Problem{fmt::format("{}: line {}: includes '{}': {}", from.string(), line, file, why)};
    };
    const fs::path path = find(file, from);
    const auto is_path = [&](const fs::path& other) { return canonical(other) == canonical(path); };
    if (std::any_of(within_.begin(), within_.end(), is_path)) {
      return refuse("which would include itself; take the line out");
    }
    if (within_.size() > kDeepest) {
      return refuse(fmt::format("more than {} files within each other", kDeepest));
    }
    if (++files_ > kMostFiles) return refuse(fmt::format("more than {} files", kMostFiles));
    Result<std::string> text = read_(path, left_);
    if (!text) {
      return refuse(text.problem().message + "; put it beside the deck, or write its path there");
    }
    left_ -= std::min<std::uintmax_t>(left_, text.value().size());
    return add(text.value(), path);
  }

  // The path of an included file; slashes may be those of Windows.
  [[nodiscard]] fs::path find(const std::string& file, const fs::path& from) const {
    std::string slashes = file;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    for (const std::string& name : {file, slashes}) {
      for (const fs::path& beside : {from, main_}) {
        std::error_code ignored;
        const fs::path path = beside.parent_path() / name;
        if (fs::exists(path, ignored)) return path;
      }
    }
    return from.parent_path() / slashes;
  }

  static fs::path canonical(const fs::path& path) {
    std::error_code code;
    const fs::path found = fs::weakly_canonical(path, code);
    return code ? path : found;
  }

  void begin_part(const fs::path& path, std::size_t line) {
    deck_.parts.push_back({line_ + 1, path.string(), line});
  }

  void append(std::string_view line) {
    deck_.text.append(line) += '\n';
    ++line_;
  }

  fs::path main_;
  std::uintmax_t left_;  // bytes that may still be read
  const ReadText& read_;
  Deck deck_;
  std::vector<fs::path> within_;  // the files that are open, from the deck to the innermost
  std::size_t line_ = 0, files_ = 0;
};

bool names_files(std::string_view text) {
  DeckLines lines(text);
  while (const auto line = lines.next()) {
    if (line->find('*') == std::string_view::npos && line->find('=') == std::string_view::npos)
      continue;
    if (upper(*line).find("INPUT") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

std::string Deck::place(std::size_t line, std::string_view name) const {
  const auto after =
      std::upper_bound(parts.begin(), parts.end(), line,
                       [](std::size_t l, const Part& part) { return l < part.first; });
  if (after == parts.begin()) return fmt::format("{}: line {}", name, line);
  const Part& part = *std::prev(after);
  return fmt::format("{}: line {}", part.file, part.line + (line - part.first));
}

Result<Deck> with_includes(std::string text, const fs::path& path, std::uintmax_t most,
                           const ReadText& read) {
  if (!names_files(text)) return Deck{std::move(text)};
  return DeckBuilder(path, most, read).build(text);
}

}  // namespace palpable::inp
