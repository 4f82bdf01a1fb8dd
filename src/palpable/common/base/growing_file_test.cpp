#include "palpable/common/base/growing_file.h"

#include "palpable/common/base/error.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("an appended piece is in the file before the file is closed", "[base][growing_file]") {
  const test::ScratchFolder folder("growing_file");
  const fs::path path = folder / "lines";
  test::write_bytes(path, "an earlier and longer text");
  GrowingFile file(path);
  file.append("one\n");
  CHECK(test::file_bytes(path) == "one\n");
  file.append("two\n");
  CHECK(test::file_bytes(path) == "one\ntwo\n");
  file.close();
  CHECK_NOTHROW(file.close());
  CHECK_THROWS(file.append("three\n"));
  CHECK(test::file_bytes(path) == "one\ntwo\n");
}

TEST_CASE("a file that meets a limit says so and ends with its last whole piece",
          "[base][growing_file][refusal]") {
  const test::ScratchFolder folder("growing_file_limit");
  const fs::path path = folder / "lines";
  GrowingFile file(path);
  {
    const test::FileSizeLimit limit(10);
    file.append("123456\n");
    CHECK_THROWS_WITH(file.append("abcdef\n"),
                      Catch::Contains("lines: cannot be written: File too large"));
    CHECK(test::file_bytes(path) == "123456\n");
  }
  file.append("xyz\n");  // there is room again
  CHECK(test::file_bytes(path) == "123456\nxyz\n");
}

TEST_CASE("a file that cannot be begun is named with the reason", "[base][growing_file][refusal]") {
  const test::ScratchFolder folder("growing_file_none");
  CHECK_THROWS_WITH(GrowingFile(folder / "none" / "file"),
                    Catch::EndsWith("none/file: cannot be written: No such file or directory"));
  CHECK_THROWS_WITH(GrowingFile(folder.path()), Catch::Contains("Is a directory"));
  CHECK_THROWS_WITH(GrowingFile(folder.path(), "a.csv"),
                    "a.csv: cannot be written: Is a directory");
}

TEST_CASE("a full disk is named as such", "[base][growing_file][refusal]") {
  const test::ScratchFolder folder("growing_file_full");
  fs::create_symlink("/dev/full", folder / "file");
  GrowingFile file(folder / "file");
  CHECK_THROWS_WITH(file.append("x"), Catch::EndsWith("file: cannot be written: "
                                                      "No space left on device"));
}

}  // namespace
}  // namespace palpable
