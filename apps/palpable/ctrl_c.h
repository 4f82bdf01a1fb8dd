/// @file
/// Ctrl-C ends a long run as its last frame would, with all its files.
#pragma once

namespace palpable::app {

/// From now on SIGINT and SIGTERM are heard once; a second one ends the program at once.
void listen_for_ctrl_c();

/// Whether one came.
[[nodiscard]] bool asked_to_end();

}  // namespace palpable::app
