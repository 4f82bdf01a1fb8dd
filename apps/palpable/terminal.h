/// @file
/// How long commands speak to their user: Ctrl-C, lines and progress, pictures that are saved from
/// a window.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/play/live_play.h"

#include <filesystem>
#include <string>

namespace palpable::app {

class ProgressBar;

/// Installs handlers, so that Ctrl-C, or closing the terminal, ends a long run in an orderly way,
/// with all its files complete: the first SIGINT or SIGTERM only sets the flag of asked_to_end(), a
/// second one of the same kind ends the program at once. SIGHUP sets the flag however often it
/// comes (a shell whose terminal is closed sends a second one), and is ignored under nohup.
void listen_for_ctrl_c();

/// Whether one of these signals has come.
[[nodiscard]] bool asked_to_end();

/// Whether there is a screen on which a window can open.
[[nodiscard]] bool has_screen();

/// Writes a picture to the current folder as STEM_WHAT_N.png, where STEM is the body file's
/// name without extension and N the first unused number. A failure is printed, as it must not
/// close the window.
/// @return a line for the user: the file's name, or why there is none
[[nodiscard]] std::string keep_picture(const std::filesystem::path& body, const std::string& what,
                                       const ColorImage& picture);

/// The user of a run in a terminal: results on stdout, messages and progress on stderr.
/// @param bar  must outlive the run
[[nodiscard]] PlayUser user_at(ProgressBar& bar);

}  // namespace palpable::app
