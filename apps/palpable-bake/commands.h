/// @file
/// The subcommands of `palpable-bake`: one file each, named after the command. add_x() describes
/// the command's options and stores what to do; the callback throws Error when the world is not as
/// hoped, and main() turns that into one line on stderr and exit code 1.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace palpable {
class Crew;
}

namespace palpable::app {

void add_mesh(CLI::App& app);
/// @param command_line  as typed, for the provenance
/// @param crew          outlives the app
void add_bake(CLI::App& app, const std::string& command_line, Crew& crew);
void add_merge(CLI::App& app);
void add_import_snapshots(CLI::App& app);
void add_reduce(CLI::App& app, const std::string& command_line);
void add_report(CLI::App& app);
void add_compare(CLI::App& app, const std::string& command_line);
void add_solve(CLI::App& app);
void add_export(CLI::App& app);
void add_import_modes(CLI::App& app, const std::string& command_line);
void add_bench(CLI::App& app);

}  // namespace palpable::app
