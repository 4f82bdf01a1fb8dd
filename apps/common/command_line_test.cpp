#include "apps/common/command_line.h"

#include "palpable/base/nearest_word.h"
#include "tests/support/test.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

// A program with one command that takes a number and may fail.
int run(std::vector<const char*> words) {
  CommandLine app("A program", "prog", "prog 1");
  app.require_subcommand();
  Command halve = app.add_subcommand("halve", "Halve a number");
  int number = 0;
  halve.add_option("--number", number, "Even").required();
  halve.callback([&] {
    if (number % 2 != 0) throw std::runtime_error("odd\nand so no half");
  });
  words.insert(words.begin(), "prog");
  return app.run(static_cast<int>(words.size()), words.data());
}

TEST_CASE("every error ends with exit code 1, whatever CLI11 calls it", "[apps][errors]") {
  CHECK(run({"halve", "--number", "4"}) == 0);
  CHECK(run({"--help"}) == 0);
  CHECK(run({"halve", "--help"}) == 0);
  CHECK(run({}) == 1);
  CHECK(run({"half"}) == 1);
  CHECK(run({"halve"}) == 1);
  CHECK(run({"halve", "--numbr", "4"}) == 1);
  CHECK(run({"halve", "--number", "four"}) == 1);
  CHECK(run({"halve", "--number", "3"}) == 1);
  CHECK(run({"--nonsense"}) == 1);
}

TEST_CASE("the nearest word is suggested when it is near enough to have been meant", "[apps]") {
  const std::vector<std::string> words{"live", "view", "inspect"};
  CHECK(nearest_word("liev", words) == "live");
  CHECK(nearest_word("inspekt", words) == "inspect");
  CHECK(nearest_word("veiw", words) == "view");
  CHECK(nearest_word("bake", words).empty());
  CHECK(nearest_word("", words).empty());
}

}  // namespace
}  // namespace palpable::app
