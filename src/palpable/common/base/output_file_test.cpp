#include "palpable/common/base/output_file.h"

#include "palpable/common/base/error.h"
#include "tests/support/full_disk.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

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

TEST_CASE("the unfinished file of a running process is distinguished from that of an ended one",
          "[base][files]") {
  CHECK(is_part_of_running_process("site_0003.h5" + own_part_suffix()));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5"));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5.part-another-host-1"));
  // A name that has the process number at the right position but another text before it.
  const std::string no_part(own_part_suffix().rfind('-'), 'x');
  CHECK_FALSE(is_part_of_running_process(no_part + std::to_string(::getpid())));
  // The number of a process that has just ended.
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  REQUIRE(::waitpid(ended, nullptr, 0) == ended);
  std::string suffix = own_part_suffix();
  suffix.resize(suffix.rfind('-') + 1);
  CHECK_FALSE(is_part_of_running_process("site_0003.h5" + suffix + std::to_string(ended)));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5" + suffix));
}

void write_one(const fs::path& file) { write_whole_file(file, "x"); }

TEST_CASE("asking whether a file can be written changes nothing", "[base][output_file]") {
  const test::ScratchFolder folder("output_file");
  const fs::path there = folder.path() / "there.txt";
  std::ofstream(there) << "kept";
  expect_writable(there);
  CHECK(fs::file_size(there) == 4);
  const fs::path fresh = folder.path() / "fresh.txt";
  expect_writable(fresh);
  CHECK_FALSE(fs::exists(fresh));
  fs::create_symlink("fresh.txt", folder / "link");
  expect_writable(folder / "link");
  CHECK(fs::is_symlink(folder / "link"));
  std::ofstream(part_of(there)) << "somebody's";
  expect_writable(there);
  CHECK(test::file_bytes(part_of(there)) == "somebody's");
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 3);
}

TEST_CASE("a file in a folder that is not there cannot be written, nor can a folder",
          "[base][output_file]") {
  const test::ScratchFolder folder("no_output_file");
  CHECK_THROWS_AS(expect_writable(folder.path() / "none" / "file.txt"), Error);
  CHECK_THROWS_AS(expect_writable(folder.path()), Error);
  CHECK(fs::is_directory(folder.path()));
}

TEST_CASE("an output whose folder is not there is refused before the work", "[base][output_file]") {
  const test::ScratchFolder folder("guard_folder_above");
  CHECK_NOTHROW(guard_output_file(folder.path() / "x.vtu", {}));
  CHECK_NOTHROW(guard_output_file("x.vtu", {}));  // here
  CHECK_NOTHROW(guard_output_folder(folder.path() / "out", {}));
  CHECK_NOTHROW(guard_output_folder(folder.path() / "out/", {}));
  const auto says = Catch::EndsWith((folder.path() / "none").string() + " does not exist");
  CHECK_THROWS_WITH(guard_output_file(folder.path() / "none" / "x.vtu", {}), says);
  CHECK_THROWS_WITH(guard_output_folder(folder.path() / "none" / "out/", {}), says);
}

TEST_CASE("a file that is read is not written over, by whatever name", "[base][output_file]") {
  const test::ScratchFolder folder("guard_inputs");
  const fs::path input = folder.path() / "a.stl", link = folder.path() / "link.stl",
                 hard = folder.path() / "hard.stl", store = folder.path() / "store";
  std::ofstream(input) << "kept";
  fs::create_symlink("a.stl", link);
  fs::create_hard_link(input, hard);
  fs::create_directory(store);
  std::ofstream(store / "site_0.h5") << "kept";
  for (const fs::path& output : {input, link, hard, store / ".." / "a.stl"}) {
    INFO(output);
    CHECK_THROWS_WITH(guard_output_file(output, {"", input}),
                      Catch::Contains(output.string() + ": is read as input"));
  }
  CHECK_THROWS_WITH(guard_output_file(store / "site_0.h5", {store}), Catch::Contains("is read as"));
  CHECK_NOTHROW(guard_output_file(store / "body.palpable", {store}));
  CHECK_NOTHROW(guard_output_file(folder.path() / "b.stl", {input, store}));
  std::ofstream(folder.path() / "b.stl") << "an earlier result";
  CHECK_NOTHROW(guard_output_file(folder.path() / "b.stl", {input, store}));
}

