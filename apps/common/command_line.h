/// @file
/// What both programs do around CLI11: one line per error, exit code 1, a guess for a mistyped
/// word.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace palpable::app {

/// Parses, runs the chosen subcommand's callback, and says what went wrong in one line
/// "palpable: ..." on stderr.
///
/// @return the program's exit code: 0, or 1 after any error (CLI11's own codes are not passed on)
int run_command_line(CLI::App& app, int argc, const char* const* argv);

/// Prints "palpable: <message>" on stderr, line breaks replaced by "; ".
void print_error(std::string_view message);

/// "ears=0.5" each. @throws Error for another form, which says that it must be a parameter and
/// `what`
/// @param option  after which they stood
[[nodiscard]] std::map<std::string, double> parse_settings(
    const std::vector<std::string>& texts, std::string_view option = "--set",
    std::string_view what = "its value, such as stiffness=2");

/// --set NAME=VALUE, as often as there are parameters beyond site and level.
void add_set_option(CLI::App& command, std::vector<std::string>& texts);

}  // namespace palpable::app
