/// @file
/// What commands print: results on stdout, everything else on stderr.
#pragma once

#include "palpable/common/base/json.h"

#include <fmt/core.h>

#include <string_view>
#include <utility>

namespace palpable::app {

/// How much a program prints beside its results: the options -q and -v of all commands.
enum class Verbosity {
  kQuiet,    ///< errors and warnings only: no progress, no notes
  kNormal,   ///< progress and notes
  kVerbose,  ///< also time and memory at the end, and what video libraries report
};
[[nodiscard]] Verbosity verbosity();
void set_verbosity(Verbosity verbosity);

/// Prints a result as text: on stdout, or on stderr when the user wants JSON on stdout.
void print_text(std::string_view text);
template <class... Values>
void print_text(fmt::format_string<Values...> format, Values&&... values) {
  print_text(std::string_view(fmt::format(format, std::forward<Values>(values)...)));
}

/// The option --json was given: stdout is for print_json() alone.
void reserve_stdout_for_json();

/// Prints a result as JSON on stdout, indented by two spaces.
void print_json(const Json& result);

/// Prints a line on stderr, unless the user wants quiet. Failures to print are ignored.
void print_note(std::string_view line);
template <class... Values>
void print_note(fmt::format_string<Values...> format, Values&&... values) {
  print_note(std::string_view(fmt::format(format, std::forward<Values>(values)...)));
}

}  // namespace palpable::app
