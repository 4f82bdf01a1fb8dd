#include "palpable/common/base/whole_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a file is read as it is, or the problem gives the reason", "[base][whole_file]") {
  const test::ScratchFolder folder("whole_file_read");
  const std::string bytes("a\0b\r\n\xff", 6);
  test::write_bytes(folder / "file", bytes);
  test::write_bytes(folder / "empty", "");
  fs::create_symlink("file", folder / "link");
  CHECK(read_whole_file(folder / "file").value() == bytes);
  CHECK(read_whole_file(folder / "link").value() == bytes);
  CHECK(read_whole_file(folder / "empty").value().empty());
  CHECK(read_whole_file(folder / "none").problem().message == "no such file");
  CHECK(read_whole_file(folder.path()).problem().message == "no such file");
  CHECK(read_whole_file("/dev/zero").problem().message == "no such file");
}

TEST_CASE("a file that is larger than memory is not begun", "[base][whole_file][refusal]") {
  const test::ScratchFolder folder("whole_file_large");
  test::write_bytes(folder / "film.stl", "");
  fs::resize_file(folder / "film.stl", std::uintmax_t{1} << 43);  // sparse: takes no disk space
  CHECK(read_whole_file(folder / "film.stl").problem().message ==
        "8796093 MB are more than there is memory for");
  CHECK(read_whole_file(folder / "film.stl", 16'000'000).problem().message ==
        "8796093 MB, where 16 are read at most");
}

}  // namespace
}  // namespace palpable
