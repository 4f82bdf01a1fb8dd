/// @file
/// Ctrl-C ends a long run in an orderly way: all its files are complete. So does closing its
/// terminal.
#pragma once

namespace palpable::app {

/// From now on the first SIGINT or SIGTERM is only noted, for asked_to_end(); a second one of the
/// same kind ends the program at once. SIGHUP is noted however often it comes (a shell whose
/// terminal is closed passes on a second one), and not even that under nohup.
void listen_for_ctrl_c();

/// Whether the user has sent one.
[[nodiscard]] bool asked_to_end();

}  // namespace palpable::app
