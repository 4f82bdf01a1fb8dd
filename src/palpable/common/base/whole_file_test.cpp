#include "palpable/common/base/whole_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/stat.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;

const FileBound kAny{.most = std::uintmax_t{1} << 62};

TEST_CASE("a file is read as it is, or the problem gives the reason", "[base][whole_file]") {
  const test::ScratchFolder folder("whole_file_read");
  const std::string bytes("a\0b\r\n\xff", 6);
  test::write_bytes(folder / "file", bytes);
  test::write_bytes(folder / "empty", "");
  fs::create_symlink("file", folder / "link");
  CHECK(read_whole_file(folder / "file", kAny).value() == bytes);
  CHECK(read_whole_file(folder / "link", kAny).value() == bytes);
  CHECK(read_whole_file(folder / "empty", kAny).value().empty());
  // Longer than the part that is judged.
  std::string long_bytes(3 * kJudgedBytes + 17, 'x');
  long_bytes[kJudgedBytes] = 'y';
  test::write_bytes(folder / "long", long_bytes);
  CHECK(read_whole_file(folder / "long", kAny).value() == long_bytes);
  const auto refused = [](const fs::path& path) {
    return read_whole_file(path, kAny).problem().message;
  };
  CHECK(refused(folder / "none") == "no such file");
  CHECK(refused(folder.path()) == "is a folder, not a file");
  CHECK(refused("/dev/zero") == "is no regular file: a pipe or a device is not read");
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK(refused(folder / "pipe") == "is no regular file: a pipe or a device is not read");
}

TEST_CASE("a file that is larger than its bound or than memory is not begun",
          "[base][whole_file][refusal]") {
  const test::ScratchFolder folder("whole_file_large");
  test::write_bytes(folder / "film.stl", "film");
  fs::resize_file(folder / "film.stl", std::uintmax_t{1} << 43);  // sparse: takes no disk space
  CHECK(read_whole_file(folder / "film.stl", kAny).problem().message ==
        "8796093 MB are more than there is memory for");
  CHECK(read_whole_file(folder / "film.stl", {.most = 16'000'000, .remedy = "cut it"})
            .problem()
            .message == "8796093 MB, where 16 are read at most; cut it");
  CHECK(read_whole_file(folder / "film.stl", {.most = 1'500'000}).problem().message ==
        "8796093 MB, where 1.5 are read at most; is it the file that was meant?");
}

TEST_CASE("a file is judged by its first bytes and its size before anything else is read",
          "[base][whole_file][refusal]") {
  const test::ScratchFolder folder("whole_file_judged");
  test::write_bytes(folder / "film.stl", "film");
  fs::resize_file(folder / "film.stl", std::uintmax_t{1} << 43);
  const auto why_not = [](std::string_view first, std::uintmax_t size) -> std::string {
    if (first.size() != std::min<std::uintmax_t>(size, kJudgedBytes)) return "other bytes";
    return first.starts_with("film") ? "a film" : "";
  };
  CHECK(read_whole_file(folder / "film.stl", {.most = 10, .why_not = why_not}).problem().message ==
        "a film");
  test::write_bytes(folder / "mesh.stl", "mesh");
  CHECK(read_whole_file(folder / "mesh.stl", {.most = 10, .why_not = why_not}).value() == "mesh");
}

TEST_CASE("a text is read as plain text, and refused before its rest is read",
          "[base][whole_file][refusal]") {
  const test::ScratchFolder folder("whole_file_text");
  test::write_bytes(folder / "a.txt", "\xef\xbb\xbfone\r\ntwo\r");
  CHECK(read_text_file(folder / "a.txt", kAny).value() == "one\ntwo\n");
  test::write_bytes(folder / "zeros.txt", "one\n");
  fs::resize_file(folder / "zeros.txt", std::uintmax_t{1} << 43);
  CHECK(read_text_file(folder / "zeros.txt", kAny)
            .problem()
            .message.starts_with("line 2: a zero byte"));
  const FileBound ours{.most = 100, .why_not = [](std::string_view first, std::uintmax_t) {
                         return first.starts_with("one") ? "" : "not ours";
                       }};
  CHECK(read_text_file(folder / "a.txt", ours).value() == "one\ntwo\n");
  test::write_bytes(folder / "b.txt", std::string("two\0", 4));
  CHECK(read_text_file(folder / "b.txt", ours).problem().message == "not ours");
}

}  // namespace
}  // namespace palpable
