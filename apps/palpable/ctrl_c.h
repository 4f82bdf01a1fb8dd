/// @file
/// Ctrl-C, or closing the terminal, ends a long run in an orderly way: all its files are complete.
#pragma once

namespace palpable::app {

/// Installs handlers: the first SIGINT or SIGTERM only sets the flag of asked_to_end(), a second
/// one of the same kind ends the program at once. SIGHUP sets the flag however often it comes (a
/// shell whose terminal is closed sends a second one), and is ignored under nohup.
void listen_for_ctrl_c();

/// Whether one of these signals has come.
[[nodiscard]] bool asked_to_end();

}  // namespace palpable::app
