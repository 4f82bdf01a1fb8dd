// palpable-bake: the offline half. Users start it through `palpable mesh` and `palpable bake`.

#include "apps/common/command_line.h"
#include "apps/common/interruption.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/processor_kernels.h"
#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/ranks/mpi_crew.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable::app {
namespace {

int run(int argc, char** argv) {
  std::optional<MpiCrew> ranks;
  LocalCrew threads;
  if (MpiCrew::is_launched()) {
    ranks.emplace(&argc, &argv);
    if (argc < 2 || std::string(argv[1]) != "bake") {
      print_error("mpirun is for 'palpable bake': start other commands without it");
      ranks->end(true);
    }
  }
  Crew& crew = ranks ? static_cast<Crew&>(*ranks) : threads;
  // The name by which it was called, `palpable` or `palpable-bake`, so that commands in --help and
  // in the provenance can be typed again.
  const std::string name = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "";
  CommandLine app("The offline half of Palpable: meshes, solves and reduces a body into a file.",
                  name, std::string("palpable-bake ") + PALPABLE_VERSION);
  app.require_subcommand();
  app.footer(
      "Each command explains itself: palpable bake --help\n"
      "Example: palpable bake bodies/bunny-demo.toml -o bunny.palpable");
  std::string command_line = name;
  for (int i = 1; i < argc; ++i) command_line += " " + quoted_for_shell(argv[i]);

  add_mesh(app);
  add_bake(app, command_line, crew);
  add_merge(app);
  add_import_snapshots(app);
  add_reduce(app, command_line);
  add_report(app);
  add_compare(app, command_line);
  add_solve(app);
  add_truth(app);
  add_refine(app);
  add_export(app);
  add_import_modes(app, command_line);
  add_reproduce(app);
  add_about(app);
  const int code = app.run(argc, argv);
  if (ranks) ranks->end(code != 0);
  return code;
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) {
  palpable::app::use_kernels_of_this_processor(argv);
  return palpable::app::run(argc, argv);
}
