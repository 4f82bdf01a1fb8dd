#include "palpable/live/sources/video_system.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <csignal>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("the programs that have opened a file are named, this one is not", "[sources][camera]") {
  const test::ScratchFolder folder("video_users");
  const std::filesystem::path file = folder / "video0";
  test::write_bytes(file, "x");
  const std::filesystem::path link = folder / "by-id";
  std::filesystem::create_symlink(file, link);
  VideoSystem& system = linux_video();
  const int own = system.open(file.string());
  REQUIRE(own >= 0);
  CHECK(system.users(file.string()).empty());

  // A child that has the file as its standard input, and waits until it is stopped.
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(own, 0);
    if (::write(ready[1], "x", 1) == 1) ::pause();
    ::_exit(0);
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  const std::string users = system.users(file.string());
  const std::string by_link = system.users(link.string());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK_THAT(users, Contains("(process " + std::to_string(child) + ")"));
  CHECK(by_link == users);
  CHECK(system.users(file.string()).empty());
  system.close(own);
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_CASE("of a device without USB nothing is known", "[sources][camera]") {
  VideoSystem& system = linux_video();
  CHECK(system.usb_link("/dev/video987654").megabits == 0);
  CHECK(system.usb_link("/dev/null").version == 0);
  CHECK(system.product("/dev/video987654").empty());
  CHECK(system.users("/dev/video987654").empty());
}

}  // namespace
}  // namespace palpable
