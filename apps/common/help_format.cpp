#include "apps/common/help_format.h"

#include "palpable/common/base/wrapped_text.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

constexpr std::size_t kTextColumn = 30;
constexpr std::size_t kHelpWidth = 100;  // columns

// A readable form of CLI11's type name ("TEXT:{a,b}", "FLOAT:FLOAT in [0 - 1]").
struct TypeWords {
  std::string type;                // name of the value
  std::vector<std::string> rules;  // restrictions of the value
};

TypeWords type_words(const std::string& cli_name) {
  TypeWords words;
  std::vector<std::string> parts = CLI::detail::split(cli_name, ':');
  words.type = parts.front();
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) {
    const std::size_t range = part->find(" in [");
    if (range != std::string::npos && part->ends_with("]")) {
      std::string ends = part->substr(range + 5, part->size() - range - 6);
      const std::size_t middle = ends.find(" - ");
      if (middle != std::string::npos) ends.replace(middle, 3, " to ");
      words.rules.push_back(ends);
    } else if (part->starts_with("{") && part->ends_with("}")) {
      std::string choices = part->substr(1, part->size() - 2);
      std::replace(choices.begin(), choices.end(), ',', '|');
      if (words.type == "TEXT") {
        words.type = choices;
      } else {
        words.rules.push_back(choices);
      }
    } else if (*part == "POSITIVE") {
      words.rules.emplace_back("above 0");
    } else if (*part == "NONNEGATIVE") {
      words.rules.emplace_back("0 or more");
    } else if (!part->empty() && *part != "FILE" && *part != "DIR" && *part != "PATH(existing)") {
      words.rules.push_back(*part);
    }
  }
  if (words.type == "INT" || words.type == "UINT") words.type = "N";
  if (words.type == "FLOAT") words.type = "NUMBER";
  return words;
}

// A row with `name` in the left column and the wrapped text in the right one.
std::string row(const std::string& name, const std::string& text) {
  std::string line = "  " + name;
  if (text.empty()) return line + "\n";
  line += line.size() + 2 > kTextColumn ? "\n" + std::string(kTextColumn, ' ')
                                        : std::string(kTextColumn - line.size(), ' ');
  return line + wrapped(text, kTextColumn, kTextColumn, kHelpWidth) + "\n";
}

class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat() {
    label("Positionals", "Arguments");
    label("SUBCOMMAND", "COMMAND");
  }

  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0, 0, kHelpWidth) + "\n";
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string line = CLI::Formatter::make_usage(app, std::move(name));
    while (line.ends_with("\n")) line.pop_back();
    return wrapped(line, 0, 4, kHelpWidth) + "\n";
  }
  std::string make_subcommand(const CLI::App* sub) const override {
    return row(sub->get_display_name(true), sub->get_description());
  }
  std::string make_footer(const CLI::App* app) const override {
    return wrapped_lines(app->get_footer(), kHelpWidth);
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string name = make_option_name(option, is_positional);
    std::vector<std::string> rules;
    if (option->get_type_size() != 0) {  // not a flag
      TypeWords type = type_words(option->get_type_name());
      // Omits a type that says nothing new: "body Body file" needs no PATH, "surface" no SURFACE.
      const bool says_more =
          type.type != "TEXT" && type.type != "PATH" && CLI::detail::to_lower(type.type) != name;
      if (!is_positional || says_more) name += " " + type.type;
      if (option->get_expected_max() >= CLI::detail::expected_max_vector_size) name += " ...";
      rules = std::move(type.rules);
      if (const std::string usual = option->get_default_str(); !usual.empty()) {
        rules.push_back("default " + usual);
      }
    }
    if (option->get_required() && !is_positional) rules.emplace_back("required");
    std::set<std::string> others;  // sorted by name; CLI11 has them sorted by address
    for (const CLI::Option* other : option->get_excludes()) others.insert(other->get_name());
    if (!others.empty()) rules.push_back(fmt::format("not with {}", fmt::join(others, ", ")));
    std::string text = option->get_description();
    if (!rules.empty()) text += fmt::format(" [{}]", fmt::join(rules, "; "));
    return row(name, text);
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format() { return std::make_shared<HelpFormat>(); }

}  // namespace palpable::app
