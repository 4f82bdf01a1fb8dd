// palpable-bake refine BODY.toml: the process that `palpable live --refine` starts and
// exchanges messages with.

#include "apps/common/command_line.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/bake/pipeline/solution_service.h"
#include "palpable/common/base/error.h"

#include <csignal>
#include <memory>
#include <string>
#include <unistd.h>

namespace palpable::app {
namespace {

void refine(const std::string& description) {
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
  const auto description = std::make_shared<std::string>();
  Command command = app.add_subcommand(
      "refine", "Full-order solutions of loads, for 'palpable live --refine', which starts it");
  add_description(command, *description);
  command.footer(
      "Loads come on standard input, solutions go to standard output, in binary\n"
      "(src/palpable/common/response/solution_messages.h).\n"
      "Example: palpable live bunny.palpable --refine bodies/bunny-demo.toml --source synthetic "
      "--out out");
  command.callback([description] { refine(*description); });
}

}  // namespace palpable::app
