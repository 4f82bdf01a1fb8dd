/// @file
/// The command line of both programs: a wrapper of CLI11 that does not include its header, which
/// takes ten seconds to compile. Only command_line.cpp includes it.
///
/// In addition to CLI11: one line per error, exit code 1, and a suggestion for a mistyped word.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpable::app {

/// Types of an option's value. A list takes all words up to the next option, or
/// several occurrences.
template <class T>
concept OptionValue = std::same_as<T, std::string> || std::same_as<T, std::filesystem::path> ||
    std::same_as<T, int> || std::same_as<T, unsigned> || std::same_as<T, double> ||
    std::same_as<T, std::uint64_t> || std::same_as<T, std::optional<double>> ||
    std::same_as<T, std::vector<int>> || std::same_as<T, std::vector<double>> ||
    std::same_as<T, std::vector<std::string>>;

/// One option of a command. A handle: copies refer to the same option, which lives as long as
/// its CommandLine.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  /// The name of the value in --help, instead of TEXT, INT or FLOAT.
  Option type_name(const std::string& name);
  /// Shows the variable's present value as the default in --help.
  Option show_default();
  /// What --help says after "default:" where the default is no value of the option: "the folder's
  /// scene.toml". Without it and without show_default(), --help says "default: none".
  Option default_is(const std::string& words);
  /// Allowed range; both ends are included.
  Option in_range(int least, int most);
  Option in_range(double least, double most);
  Option in_range(std::uint64_t least, std::uint64_t most);
  Option positive();
  Option not_negative();
  Option one_of(const std::vector<std::string>& words);
  Option existing_path();
  Option existing_folder();
  /// Smallest and largest number of words that follow the option.
  Option words(int fewest, int most);
  /// The option takes one word or more. A word after the first belongs to it only if fits(word) is
  /// true; the first that does not fit is an argument of the command, such as BODY in
  /// "--place 0 0 0.6 0 40 0 BODY".
  Option further_words(bool (*fits)(const std::string& word));
  /// Several words may also be one with commas: "--view camera,depth".
  Option split_at_commas();
  /// Both options together are an error.
  Option excludes(const Option& other);
  Option excludes(const std::string& name);

 private:
  CLI::Option* option_;
};

/// Whether a word may be one of several "NAME=VALUE" (Option::further_words).
[[nodiscard]] bool has_equals_sign(const std::string& word);

/// The lengths that an option allows, m. The default allows those above 0.
struct LengthRange {
  double least = 1e-6;
  double most = 1e6;
};

/// A command, or the program itself, to which options and subcommands are added. A
/// handle, like Option.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command add_subcommand(const std::string& name, const std::string& what);
  /// Options and subcommands that are added from now on are listed under this heading.
  void begin_group(const std::string& heading);
  /// The same; only --help-all lists them.
  void begin_expert_group(const std::string& heading);
  /// A call without a subcommand is an error.
  void require_subcommand();

  /// @param names  "-o,--out" for an option, a bare word for a positional argument
  /// @param value  filled when the command line is parsed, before the callback; must live until
  ///               then. A floating-point number must be finite: "nan" and "inf" are rejected
  ///               before the range is checked
  template <OptionValue T>
  Option add_option(const std::string& names, T& value, const std::string& what);
  /// @param read  receives the words after the option; returns an error message, or an empty string
  Option add_option(const std::string& name,
                    std::function<std::string(const std::vector<std::string>&)> read,
                    const std::string& what);
  Option add_flag(const std::string& names, bool& value, const std::string& what);
  /// An option whose value is a length with a unit, such as 7mm; a number without unit is an error.
  /// @param metres  filled when the command line is parsed. Its present value is shown as the
  ///                default, unless it is empty or not above 0
  /// @param range   m; both ends are included
  Option add_length(const std::string& names, std::optional<double>& metres,
                    const std::string& what, LengthRange range = {});
  Option add_length(const std::string& names, double& metres, const std::string& what,
                    LengthRange range = {});
  /// --json: one JSON object on stdout.
  Option add_json(bool& json);

  /// An option from a file.
  struct FileOption {
    std::string name;                ///< without "--"
    std::vector<std::string> words;  ///< of a flag "true" or "false"
    std::string where;               ///< file and line, for messages
  };
  /// Sets options as if they were on the command line; not those that are there, and not those that
  /// an option there excludes. To be called in the command's callback.
  /// @throws Error for an unknown name, for words that the option refuses, and for two options that
  /// exclude each other
  void set_from_file(const std::vector<FileOption>& options);
  struct GivenOption {
    std::string name;  ///< without "--"
    std::vector<std::string> words;
    bool is_flag = false;
  };
  /// The options that were given on the command line or by set_from_file(), in the order of their
  /// declaration; without positional ones and those of every command. To be called in the command's
  /// callback.
  [[nodiscard]] std::vector<GivenOption> given_options() const;

  /// The text at the end of --help.
  void footer(const std::string& text);
  /// The function of the command, called after its options are read.
  void callback(std::function<void()> run);

 protected:
  [[nodiscard]] CLI::App& app() const { return *app_; }

 private:
  Option placed(CLI::Option* option);
  Option add_length(const std::string& names, const std::function<void(double)>& set,
                    double present, const std::string& what, LengthRange range);
  static void set_from_file(CLI::Option& option, const FileOption& from);

  CLI::App* app_;
  std::string group_ = {};  // heading of the options that follow; empty: "Options"
};

