#include "palpable/common/base/folder_lock.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a folder is held by one, until it lets go", "[base][folder_lock][refusal]") {
  const test::ScratchFolder scratch("folder_lock");
  {
    const FolderLock lock(scratch.path());
    CHECK_THROWS_WITH(FolderLock(scratch.path()), Catch::Contains("another run is writing into"));
    CHECK_NOTHROW(FolderLock(scratch / "inner"));
  }
  CHECK_NOTHROW(FolderLock(scratch.path()));
  CHECK(fs::is_empty(scratch.path()));
}

TEST_CASE("a folder may be locked by several with others, but then by none alone",
          "[base][folder_lock][refusal]") {
  const test::ScratchFolder scratch("folder_lock_shared");
  const auto refused = Catch::Contains("another run is writing into");
  {
    const FolderLock one(scratch.path(), Holding::kWithOthers);
    const FolderLock other(scratch.path(), Holding::kWithOthers);
    CHECK_THROWS_WITH(FolderLock(scratch.path()), refused);
  }
  const FolderLock alone(scratch.path());
  CHECK_THROWS_WITH(FolderLock(scratch.path(), Holding::kWithOthers), refused);
}

TEST_CASE("a folder that was created for its lock is removed again if nothing was written into it",
          "[base][folder_lock]") {
  const test::ScratchFolder scratch("folder_lock_made");
  {
    const FolderLock lock(scratch / "a" / "b/");
    CHECK(fs::is_directory(scratch / "a" / "b"));
  }
  CHECK_FALSE(fs::exists(scratch / "a"));
  CHECK(fs::is_directory(scratch.path()));
  {
    const FolderLock lock(scratch / "a" / "b");
    test::write_bytes(scratch / "a" / "kept.txt", "x");
  }
  CHECK(fs::exists(scratch / "a" / "kept.txt"));
  CHECK_FALSE(fs::exists(scratch / "a" / "b"));
  test::write_bytes(scratch / "file", "x");
  CHECK_THROWS_AS(FolderLock(scratch / "file"), Error);
  CHECK_THROWS_AS(FolderLock(scratch / "file" / "c"), Error);
}

TEST_CASE("a killed process holds no lock any more", "[base][folder_lock]") {
  const test::ScratchFolder scratch("folder_lock_killed");
  int held[2];
  REQUIRE(::pipe(held) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(scratch.path());
    if (::write(held[1], "x", 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char word = 0;
  REQUIRE(::read(held[0], &word, 1) == 1);
  CHECK_THROWS_WITH(FolderLock(scratch.path()), Catch::Contains("another run"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK_NOTHROW(FolderLock(scratch.path()));
  for (const int end : held) ::close(end);
}

TEST_CASE("a file is made by one program at a time, and nothing is left beside it", "[base]") {
  const test::ScratchFolder folder("output_lock");
  const std::filesystem::path file = folder.path() / "a.palpable";
  {
    const OutputLock first(file);
    CHECK(std::filesystem::exists(lock_beside(file)));
    CHECK_THROWS_WITH(OutputLock(file), Catch::Contains("a.palpable: another run is making it"));
    CHECK_NOTHROW(OutputLock(folder.path() / "b.palpable"));
  }
  CHECK_FALSE(std::filesystem::exists(lock_beside(file)));
  CHECK_NOTHROW(OutputLock(file));
  // What a killed program left is taken over, what somebody wrote is not removed.
  std::ofstream(lock_beside(file)).close();
  { const OutputLock second(file); }
  CHECK_FALSE(std::filesystem::exists(lock_beside(file)));
  std::ofstream(lock_beside(file)) << "mine";
  { const OutputLock third(file); }
  CHECK(std::filesystem::exists(lock_beside(file)));
}

}  // namespace
}  // namespace palpable
