// palpable: the user's command. Baking is in a second program, palpable-bake, which is started from
// here, so that no mesher and no sparse solver is linked into this one. The benchmarks are separate
// programs, too, which users need not compile.

#include "apps/common/command_line.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <unistd.h>

namespace palpable::app {
namespace {

struct BakeCommand {
  const char* name;
  const char* what;
};

constexpr std::array kBakeCommands{
    BakeCommand{"mesh", "Fill a watertight surface with tetrahedra"},
    BakeCommand{"bake", "Mesh, solve and reduce: a body file from a description"},
    BakeCommand{"merge", "Collect snapshots of one campaign that were solved apart"},
    BakeCommand{"import-snapshots", "Take over what another solver has computed"},
    BakeCommand{"reduce", "Make a body file from snapshots"},
    BakeCommand{"report", "Write errors, costs and modes of a body file as a page"},
    BakeCommand{"compare", "Put all methods of reduction on one chart of errors"},
    BakeCommand{"solve", "Press a body at one site and write it for ParaView"},
    BakeCommand{"truth", "The full-order solution for the true hand of a synthetic clip"},
    BakeCommand{"export", "Write a body or its snapshots for other programs"},
    BakeCommand{"import-modes", "Make a body file from another program's modes"},
    BakeCommand{"reproduce", "The paper's examples and figures beside its own numbers, as a page"},
};

// The names of `palpable bench` that belong to the offline half.
constexpr std::array<std::string_view, 10> kBakeBenches{
    "beam",     "bodies",   "campaign", "clip",  "elements",
    "friction", "obstacle", "reduce",   "solid", "touch"};

/// Replaces this process by another program of the project with the same arguments. Returns
/// only on failure.
int become(const char* name, char** argv) {
  try {
    const std::filesystem::path program = sibling_program(name);
    ::execv(program.c_str(), argv);
    print_error(fmt::format(
        "'{}' needs the program {}: {}; {}build it (cmake --build --preset release "
        "--target {}), or copy it there",
        argv[1], program.string(), std::strerror(errno),
        std::string_view(name) == kBakeProgram ? "install the package palpable-bake, " : "", name));
  } catch (const Error& error) { print_error(error.what()); }
  return 1;
}

// The program that has the requested benchmark; without a name, the one that lists all of them.
const char* program_of_bench(int argc, char** argv) {
  const bool bakes = argc > 2 && std::find(kBakeBenches.begin(), kBakeBenches.end(), argv[2]) !=
                                     kBakeBenches.end();
  return bakes ? kBakeBenchProgram : kBenchProgram;
}

int run(int argc, char** argv) {
  // Suppresses messages of image and video libraries about codecs.
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  ::setenv("OPENCV_LOG_LEVEL", "SILENT", 0);

  CommandLine app("Virtual deformable bodies that real hands press, seen by a stereo camera.",
                  "palpable", std::string("palpable ") + PALPABLE_VERSION);
  app.require_subcommand();
  app.footer(
      "Each command explains itself: palpable live --help\n"
      "Example: palpable view bunny.palpable");

  for (const BakeCommand& command : kBakeCommands) {
    if (argc > 1 && std::string(argv[1]) == command.name) return become(kBakeProgram, argv);
    app.add_subcommand(command.name, command.what);
  }
  if (argc > 1 && std::string(argv[1]) == "bench")
    return become(program_of_bench(argc, argv), argv);
  add_view(app);
  add_live(app);
  add_replay(app);
  add_scan(app);
  add_inspect(app);
  add_press(app);
  add_synth(app);
  add_score(app);
  add_cameras(app);
  add_calibrate(app);
  app.add_subcommand("bench", "Time the stages of the live half, or of a bake");
  return app.run(argc, argv);
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) { return palpable::app::run(argc, argv); }
