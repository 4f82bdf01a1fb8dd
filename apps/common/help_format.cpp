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
  explicit HelpFormat(bool all) : all_(all) {
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
    std::string text = app->get_footer();
    if (app->get_parent() != nullptr) {
      text = "Also: -q prints no progress, -v time and memory at the end.\n" + text;
    }
    return wrapped_lines(text, kHelpWidth);
  }
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::string text = CLI::Formatter::make_help(app, std::move(name), mode);
    // CLI11 leaves an empty line for a group that lists nothing.
    for (std::size_t at = text.find("\n\n\n"); at != std::string::npos;
         at = text.find("\n\n\n", at)) {
      text.erase(at, 1);
    }
    return text;
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (group.front() != kExpertMark) {
      return CLI::Formatter::make_group(group, is_positional, options);
    }
    return all_ ? CLI::Formatter::make_group(group.substr(1), is_positional, options) : "";
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string name = make_option_name(option, is_positional);
    OptionWords words = words_of(*option);
    if (!words.value.empty()) {
      // Omits a type that says nothing new: "body Body file" needs no FILE, "surface" no SURFACE.
      const bool says_more = words.value != "TEXT" && words.value != "FILE" &&
                             CLI::detail::to_lower(words.value) != name;
      if (!is_positional || says_more) name += " " + words.value;
      if (words.several) name += " ...";
    }
    std::vector<std::string> notes = std::move(words.limits);
    if (words.usual == "required") {
      if (!is_positional) notes.push_back(words.usual);
    } else if (!words.usual.empty() && !(is_positional && words.usual == "none")) {
      notes.push_back("default: " + words.usual);
    }
    std::set<std::string> others;  // sorted by name; CLI11 has them sorted by address
    for (const CLI::Option* other : option->get_excludes()) others.insert(other->get_name());
    if (!others.empty()) notes.push_back(fmt::format("not with {}", fmt::join(others, ", ")));
    // An argument that may also be given as an option is explained once.
    const bool is_both = option->get_positional() && option->nonpositional();
    std::string text = is_both && !is_positional
                           ? fmt::format("The argument {}, as an option", option->get_name(true))
                           : option->get_description();
    if (!notes.empty()) text += fmt::format(" [{}]", fmt::join(notes, "; "));
    return row(name, text);
  }

 private:
  bool all_;
};

}  // namespace

bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0; }

OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  if (is_flag(option)) return words;
  // CLI11's type names: "TEXT:{a,b}", "FLOAT:FLOAT in [0 - 1]".
  const std::vector<std::string> parts = CLI::detail::split(option.get_type_name(), ':');
  words.value = parts.front();
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) {
    const std::size_t range = part->find(" in [");
    if (range != std::string::npos && part->ends_with("]")) {
      std::string ends = part->substr(range + 5, part->size() - range - 6);
      const std::size_t middle = ends.find(" - ");
      if (middle != std::string::npos) ends.replace(middle, 3, " to ");
      words.limits.push_back(ends);
    } else if (part->starts_with("{") && part->ends_with("}")) {
      words.choices = CLI::detail::split(part->substr(1, part->size() - 2), ',');
      const std::string choices = fmt::format("{}", fmt::join(words.choices, "|"));
      if (words.value == "TEXT") {
        words.value = choices;
      } else {
        words.limits.push_back(choices);
      }
    } else if (*part == "POSITIVE") {
      words.limits.emplace_back("above 0");
    } else if (*part == "NONNEGATIVE") {
      words.limits.emplace_back("0 or more");
    } else if (!part->empty() && *part != "FILE" && *part != "DIR" && *part != "PATH(existing)") {
      words.limits.push_back(*part);
    }
  }
  if (words.value == "INT" || words.value == "UINT") words.value = "N";
  if (words.value == "FLOAT") words.value = "NUMBER";
  words.several = option.get_expected_max() > 1;
  const std::string usual = option.get_default_str();
  words.usual = option.get_required() ? "required" : usual.empty() ? "none" : usual;
  return words;
}

std::shared_ptr<CLI::FormatterBase> help_format(bool all) {
  return std::make_shared<HelpFormat>(all);
}

}  // namespace palpable::app
