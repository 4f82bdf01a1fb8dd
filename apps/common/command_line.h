/// @file
/// The command line of both programs: what CLI11 offers them, without its header, which takes ten
/// seconds to compile. Only command_line.cpp includes it.
///
/// On top of CLI11: one line per error, exit code 1, a guess for a mistyped word.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
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

/// What an option can fill. A list takes all words up to the next option, or several mentions.
template <class T>
concept OptionValue = std::same_as<T, std::string> || std::same_as<T, std::filesystem::path> ||
    std::same_as<T, int> || std::same_as<T, unsigned> || std::same_as<T, double> ||
    std::same_as<T, std::uint64_t> || std::same_as<T, std::optional<double>> ||
    std::same_as<T, std::vector<int>> || std::same_as<T, std::vector<double>> ||
    std::same_as<T, std::vector<std::string>>;

/// One option of a command. A handle: copies mean the same option, which lives as long as its
/// CommandLine does.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  /// What --help says instead of TEXT, INT or FLOAT.
  Option type_name(const std::string& name);
  /// --help shows the value that the variable holds now.
  Option show_default();
  /// Both ends are allowed.
  Option in_range(int least, int most);
  Option in_range(double least, double most);
  Option in_range(std::uint64_t least, std::uint64_t most);
  Option positive();
  Option not_negative();
  Option one_of(const std::vector<std::string>& words);
  Option existing_path();
  Option existing_folder();
  /// How many words follow it.
  Option words(int fewest, int most);
  /// Refused together with `other`.
  Option excludes(const Option& other);
  Option excludes(const std::string& name);

 private:
  CLI::Option* option_;
};

/// A command, or the program itself: options and subcommands are added to it. A handle, as Option
/// is.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command add_subcommand(const std::string& name, const std::string& what);
  /// One of the subcommands has to be named.
  void require_subcommand();

  /// @param names  "-o,--out" for an option, a bare word for an argument known by its position
  /// A floating-point number has to be finite: "nan" and "inf" are refused before any range is
  /// looked at.
  /// @param value  filled when the command line is parsed, before the callback; has to live until
  ///               then
  template <OptionValue T>
  Option add_option(const std::string& names, T& value, const std::string& what);
  /// @param read  gets the words that follow the option; returns why they are refused, else nothing
  Option add_option(const std::string& name,
                    std::function<std::string(const std::vector<std::string>&)> read,
                    const std::string& what);
  Option add_flag(const std::string& names, bool& value, const std::string& what);

  /// What --help ends with.
  void footer(const std::string& text);
  /// What the command does, once its options are read.
  void callback(std::function<void()> run);

 protected:
  [[nodiscard]] CLI::App& app() const { return *app_; }

 private:
  CLI::App* app_;
};

/// A whole program: the top command, with --help and --version.
class CommandLine : public Command {
 public:
  /// @param version  what --version prints
  CommandLine(const std::string& what, const std::string& name, const std::string& version);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;
  ~CommandLine();

  /// Parses, runs the chosen subcommand's callback, and says what went wrong in one line
  /// "palpable: ..." on stderr.
  ///
  /// @return the program's exit code: 0, or 1 after any error (CLI11's own codes are not passed on)
  int run(int argc, const char* const* argv);

 private:
  explicit CommandLine(std::unique_ptr<CLI::App> app);

  std::unique_ptr<CLI::App> owned_;
};

/// The arguments of a program of benches, which is started as `palpable bench NAME ...` by
/// `palpable` or by itself, as `palpable-bench NAME ...`: its --help says what can be typed again.
struct BenchCall {
  BenchCall(int argc, char** argv);
  std::string name;  ///< "palpable bench", or that of the program
  int argc;          ///< without the word bench
  char** argv;
};

/// Prints "palpable: <message>" on stderr, line breaks replaced by "; ".
void print_error(std::string_view message);

/// "ears=0.5" each, a finite number. @throws Error for another form, which says that it must be a
/// parameter and `what`
/// @param option  after which they stood
[[nodiscard]] std::map<std::string, double> parse_settings(
    const std::vector<std::string>& texts, std::string_view option = "--set",
    std::string_view what = "its value, such as stiffness=2");

/// The two of "1280x720": whole numbers from 1 to kLongestSide; nothing for another text.
inline constexpr int kLongestSide = 1'000'000;
[[nodiscard]] std::optional<std::array<int, 2>> parse_extent(std::string_view text);

/// --set NAME=VALUE, as often as there are parameters beyond site and level.
void add_set_option(Command command, std::vector<std::string>& texts);

}  // namespace palpable::app
