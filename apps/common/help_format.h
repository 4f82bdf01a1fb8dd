/// @file
/// The layout of --help. Separate from command_line.h because few files need it.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace CLI {
class FormatterBase;
class Option;
}  // namespace CLI

namespace palpable::app {

/// Prefix of the group of an option that only --help-all lists. (CLI11 has no such groups.)
inline constexpr char kExpertMark = '+';

/// What --help says of an option's value.
struct OptionWords {
  std::string value;                 ///< its name, such as "FILE" or "up|down"; empty for a flag
  bool several = false;              ///< it may be followed by several words
  std::vector<std::string> limits;   ///< "0 to 1", "above 0"
  std::vector<std::string> choices;  ///< the words that it may be; empty: any
  std::string usual;                 ///< the default; "none"; "required"; empty for a flag
};
/// Whether the option takes no value.
[[nodiscard]] bool is_flag(const CLI::Option& option);

[[nodiscard]] OptionWords words_of(const CLI::Option& option);

/// A formatter for a CLI::App and its later subcommands. No line is wider than 100 columns; the
/// limits of an option follow its text in brackets.
/// @param all  also the options of expert groups (--help-all)
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> help_format(bool all = false);

}  // namespace palpable::app
