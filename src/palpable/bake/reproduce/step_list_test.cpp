#include "palpable/bake/reproduce/step_list.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fstream>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// Appends a line to `counted` and makes `product`.
Step counting_step(const fs::path& folder, const std::string& name) {
  const fs::path product = folder / name;
  return {.what = name,
          .program = "/bin/sh",
          .words = {"-c", "echo once >> " + (folder / (name + ".runs")).string() + "; touch " +
                              product.string()},
          .product = product,
          .seconds = 10};
}

std::size_t runs_of(const fs::path& folder, const std::string& name) {
  std::ifstream in(folder / (name + ".runs"));
  std::size_t count = 0;
  for (std::string line; std::getline(in, line);) ++count;
  return count;
}

TEST_CASE("what was finished is not done again, what is missing is", "[reproduce]") {
  const test::ScratchFolder folder("step_list");
  const std::vector<Step> steps{counting_step(folder.path(), "a"),
                                counting_step(folder.path(), "b")};
  std::vector<std::string> said;
  const auto say = [&](const std::string& line) { said.push_back(line); };
  StepList(folder / "work").run(steps, say);
  REQUIRE(said.size() == 2);
  CHECK(said[0] == "[1 of 2] a; some 20 s left");
  CHECK(said[1] == "[2 of 2] b; some 10 s left");

  StepList again(folder / "work");  // as a later call reads it
  CHECK(again.is_done(steps[0]));
  CHECK(again.seconds(steps[0]) > 0);
  again.run(steps, say);
  CHECK(said.size() == 2);
  fs::remove(folder / "b");
  again.run(steps, say);
  CHECK(runs_of(folder.path(), "a") == 1);
  CHECK(runs_of(folder.path(), "b") == 2);
  Step other = steps[0];
  other.words.push_back("another option");
  CHECK_FALSE(again.is_done(other));
}

TEST_CASE("a command that fails ends the list, and the next call goes on there", "[reproduce]") {
  const test::ScratchFolder folder("step_list_fails");
  Step broken = counting_step(folder.path(), "b");
  broken.words[1] = "echo the disk is full; exit 3";
  const std::vector<Step> steps{counting_step(folder.path(), "a"), broken,
                                counting_step(folder.path(), "c")};
  StepList list(folder / "work");
  const auto quiet = [](const std::string&) {};
  CHECK_THROWS_WITH(list.run(steps, quiet),
                    Catch::Contains("b: failed") && Catch::Contains("02.txt"));
  CHECK(runs_of(folder.path(), "c") == 0);
  std::ifstream log(folder / "work" / "logs" / "02.txt");
  std::string line;
  std::getline(log, line);
  CHECK(line == "the disk is full");
  const std::vector<Step> mended{steps[0], counting_step(folder.path(), "b"), steps[2]};
  list.run(mended, quiet);
  CHECK(runs_of(folder.path(), "a") == 1);
  CHECK(runs_of(folder.path(), "c") == 1);
}

TEST_CASE("a command that ends well without its product has failed", "[reproduce]") {
  const test::ScratchFolder folder("step_list_empty");
  const Step step{
      .what = "nothing", .program = "/bin/true", .words = {}, .product = folder / "never"};
  StepList list(folder / "work");
  CHECK_THROWS_AS(list.run({step}, [](const std::string&) {}), Error);
}

TEST_CASE("what a command prints may be what it leaves, once it has ended well", "[reproduce]") {
  const test::ScratchFolder folder("step_list_prints");
  Step step{.what = "a figure",
            .program = "/bin/sh",
            .words = {"-c", "echo 42; exit 1"},
            .product = folder / "figures" / "a.json",
            .prints_product = true};
  StepList list(folder / "work");
  const auto quiet = [](const std::string&) {};
  CHECK_THROWS_AS(list.run({step}, quiet), Error);
  CHECK_FALSE(fs::exists(step.product));
  step.words[1] = "echo 42";
  list.run({step}, quiet);
  CHECK(list.is_done(step));
  std::ifstream in(step.product);
  std::string line;
  std::getline(in, line);
  CHECK(line == "42");
}

TEST_CASE("a command reads as a user types it", "[reproduce]") {
  const Step step{
      .what = {},
      .program = "/home/me/palpable/build/release/bin/palpable",
      .words = {"bake", "/home/me/palpable/bodies/bunny.toml", "-o", "out/a b.palpable"},
      .product = {}};
  CHECK(step.command("/home/me/palpable") ==
        "palpable bake bodies/bunny.toml -o \"out/a b.palpable\"");
}

}  // namespace
}  // namespace palpable
