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
  /// Both options together are an error.
  Option excludes(const Option& other);
  Option excludes(const std::string& name);

 private:
  CLI::Option* option_;
};

/// A command, or the program itself, to which options and subcommands are added. A
/// handle, like Option.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command add_subcommand(const std::string& name, const std::string& what);
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

  /// The text at the end of --help.
  void footer(const std::string& text);
  /// The function of the command, called after its options are read.
  void callback(std::function<void()> run);

 protected:
  [[nodiscard]] CLI::App& app() const { return *app_; }

 private:
  CLI::App* app_;
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

 private:
  explicit CommandLine(std::unique_ptr<CLI::App> app);

  std::unique_ptr<CLI::App> owned_;
};

/// The arguments of a benchmark program, which is started by `palpable` as `palpable bench NAME
/// ...` or directly as `palpable-bench NAME ...`. Its --help shows the command as it was typed.
struct BenchCall {
  BenchCall(int argc, char** argv);
  std::string name;  ///< "palpable bench", or the program's name
  int argc;          ///< without the word bench
  char** argv;
};

/// Prints "palpable: <message>" on stderr, line breaks replaced by "; ".
void print_error(std::string_view message);

/// Parses "1280x720": two whole numbers from 1 to kLongestSide; empty for any other text.
inline constexpr int kLongestSide = 1'000'000;
[[nodiscard]] std::optional<std::array<int, 2>> parse_extent(std::string_view text);

/// Adds --set NAME=VALUE, which may be given once for each parameter beyond site and level.
void add_set_option(Command command, std::vector<std::string>& texts);

}  // namespace palpable::app
