#include "palpable/base/output_file.h"

#include "palpable/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("asking whether a file can be written changes nothing", "[base][output_file]") {
  const test::ScratchFolder folder("output_file");
  const fs::path there = folder.path() / "there.txt";
  std::ofstream(there) << "kept";
  expect_writable(there);
  CHECK(fs::file_size(there) == 4);
  const fs::path fresh = folder.path() / "fresh.txt";
  expect_writable(fresh);
  CHECK_FALSE(fs::exists(fresh));
}

TEST_CASE("a file in a folder that is not there cannot be written, nor can a folder",
          "[base][output_file]") {
  const test::ScratchFolder folder("no_output_file");
  CHECK_THROWS_AS(expect_writable(folder.path() / "none" / "file.txt"), Error);
  CHECK_THROWS_AS(expect_writable(folder.path()), Error);
  CHECK(fs::is_directory(folder.path()));
}

}  // namespace
}  // namespace palpable
