/// @file
/// A program's standard input, output and errors, as whoever starts it may leave them.
#pragma once

#include <string>

namespace palpable {

/// To be called before any file is opened. Opens /dev/null in place of those that are closed
/// (">&-"): the next file that is opened would get their number, and what is printed would go into
/// that file. A file that grows beyond the limit of the shell (ulimit -f) fails from now on as one
/// on a full disk does, instead of ending the program in the middle of it.
void prepare_standard_streams();

/// Flushes what was printed. A table on its way into a file on a full disk is lost otherwise,
/// without a word.
/// @return why it cannot be written; empty if it was
[[nodiscard]] std::string flush_standard_output();

}  // namespace palpable
