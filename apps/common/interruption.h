/// @file
/// What a program says when the user ends it.
#pragma once

#include <string>

namespace palpable::app {

/// While it lives, the end of the program by SIGINT (Ctrl-C), SIGTERM or SIGHUP prints a line
/// "palpable: ..." on stderr first; then the signal ends the program as it would have anyway. A
/// signal that is ignored, as under nohup, stays ignored. There is one at a time.
class InterruptionNote {
 public:
  /// @param line     without "palpable: "; empty: nothing is printed
  /// @param removed  a file that is removed then; empty: none
  explicit InterruptionNote(const std::string& line, const std::string& removed = {});
  InterruptionNote(const InterruptionNote&) = delete;
  InterruptionNote& operator=(const InterruptionNote&) = delete;
  ~InterruptionNote();
};

/// The words of a command line as they can be typed into a shell again: those with blanks or other
/// characters that mean something to a shell are quoted.
[[nodiscard]] std::string quoted_for_shell(const std::string& word);

}  // namespace palpable::app
