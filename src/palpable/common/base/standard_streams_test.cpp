#include "palpable/common/base/standard_streams.h"

#include "tests/support/test.h"

#include <cstdio>
#include <fcntl.h>
#include <functional>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

// Runs `work` in a process of its own and returns its exit code.
int exit_code_of(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_CASE("the number of a closed stream is occupied, so that no file gets it", "[base]") {
  const auto next_number = [](bool prepared) {
    ::close(STDOUT_FILENO);
    if (prepared) prepare_standard_streams();
    return ::open("/dev/null", O_WRONLY);
  };
  CHECK(exit_code_of([&] { return next_number(false); }) == STDOUT_FILENO);
  CHECK(exit_code_of([&] { return next_number(true); }) > STDERR_FILENO);
}

TEST_CASE("what was printed and could not be written is noticed", "[base]") {
  const auto printed_into = [](const char* file) {
    ::dup2(::open(file, O_WRONLY), STDOUT_FILENO);
    std::fputs("a table", stdout);
    const std::string why = flush_standard_output();
    return why.empty()                                                           ? 0
           : why == "what is printed cannot be written: No space left on device" ? 1
                                                                                 : 2;
  };
  CHECK(exit_code_of([&] { return printed_into("/dev/null"); }) == 0);
  CHECK(exit_code_of([&] { return printed_into("/dev/full"); }) == 1);
}

}  // namespace
}  // namespace palpable