TEST_CASE("an output file is a file and an output folder a folder", "[base][output_file]") {
  const test::ScratchFolder folder("guard_kinds");
  const fs::path file = folder.path() / "file", store = folder.path() / "store";
  std::ofstream(file) << "kept";
  fs::create_directory(store);
  CHECK_THROWS_WITH(guard_output_file(store, {}), Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(guard_output_file(folder.path() / "new/", {}),
                    Catch::Contains("does not exist") || Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(guard_output_file("/dev/null", {}), Catch::Contains("is no ordinary file"));
  CHECK_THROWS_WITH(guard_output_file("", {file}), "the name of the output is empty");
  CHECK_THROWS_WITH(guard_output_folder("", {file}), "the name of the output is empty");
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const std::string pipe = "/proc/self/fd/" + std::to_string(ends[1]);
  CHECK_THROWS_WITH(guard_output_file(pipe, {}), Catch::Contains("is no ordinary file"));
  write_whole_file(pipe, "through it");
  char read[20];
  CHECK(::read(ends[0], read, sizeof read) == 10);
  for (const int end : ends) ::close(end);
  CHECK_THROWS_WITH(guard_output_folder(file, {}), Catch::Contains("is a file"));
  CHECK_NOTHROW(guard_output_folder(store, {file}));
  CHECK_THROWS_WITH(guard_output_folder(store, {store}), Catch::Contains("read as input"));
  CHECK_THROWS_WITH(guard_output_folder(folder.path(), {store}), Catch::Contains("read as input"));
  CHECK_NOTHROW(guard_output_folder(store / "new", {store}));
  fs::create_directory(store / "new");
  CHECK_THROWS_WITH(guard_output_folder(store / "new", {store}), Catch::Contains("read as input"));
}

TEST_CASE("a link is followed to the file that it stands for", "[base][output_file]") {
  const test::ScratchFolder folder("behind_links");
  const fs::path file = folder.path() / "file", first = folder.path() / "first";
  CHECK(behind_links(file) == file);
  fs::create_symlink("second", first);
  fs::create_symlink(file, folder.path() / "second");
  CHECK(behind_links(first) == file);  // which does not exist
  fs::create_symlink("circle", folder.path() / "circle");
  CHECK(fs::is_symlink(behind_links(folder.path() / "circle")));  // and an end
}

TEST_CASE("what lies in a folder is known through links and dots", "[base][output_file]") {
  const test::ScratchFolder folder("lies_in");
  const fs::path inside = folder.path() / "a" / "b", link = folder.path() / "link";
  fs::create_directories(inside);
  fs::create_directory_symlink(inside, link);
  CHECK(lies_in(inside, folder.path()));
  CHECK(lies_in(inside, inside));
  CHECK(lies_in(link / "new", folder.path() / "a"));
  CHECK(lies_in(folder.path() / "a" / ".." / "c", folder.path()));
  CHECK_FALSE(lies_in(folder.path() / "a" / ".." / "c", folder.path() / "a"));
  CHECK_FALSE(lies_in(folder.path() / "ab", folder.path() / "a"));
}

TEST_CASE("a folder is created with those above it, or the error gives the reason",
          "[base][output_file]") {
  const test::ScratchFolder folder("make_folder");
  make_folder(folder.path() / "a" / "b");
  CHECK(fs::is_directory(folder.path() / "a" / "b"));
  CHECK_NOTHROW(make_folder(folder.path() / "a"));  // there already
  std::ofstream(folder.path() / "file") << "in the way";
  CHECK_THROWS_WITH(make_folder(folder.path() / "file" / "c"),
                    Catch::Contains("file/c: cannot be made: Not a directory"));
}

TEST_CASE("a file is replaced as a whole, or stays as it was", "[base][output_file]") {
  const test::ScratchFolder folder("whole_file");
  const fs::path file = folder / "picture";
  const std::string bytes(100, 'x');
  {
    const test::FileSizeLimit limit(50);
    CHECK_THROWS_WITH(write_whole_file(file, bytes),
                      Catch::EndsWith("picture: cannot be written: File too large"));
  }
  CHECK(fs::is_empty(folder.path()));  // nor half a file
  write_whole_file(file, bytes);
  CHECK(test::file_bytes(file) == bytes);
  {
    const test::FileSizeLimit limit(150);
    CHECK_THROWS_WITH(write_whole_file(file, {"one", std::string(200, 'y')}),
                      Catch::EndsWith("picture: cannot be written: File too large"));
  }
  CHECK(test::file_bytes(file) == bytes);
  write_whole_file(file, {"one", std::string_view("a\0b", 3), "", "two"});
  CHECK(test::file_bytes(file) == std::string("onea\0btwo", 9));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("two programs that replace a file at once leave one of theirs, whole",
          "[base][output_file]") {
  const test::ScratchFolder folder("replaced_by_two");
  const fs::path file = folder / "file";
  const std::string long_one(1'000'000, 'a'), short_one(300'000, 'b');
  const auto write = [&](const std::string& bytes) {
    for (int k = 0; k < 100; ++k) write_whole_file(file, bytes);
  };
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      write(long_one);
      ::_exit(0);
    } catch (const Error&) { ::_exit(1); }
  }
  CHECK_NOTHROW(write(short_one));
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(status == 0);
  const std::string left = test::file_bytes(file);
  CHECK((left == long_one || left == short_one));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a file that is replaced keeps its permissions, and a link stays a link",
          "[base][output_file]") {
  const test::ScratchFolder folder("replaced_file");
  const fs::path file = folder / "file", link = folder / "link", dangling = folder / "dangling";
  write_whole_file(file, "before");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("file", link);
  fs::create_symlink("new", dangling);
  write_whole_file(link, "after");
  write_whole_file(dangling, "made");
  CHECK(fs::is_symlink(link));
  CHECK(fs::is_symlink(dangling));
  CHECK(test::file_bytes(file) == "after");
  CHECK(test::file_bytes(folder / "new") == "made");
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a pipe, device or folder is not replaced by a file", "[base][output_file][refusal]") {
  const test::ScratchFolder folder("no_file");
  fs::create_symlink("/dev/full", folder / "full");
  fs::create_symlink("circle", folder / "circle");
  CHECK_THROWS_WITH(write_whole_file(folder / "full", "x"),
                    Catch::EndsWith("full: cannot be written: No space left on device"));
  CHECK(fs::is_character_file("/dev/full"));
  CHECK_THROWS_WITH(write_whole_file(folder.path(), "x"),
                    Catch::Contains("cannot be written: Is a directory"));
  for (const auto& writes : {expect_writable, write_one}) {
    CHECK_THROWS_WITH(
        writes(folder / "circle"),
        Catch::EndsWith("circle: cannot be written: Too many levels of symbolic links"));
    CHECK_THROWS_WITH(writes(folder / "none" / "file"),
                      Catch::EndsWith("cannot be written: No such file or directory"));
  }
  CHECK(fs::is_symlink(folder / "circle"));
}

TEST_CASE("a write-protected file is kept", "[base][output_file][refusal]") {
  const test::ScratchFolder folder("write_protected");
  const fs::path file = folder / "file";
  write_whole_file(file, "mine");
  fs::permissions(file, fs::perms::owner_read);
  if (::geteuid() == 0) {  // root may write to every file
    write_whole_file(file, "yours");
    return;
  }
  CHECK_THROWS_WITH(write_whole_file(file, "yours"), Catch::EndsWith("Permission denied"));
  CHECK_THROWS_WITH(guard_output_file(file, {}), Catch::EndsWith("Permission denied"));
  CHECK(test::file_bytes(file) == "mine");
}

TEST_CASE("a file that is opened alone is written by one at a time", "[base][refusal]") {
  const test::ScratchFolder folder("growing_alone");
  const fs::path file = folder / "a";
  {
    GrowingFile first(file, Opening::kNew);
    first.append("first");
    CHECK_THROWS_WITH(GrowingFile(file, Opening::kNew), file.string() + ": is there already");
    CHECK_THROWS_WITH(GrowingFile(file, Opening::kAlone),
                      Catch::Contains("another run is writing it"));
    CHECK(test::file_bytes(file) == "first");  // the refused ones have not emptied it
    first.append(" and more");
    first.close();
  }
  CHECK(test::file_bytes(file) == "first and more");
  CHECK_THROWS_WITH(GrowingFile(file, Opening::kNew), Catch::Contains("is there already"));
  fs::create_symlink("a", folder / "link");
  {
    GrowingFile second(folder / "link", Opening::kAlone);
    second.append("two");
    CHECK_THROWS_WITH(GrowingFile(file, Opening::kAlone),
                      Catch::Contains("another run is writing it"));
  }
  CHECK(test::file_bytes(file) == "two");
  { const GrowingFile without_piece(file, Opening::kAlone); }
  CHECK(test::file_bytes(file) == "two");
  { const GrowingFile without_piece(folder / "new", Opening::kNew); }
  CHECK_FALSE(fs::exists(folder / "new"));
  CHECK(fs::is_symlink(folder / "link"));
  GrowingFile(file, Opening::kEmptied).append("3");
  CHECK(test::file_bytes(file) == "3");
  CHECK_THROWS_WITH(GrowingFile(folder / "none" / "a", Opening::kAlone),
                    Catch::Contains("cannot be written"));
}

}  // namespace

}  // namespace palpable
