#include "palpable/desk/clip_files/text_file.h"

#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

TEST_CASE("a text that cannot be written is an error", "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  CHECK_THROWS_WITH(TextFile(folder / "nowhere/a.txt"),
                    Catch::Contains("a.txt: cannot be written"));
  TextFile full("/dev/full");
  full.write("text\n");
  CHECK_THROWS_WITH(full.close(), "/dev/full: cannot be written: No space left on device");
}

TEST_CASE("lines of a text file are on the disk after flush() or close()", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "a.csv";
  TextFile text(path);
  text.write("1,2\n");
  CHECK(test::file_bytes(path).empty());  // a single line stays in memory
  text.flush();
  CHECK(test::file_bytes(path) == "1,2\n");
  text.write("3,4\n");
  text.close();
  CHECK(test::file_bytes(path) == "1,2\n3,4\n");
  {
    TextFile given_up(path);
    given_up.write("5,6\n");
  }
  CHECK(test::file_bytes(path) == "5,6\n");
}

TEST_CASE("a text on a full disk ends with a whole line", "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "a.csv";
  const test::FileSizeLimit limit(10);
  TextFile text(path);
  text.write("1,2\n");
  text.flush();
  text.write("3,4\n5,6\n");
  CHECK_THROWS_WITH(text.flush(), Catch::EndsWith("a.csv: cannot be written: File too large"));
  CHECK(test::file_bytes(path) == "1,2\n");
}

}  // namespace
}  // namespace palpable
