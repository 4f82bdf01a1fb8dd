// palpable: one command for the user. What bakes lives in a second program, palpable-bake, which
// is started from here, so that nothing of a mesher or a sparse factor is linked into this one.

#include "apps/common/command_line.h"
#include "apps/palpable/bake_program.h"
#include "apps/palpable/commands.h"
#include "palpable/base/error.h"

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
    BakeCommand{"truth", "The full finite-element answer to the true hand of a filmed clip"},
    BakeCommand{"export", "Write a body or its snapshots for other programs"},
    BakeCommand{"import-modes", "Make a body file from another program's modes"},
    BakeCommand{"reproduce", "The paper's examples and figures beside its own numbers, as a page"},
};

// Of `palpable bench`, those that palpable-bake has.
constexpr std::array<std::string_view, 11> kBakeBenches{
    "bake",     "beam",     "bodies", "campaign", "clip", "elements",
    "friction", "obstacle", "reduce", "solid",    "touch"};

/// Becomes palpable-bake with the same arguments; returns only when that cannot be.
int become_bake(char** argv) {
  try {
    const std::filesystem::path program = bake_program();
    ::execv(program.c_str(), argv);
    print_error(
        fmt::format("'{}' needs the program {}: {}; install the package palpable-bake, or build it",
                    argv[1], program.string(), std::strerror(errno)));
  } catch (const Error& error) { print_error(error.what()); }
  return 1;
}

int run(int argc, char** argv) {
  // The chatter of image and video readers about codecs is no message of ours.
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  ::setenv("OPENCV_LOG_LEVEL", "SILENT", 0);

  CommandLine app("Virtual deformable bodies that real hands press, seen by a stereo camera.",
                  "palpable", std::string("palpable ") + PALPABLE_VERSION);
  app.require_subcommand();
  app.footer(
      "Each command explains itself: palpable live --help\n"
      "Example: palpable view bunny.palpable");

  for (const BakeCommand& command : kBakeCommands) {
    if (argc > 1 && std::string(argv[1]) == command.name) return become_bake(argv);
    app.add_subcommand(command.name, command.what);
  }
  if (argc > 2 && std::string(argv[1]) == "bench" &&
      std::find(kBakeBenches.begin(), kBakeBenches.end(), argv[2]) != kBakeBenches.end()) {
    return become_bake(argv);
  }
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
  add_bench(app);
  return app.run(argc, argv);
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) { return palpable::app::run(argc, argv); }
