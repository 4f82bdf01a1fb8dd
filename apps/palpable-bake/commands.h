/// @file
/// The subcommands of `palpable-bake`, one file each, named after the command. add_x() declares the
/// command's options and its callback. Callbacks throw Error; main() prints it as one line on
/// stderr and exits with code 1.
#pragma once

#include <string>

namespace palpable {
class Crew;
}

namespace palpable::app {

class Command;

void add_about(Command app);
void add_mesh(Command app);
/// @param command_line  as typed, for the provenance
/// @param crew          must outlive the app
void add_bake(Command app, const std::string& command_line, Crew& crew);
void add_merge(Command app);
void add_import_snapshots(Command app);
void add_reduce(Command app, const std::string& command_line);
void add_report(Command app);
void add_compare(Command app, const std::string& command_line);
void add_solve(Command app);
void add_truth(Command app);
void add_refine(Command app);
void add_export(Command app);
void add_import_modes(Command app, const std::string& command_line);
void add_reproduce(Command app);

}  // namespace palpable::app
