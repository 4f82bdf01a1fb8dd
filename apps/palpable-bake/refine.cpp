// palpable-bake refine BODY.toml: the process that `palpable live --refine` starts and
// exchanges messages with.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/bake/pipeline/solution_service.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <unistd.h>

namespace palpable::app {
namespace {

struct RefineOptions {
  std::string description;
  std::string body;  // empty: it is not compared
  bool check = false;
};

// Prints what is wrong with the description, in a line on stdout, where the live program reads it.
void check(const RefineOptions& options) {
  const std::string& description = options.description;
  try {
    const BodyDescription read = read_body_description(description);
    const std::filesystem::path& shape = read.shape.file;
    if (!shape.empty() && !std::filesystem::is_regular_file(shape)) {
      print_text("{}: no such file, and {} names it\n", shape.string(), description);
      return;
    }
    if (options.body.empty()) return;
    const ReducedBody body = value_or_throw(read_body_file(options.body));
    const std::string why = other_body_text(read, body);
    if (!why.empty()) print_text("{}: {}\n", description, why);
  } catch (const Error& error) { print_text("{}\n", error.what()); }
}

void refine(const RefineOptions& options) {
  const std::string& description = options.description;
  if (options.check) {
    check(options);
    return;
  }
  if (::isatty(STDIN_FILENO) != 0) {
    throw Error("refine is started by 'palpable live BODY --refine " + description + "'");
  }
  // It ends when the run ends, not by the user's Ctrl-C, and runs at low priority.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGPIPE, SIG_IGN);
  (void)!::nice(5);
  // Output of libraries must not mix with the messages on stdout.
  const int out = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  if (!serve_full_solutions([&] { return exact_body(read_description(description)); }, STDIN_FILENO,
                            out)) {
    throw Error("refine: what came is no load of " + description);
  }
}

}  // namespace

void add_refine(Command app) {
  const auto options = std::make_shared<RefineOptions>();
  Command command = app.add_subcommand(
      "refine", "Full-order solutions of loads, for 'palpable live --refine', which starts it");
  add_description(command, options->description);
  command.add_flag("--check-description", options->check,
                   "Only print what is wrong with the description, or nothing");
  command
      .add_option("--of", options->body,
                  "With --check-description: the body file that the description must be of")
      .type_name("FILE.palpable")
      .default_is("it is not compared");
  command.footer(
      "Loads come on standard input, solutions go to standard output, in binary\n"
      "(src/palpable/common/response/solution_messages.h).\n"
      "Example: palpable live bunny.palpable --refine bodies/bunny-demo.toml --source synthetic "
      "--out out");
  command.callback([options] { refine(*options); });
}

}  // namespace palpable::app
