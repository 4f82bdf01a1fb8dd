/// @file
/// Guards against standard streams that are closed or cannot be written when the program starts.
#pragma once

#include <string>

namespace palpable {

/// To be called before any file is opened. Opens /dev/null in place of standard streams that are
/// closed (">&-"): otherwise the next file that is opened would get their number, and printed text
/// would go into that file. After the call, writing beyond the shell's limit for files (ulimit -f)
/// fails with an error, as on a full disk, instead of ending the program.
void prepare_standard_streams();

/// Flushes standard output. Without it, output redirected to a file on a full disk would be lost
/// without an error.
/// @return why the output cannot be written; empty if it was written
[[nodiscard]] std::string flush_standard_output();

}  // namespace palpable
