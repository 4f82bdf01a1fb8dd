#include "palpable/desk/clip_files/text_file.h"

#include "palpable/common/base/error.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using namespace std::string_literals;

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

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  for_each_line(path, [&](const std::string& line) { lines.push_back(line); });
  return lines;
}

TEST_CASE("lines are read with any ends, and with a zero byte that ends the file", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "a.jsonl";
  for (const std::string& text : {"a\nb\n"s, "a\nb"s, "a\r\nb\r\n"s, "a\rb\r"s, "a\n\n\nb\n"s,
                                  "\xef\xbb\xbf"
                                  "a\nb\n"s,
                                  "a\nb\n\0"s, "a\nb\0"s, "a\rb\r\0"s}) {
    INFO(text);
    test::write_bytes(path, text);
    CHECK(lines_of(path) == std::vector<std::string>{"a", "b"});
  }
  test::write_bytes(path, "");
  CHECK(lines_of(path).empty());
  for (const auto& [text, line] : {std::pair{"\0"s, 1}, {"a\0b\n"s, 1}, {"a\nb\0\n"s, 2}}) {
    test::write_bytes(path, text);
    CHECK_THROWS_WITH(lines_of(path),
                      Catch::Contains("line " + std::to_string(line) + ": a zero byte"));
  }
  test::write_bytes(path, "a\nb\n");
  CHECK_THROWS_WITH(for_each_line(path,
                                  [](const std::string& line) {
                                    if (line == "b") throw Error("no number");
                                  }),
                    path.string() + ": line 2: no number");
}

}  // namespace
}  // namespace palpable
