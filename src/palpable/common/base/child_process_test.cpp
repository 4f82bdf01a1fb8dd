#include "palpable/common/base/child_process.h"

#include "tests/support/test.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace palpable {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

ChildProcess shell(const std::string& script) {
  return ChildProcess::start("/bin/sh", {"-c", script}).value();
}

// What the child writes, until `wanted` bytes have come or it closes its output.
std::string received(ChildProcess& child, std::size_t wanted) {
  std::string text;
  std::array<std::byte, 7> room{};
  while (text.size() < wanted) {
    const auto count = child.receive(room, 5.0);
    if (!count || *count == 0) break;
    text.append(reinterpret_cast<const char*>(room.data()), *count);
  }
  return text;
}

TEST_CASE("a child answers what it is sent, piece by piece", "[base]") {
  ChildProcess child = shell("read a; echo \"$a and you\"; read b; echo \"$b\"");
  std::array<std::byte, 8> room{};
  CHECK(child.receive(room, 0.01) == std::optional<std::size_t>(0));
  REQUIRE(child.send(bytes_of("me\n")));
  CHECK(received(child, 11) == "me and you\n");
  REQUIRE(child.send(bytes_of("more\n")));
  CHECK(received(child, 5) == "more\n");
  CHECK(child.receive(room, 5.0) == std::nullopt);
  CHECK(child.how_it_ended() == "with exit code 0");
}

TEST_CASE("how a child ended is reported, and sending to it does no harm", "[base]") {
  std::array<std::byte, 8> room{};
  ChildProcess failing = shell("exit 3");
  CHECK(failing.receive(room, 5.0) == std::nullopt);
  CHECK_FALSE(failing.send(bytes_of("hello")));
  CHECK(failing.how_it_ended() == "with exit code 3");
  ChildProcess killed = shell("kill -9 $$");
  CHECK(killed.receive(room, 5.0) == std::nullopt);
  CHECK_FALSE(killed.send(bytes_of("hello")));
  CHECK(killed.how_it_ended() == "by signal 9 (Killed)");
  ChildProcess silent = shell("exec sleep 100 <&- >&-");
  CHECK(silent.receive(room, 5.0) == std::nullopt);
  CHECK(silent.how_it_ended() == "by closing its output");
}

TEST_CASE("sending to a child that does not read fails when the buffer is full", "[base]") {
  ChildProcess child = shell("exec sleep 100");
  const std::string much(1 << 16, 'x');
  int sent = 0;
  while (sent < 1000 && child.send(bytes_of(much))) ++sent;
  CHECK(sent < 1000);
}

TEST_CASE("no child is left behind", "[base]") {
  {
    ChildProcess child = shell("trap '' TERM INT; exec sleep 100");
    ChildProcess moved = std::move(child);
  }
  errno = 0;
  CHECK((::waitpid(-1, nullptr, WNOHANG) == -1 && errno == ECHILD));
}

TEST_CASE("a program that is not there is a problem that names it", "[base]") {
  const auto result = ChildProcess::start("/no/such/program", {});
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message == "cannot start /no/such/program: No such file or directory");
}

}  // namespace
}  // namespace palpable
