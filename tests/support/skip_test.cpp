// Tests the output of a test program whose cases cannot all run: it starts itself with the
// hidden cases below.
#include "tests/support/test.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/wait.h>

namespace palpable {
namespace {

// ctest runs hidden cases, too; these have an effect only when started by the cases below.
bool is_example() { return std::getenv("PALPABLE_EXAMPLE") != nullptr; }

TEST_CASE("one that cannot run", "[.][example]") {
  if (is_example()) PALPABLE_SKIP("nothing is here");
}
TEST_CASE("one that passes", "[.][example]") { CHECK(true); }
TEST_CASE("one that fails", "[.][example]") { CHECK_FALSE(is_example()); }

int exit_code_of(const std::string& cases) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const int status =
      std::system(("PALPABLE_EXAMPLE=1 '" + self + "' '" + cases + "' > /dev/null 2>&1").c_str());
  return WEXITSTATUS(status);
}

TEST_CASE("who reads the log learns which case was skipped, and why", "[support]") {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  FILE* const output = ::popen(
      ("PALPABLE_EXAMPLE=1 '" + self + "' 'one that cannot run,one that passes'").c_str(), "r");
  REQUIRE(output != nullptr);
  std::string text;
  for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) text += static_cast<char>(c);
  ::pclose(output);
  CHECK_THAT(text, Catch::Contains("SKIPPED: nothing is here (in 'one that cannot run')\n"));
}

TEST_CASE("a program was skipped when none of its cases ran, and not otherwise", "[support]") {
  CHECK(exit_code_of("one that cannot run") == test::kSkippedExitCode);
  CHECK(exit_code_of("one that cannot run,one that passes") == 0);
  CHECK(exit_code_of("one that cannot run,one that fails") == 1);
  CHECK(exit_code_of("one that passes") == 0);
}

}  // namespace
}  // namespace palpable
