/// @file
/// What both programs do around CLI11: one line per error, exit code 1, a guess for a mistyped
/// word.
#pragma once

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

/// The candidate that needs the fewest edits (insert, drop, change or swap of letters) to become
/// `word`; empty when none is near enough to be what was meant (a third of the letters).
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& candidates);

/// Prints "palpable: <message>" on stderr, line breaks replaced by "; ".
void print_error(std::string_view message);

}  // namespace palpable::app
