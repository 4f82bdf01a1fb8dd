/// @file
/// The subcommands of `palpable`, one file each, named after the command. add_x() declares the
/// command's options and its callback. Callbacks throw Error; main() prints it as one line on
/// stderr and exits with code 1.
#pragma once

#include <span>
#include <string>

namespace palpable {
struct ListedCamera;
}

namespace palpable::app {

class Command;

void add_view(Command app);
void add_live(Command app);
void add_replay(Command app);
void add_scan(Command app);
void add_inspect(Command app);
void add_press(Command app);
void add_synth(Command app);
void add_score(Command app);
void add_cameras(Command app);
void add_calibrate(Command app);
void add_doctor(Command app);
void add_hands(Command app);
/// `export --to web` and `--to page`; palpable-bake has the other formats.
void add_export(Command app);
/// Whether the words of a command line hold "--to web" or "--to page".
[[nodiscard]] bool asks_for_web(std::span<char* const> words);
void add_serve(Command app);

/// The commands with which a connected camera is used in this program, as lines to follow
/// text_of(camera); empty if it cannot be used.
[[nodiscard]] std::string use_of(const ListedCamera& camera);

}  // namespace palpable::app
