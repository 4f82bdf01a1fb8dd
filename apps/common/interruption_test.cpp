#include "apps/common/interruption.h"

#include "tests/support/test.h"

#include <csignal>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable::app {
namespace {

TEST_CASE("a word is quoted where a shell would take it apart", "[apps]") {
  for (const char* plain : {"bake", "-o", "a/b.palpable", "--set=ears=0.5", "\xc3\xa4.toml"}) {
    CHECK(quoted_for_shell(plain) == plain);
  }
  CHECK(quoted_for_shell("") == "''");
  CHECK(quoted_for_shell("my body.toml") == "'my body.toml'");
  CHECK(quoted_for_shell("$(x)") == "'$(x)'");
  CHECK(quoted_for_shell("it's") == "'it'\\''s'");
}

// Ends a child process by a signal, under the note or after it. Returns what it has printed on
// stderr; `status` receives how it ended.
std::string printed_at_end(int signal, bool under_note, int& status) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDERR_FILENO);
    {
      const InterruptionNote note("the same command goes on");
      if (under_note) ::raise(signal);
    }
    ::raise(signal);
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string text(1000, '\0');
  const ssize_t count = ::read(ends[0], text.data(), text.size());
  ::close(ends[0]);
  ::waitpid(child, &status, 0);
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return text;
}

TEST_CASE("who ends a program reads how it goes on, and the signal ends it", "[apps]") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    int status = 0;
    CHECK(printed_at_end(signal, true, status) == "palpable: the same command goes on\n");
    CHECK((WIFSIGNALED(status) && WTERMSIG(status) == signal));
    CHECK(printed_at_end(signal, false, status).empty());
    CHECK((WIFSIGNALED(status) && WTERMSIG(status) == signal));
  }
}

}  // namespace
}  // namespace palpable::app
