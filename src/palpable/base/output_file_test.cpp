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

TEST_CASE("a folder that is not there is named before the work", "[base][output_file]") {
  const test::ScratchFolder folder("folder_of");
  CHECK_NOTHROW(expect_folder_of(folder.path() / "x.vtu"));
  CHECK_NOTHROW(expect_folder_of("x.vtu"));  // here
  CHECK_THROWS_WITH(expect_folder_of(folder.path() / "none" / "x.vtu"),
                    Catch::EndsWith((folder.path() / "none").string() + " does not exist"));
}

TEST_CASE("a folder is made with those above it, or the reason is said", "[base][output_file]") {
  const test::ScratchFolder folder("make_folder");
  make_folder(folder.path() / "a" / "b");
  CHECK(fs::is_directory(folder.path() / "a" / "b"));
  CHECK_NOTHROW(make_folder(folder.path() / "a"));  // there already
  std::ofstream(folder.path() / "file") << "in the way";
  CHECK_THROWS_WITH(make_folder(folder.path() / "file" / "c"),
                    Catch::Contains("file/c: cannot be made: Not a directory"));
}

TEST_CASE("a text replaces the file that was there, or the reason is said", "[base][output_file]") {
  const test::ScratchFolder folder("text_file");
  const fs::path file = folder.path() / "a.html";
  write_text_file(file, "a longer text");
  write_text_file(file, std::string_view("a\0b", 3));
  CHECK(test::file_bytes(file) == std::string("a\0b", 3));
  CHECK_THROWS_WITH(write_text_file(folder.path(), "x"),
                    Catch::Contains("cannot be written: Is a directory"));
}

}  // namespace
}  // namespace palpable