/// A whole program: the top command with --help and --version.
class CommandLine : public Command {
 public:
  /// @param version  the text of --version
  CommandLine(const std::string& what, const std::string& name, const std::string& version);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// Parses the arguments and runs the callback of the chosen subcommand. Prints an error as one
  /// line "palpable: ..." on stderr.
  ///
  /// @return the program's exit code: 0, or 1 after any error (CLI11's own codes are not used)
  int run(int argc, const char* const* argv);

  /// All commands and options as declared, from which tools/command_reference.py makes
  /// docs/commands.md, the man pages and the completion of shells:
  ///
  ///     {"name", "what", "footer", "commands": [
  ///       {"name", "what", "usage", "footer", "options": [
  ///         {"names": [], "value", "several", "positional", "required", "default", "choices": [],
  ///          "what", "heading", "expert"}]}]}
  [[nodiscard]] std::string reference_json() const;

 private:
  explicit CommandLine(std::unique_ptr<CLI::App> app);

  std::unique_ptr<CLI::App> owned_;
};

/// The arguments of a benchmark program, which is started by `palpable` as `palpable bench NAME
/// ...` or directly as `palpable-bench NAME ...`. Its --help shows the command as it was typed.
struct BenchCall {
  BenchCall(int count, char** words);
  std::string name;  ///< "palpable bench", or the program's name
  int argc;          ///< without the word bench
  char** argv;
};

/// Prints "palpable: <message>" on stderr, line breaks replaced by "; ".
void print_error(std::string_view message);

/// An option as older versions spelled it.
struct OldSpelling {
  std::string_view command;  ///< "live"; empty: of every command
  std::string_view option;   ///< "--output"
  std::string_view now;      ///< what to write instead: "--out"
};

/// The spellings of 0.1 that a later version refuses. An option that is unknown and stands here is
/// refused with its new name.
[[nodiscard]] std::span<const OldSpelling> old_spellings();

/// "7mm", "1.2m": the shortest text that reads back as this length.
[[nodiscard]] std::string length_text(double metres);

/// Parses "1280x720": two whole numbers from 1 to kLongestSide; empty for any other text.
inline constexpr int kLongestSide = 1'000'000;
[[nodiscard]] std::optional<std::array<int, 2>> parse_extent(std::string_view text);

/// Adds --threads N; 0, the default, is one for each core.
Option add_threads(Command command, int& threads, const std::string& what);

/// Adds --set NAME=VALUE, which may be given once for each parameter beyond site and level.
void add_set_option(Command command, std::vector<std::string>& texts);

}  // namespace palpable::app
