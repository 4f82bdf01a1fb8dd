/// @file
/// The subcommands of `palpable`: one file each, named after the command. add_x() describes the
/// command's options and stores what to do; the callback throws Error when the world is not as
/// hoped, and main() turns that into one line on stderr and exit code 1.
#pragma once

namespace CLI {
class App;
}

namespace palpable::app {

void add_view(CLI::App& app);
void add_live(CLI::App& app);
void add_scan(CLI::App& app);
void add_inspect(CLI::App& app);
void add_press(CLI::App& app);
void add_synth(CLI::App& app);
void add_score(CLI::App& app);
void add_bench(CLI::App& app);
void add_cameras(CLI::App& app);
void add_calibrate(CLI::App& app);

}  // namespace palpable::app
