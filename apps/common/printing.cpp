#include "apps/common/printing.h"

#include <cstdio>

namespace palpable::app {
namespace {

Verbosity present = Verbosity::kNormal;
bool stdout_is_for_json = false;

}  // namespace

Verbosity verbosity() { return present; }

void set_verbosity(Verbosity verbosity) { present = verbosity; }

void reserve_stdout_for_json() { stdout_is_for_json = true; }

void print_text(std::string_view text) {
  if (stdout_is_for_json) {
    if (present != Verbosity::kQuiet) fmt::print(stderr, "{}", text);
  } else {
    fmt::print("{}", text);
  }
}

void print_json(const Json& result) { fmt::print("{}\n", result.dump(2)); }

// Not fmt::print(), which throws when the terminal was closed.
void print_note(std::string_view line) {
  if (present == Verbosity::kQuiet) return;
  std::fputs(fmt::format("{}\n", line).c_str(), stderr);
}

}  // namespace palpable::app
