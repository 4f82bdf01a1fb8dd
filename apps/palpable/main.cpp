// palpable: the user's command. Baking is in a second program, palpable-bake, which is started from
// here, so that no mesher and no sparse solver is linked into this one. The benchmarks are separate
// programs, too, which users need not compile.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
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
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>

namespace palpable::app {
namespace {

// A command of palpable-bake, for the list in --help.
struct BakeCommand {
  const char* name;
  const char* what;
};
constexpr std::array kBakeCommands{
    BakeCommand{"bake", "Mesh, solve and reduce: a body file from a description"},
    BakeCommand{"mesh", "Fill a watertight surface with tetrahedra"},
    BakeCommand{"merge", "Collect snapshots of one campaign that were solved apart"},
    BakeCommand{"reduce", "Make a body file from snapshots"},
    BakeCommand{"report", "Write errors, costs and modes of a body file as a page"},
    BakeCommand{"compare", "Put all methods of reduction on one chart of errors"},
    BakeCommand{"solve", "Press a body at one site and write it for ParaView"},
};
constexpr std::array kExchangeCommands{
    BakeCommand{"import-modes", "Make a body file from another program's modes"},
    BakeCommand{"import-snapshots", "Take over what another solver has computed"},
};
constexpr std::array kEvaluateCommands{
    BakeCommand{"truth", "The full-order solution for the true hand of a synthetic clip"},
    BakeCommand{"reproduce", "The paper's examples and figures beside its own numbers, as a page"},
};

constexpr const char* kFirstSteps =
    R"(Palpable: virtual deformable bodies that real things press, seen by a stereo camera.

  palpable live                       play the built-in desk with the body that ships
  palpable doctor                     what this machine has and lacks, and what to do about it
  palpable cameras                    the cameras that are plugged in, and how to use them
  palpable live post --source /dev/video0 --anchor plane
                                      press a body on your own desk
  palpable bake BODY.toml -o BODY.palpable
                                      make a body of your own; --estimate: how long that takes
  palpable help                       all commands; palpable help live explains one
)";

// The names of `palpable bench` that belong to the offline half.
constexpr std::array<std::string_view, 11> kBakeBenches{
    "beam",     "bodies",   "campaign", "clip",  "dynamics", "elements",
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
  const auto is_verbose = [](std::string_view word) { return word == "-v" || word == "--verbose"; };
  if (std::none_of(argv, argv + argc, is_verbose)) {
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    ::setenv("OPENCV_LOG_LEVEL", "SILENT", 0);
  }

  if (argc == 1) {
    print_text("{}", kFirstSteps);
    return 0;
  }
  // `help bake` is `bake --help`, also of commands of the other programs.
  char help[] = "--help";
  const bool explains = argc > 2 && std::string_view(argv[1]) == "help" && argv[2][0] != '-';
  std::array<char*, 4> explained{argv[0], argc > 2 ? argv[2] : nullptr, help, nullptr};
  if (explains) {
    argc = 3;
    argv = explained.data();
  }

  CommandLine app("Virtual deformable bodies that real things press, seen by a stereo camera.",
                  "palpable", std::string("palpable ") + PALPABLE_VERSION);
  app.require_subcommand();
  app.footer(
      "Each command explains itself: palpable help live, or palpable live --help\n"
      "Example: palpable live\n"
      "Example: palpable view bunny.palpable");

  const std::span<char* const> words(argv, static_cast<std::size_t>(argc));
  // `export` is palpable-bake's, but for the formats that need no bake half.
  bool bakes = std::string_view(argv[1]) == "export" && !asks_for_web(words);
  const auto list = [&](std::span<const BakeCommand> commands) {
    for (const BakeCommand& command : commands) {
      bakes = bakes || std::string_view(argv[1]) == command.name;
      app.add_subcommand(command.name, command.what);
    }
  };
  app.begin_group("Play");
  add_live(app);
  add_replay(app);
  add_scan(app);
  add_view(app);
  add_press(app);
  add_inspect(app);
  app.begin_group("Set up");
  add_doctor(app);
  add_cameras(app);
  add_calibrate(app);
  app.begin_group("Bake");
  list(kBakeCommands);
  app.begin_group("Exchange");
  add_export(app);
  add_serve(app);
  list(kExchangeCommands);
  add_hands(app);
  app.begin_group("Evaluate");
  add_synth(app);
  add_score(app);
  list(kEvaluateCommands);
  app.add_subcommand("bench", "Time the stages of the live half, or of a bake");
  if (bakes) return become(kBakeProgram, argv);
  if (std::string_view(argv[1]) == "bench") return become(program_of_bench(argc, argv), argv);
  return app.run(argc, argv);
}

}  // namespace
}  // namespace palpable::app

int main(int argc, char** argv) { return palpable::app::run(argc, argv); }
