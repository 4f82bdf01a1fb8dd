#include "palpable/live/events/event_server.h"

#include "tests/support/allocations.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Time = EventServer::Clock::time_point;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kHello = "{\"type\":\"hello\"}\n";

// A minimal client.
class Client {
 public:
  explicit Client(const std::string& name) {
    const std::size_t colon = name.find(':');
    const bool is_unix = name.starts_with("unix:");
    descriptor_ = ::socket(is_unix ? AF_UNIX : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un file{};
    file.sun_family = AF_UNIX;
    name.copy(file.sun_path, sizeof(file.sun_path) - 1, colon + 1);
    sockaddr_in port{};
    port.sin_family = AF_INET;
    port.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (!is_unix)
      port.sin_port = htons(static_cast<std::uint16_t>(std::stoi(name.substr(colon + 1))));
    // A small receive buffer, so that it soon falls behind.
    const int size = 4096;
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &size, sizeof(size));
    REQUIRE((is_unix
                 ? ::connect(descriptor_, reinterpret_cast<sockaddr*>(&file), sizeof(file))
                 : ::connect(descriptor_, reinterpret_cast<sockaddr*>(&port), sizeof(port))) == 0);
  }
  Client(Client&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), got_(std::move(other.got_)) {}
  Client& operator=(Client&&) = delete;
  ~Client() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  // The complete lines received so far; the beginning of an incomplete line is kept for later.
  std::vector<std::string> lines() {
    std::array<char, 65536> bytes{};
    ssize_t count = 0;
    while ((count = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0) {
      got_.append(bytes.data(), static_cast<std::size_t>(count));
    }
    ended_ = count == 0 || (errno != EAGAIN && errno != EINTR);
    std::vector<std::string> lines;
    for (std::size_t end = 0; (end = got_.find('\n')) != std::string::npos;
         got_.erase(0, end + 1)) {
      lines.push_back(got_.substr(0, end));
    }
    return lines;
  }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] const std::string& half_line() const { return got_; }
  // Sends as much as the system accepts. Returns the number of bytes.
  std::size_t flood() {
    const std::string bytes(65536, 'x');
    std::size_t sent = 0;
    ssize_t count = 0;
    while ((count = ::send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT)) > 0) {
      sent += static_cast<std::size_t>(count);
    }
    return sent;
  }
  void say(const std::string& text) {
    REQUIRE(::send(descriptor_, text.data(), text.size(), 0) == std::ssize(text));
  }
  void end_sending() { ::shutdown(descriptor_, SHUT_WR); }

 private:
  int descriptor_ = -1;
  std::string got_;
  bool ended_ = false;
};

std::string line(int number, std::size_t padding = 400) {
  return fmt::format("{{\"frame\":{},\"pad\":\"{}\"}}\n", number, std::string(padding, '.'));
}

int open_files() {
  return static_cast<int>(std::distance(fs::directory_iterator("/proc/self/fd"), {}));
}

// A server that has its first line set, on a Unix socket or on a free port.
struct Served {
  explicit Served(bool is_unix, const EventServerSettings& settings = {})
      : folder("event_server"),
        server(EventAddress{.socket = is_unix ? folder / "s" : fs::path()}, settings) {
    server.greet_with(kHello);
  }
  test::ScratchFolder folder;
  EventServer server;
};

TEST_CASE("whoever connects is greeted and gets every line from then on", "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  server.send(line(0));  // no client is connected yet
  Client one(server.name());
  server.send(line(1));
  Client two(server.name());
  server.send(line(2));
  const std::vector<std::string> first = one.lines();
  REQUIRE(first.size() == 3);
  CHECK(first[0] + "\n" == kHello);
  CHECK(json::parse(first[1])["frame"] == 1);
  CHECK(json::parse(first[1])["dropped"] == 0);
  CHECK(json::parse(first[2])["frame"] == 2);
  const std::vector<std::string> second = two.lines();
  REQUIRE(second.size() == 2);
  CHECK(json::parse(second[1])["frame"] == 2);
  CHECK(server.counts().clients == 2);
  CHECK(server.counts().dropped_lines == 0);
}

TEST_CASE("who connects before the greeting is known waits for it", "[events]") {
  const test::ScratchFolder folder("event_server_early");
  EventServer server(EventAddress{.socket = folder / "s"});
  Client early(server.name());
  server.serve();
  server.send(line(0));
  CHECK(early.lines().empty());
  server.greet_with(kHello);
  server.serve();
  CHECK(early.lines().size() == 1);
}

TEST_CASE("a client that does not read loses whole lines, gets their number, and disturbs no other",
          "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  Client asleep(server.name());
  Client awake(server.name());
  server.serve();
  constexpr int kLines = 4000;
  const Time now{};
  int awake_got = 0;
  for (int i = 0; i < kLines; ++i) {
    server.send(line(i), now);
    for (const std::string& text : awake.lines()) {
      const json got = json::parse(text);
      if (!got.contains("frame")) continue;
      REQUIRE(got["frame"] == awake_got++);
      REQUIRE(got["dropped"] == 0);
    }
  }
  CHECK(awake_got == kLines);
  CHECK(server.counts().dropped_lines > kLines / 2);  // the system buffers 1.6 MB at most
  CHECK(server.client_count() == 2);

  // Every number was received, or is counted as dropped in the line after the gap.
  int next = 0;
  const auto read = [&] {
    for (const std::string& text : asleep.lines()) {
      const json got = json::parse(text);
      if (!got.contains("frame")) continue;
      next += got["dropped"].get<int>();
      REQUIRE(got["frame"] == next++);
    }
  };
  for (int i = 0; i < 1000 && !(next > kLines); ++i) {
    read();
    server.serve(now);
    if (i > 500) server.send(line(kLines + i - 501), now);
  }
  read();
  CHECK(next > kLines);
  CHECK(asleep.half_line().empty());
}

TEST_CASE("a client that takes nothing for five seconds is closed, and a slow one is not",
          "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  Client asleep(server.name());
  Client slow(server.name());
  Time now{};
  server.serve(now);
  // Fills the system's buffers of both clients. Their size depends on the system, and those of a
  // TCP connection continue to move bytes from one end to the other for a while.
  for (int round = 1; round <= 10; ++round) {
    for (int i = 0; i < 1'000'000 && server.counts().dropped_lines < 2000 * round; ++i) {
      server.send(line(i), now);
    }
    std::this_thread::sleep_for(milliseconds(50));
  }
  REQUIRE(server.counts().dropped_lines >= 2000);
  REQUIRE(server.client_count() == 2);
  for (int i = 0; i < 49; ++i) {
    now += milliseconds(100);
    slow.lines();
    server.serve(now);
    for (int k = 0; k < 4000 / 49; ++k) server.send(line(i), now);
  }
  CHECK(server.client_count() == 2);
  now += milliseconds(200);
  slow.lines();
  server.serve(now);
  CHECK(server.client_count() == 1);
  CHECK(server.counts().closed_behind == 1);
  asleep.lines();
  CHECK(asleep.ended());
  CHECK_FALSE(slow.ended());
}

TEST_CASE("a client that keeps up is not closed, however long nothing is said", "[events]") {
  Served served(true);
  Client client(served.server.name());
  served.server.send(line(0), Time{});
  served.server.serve(Time{} + seconds(3600));
  served.server.send(line(1), Time{} + seconds(7200));
  CHECK(served.server.client_count() == 1);
  CHECK(client.lines().size() == 3);
}

TEST_CASE("a line longer than the system keeps arrives whole", "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  Client client(served.server.name());
  const std::string text = line(5, 2'000'000);
  served.server.send(text);
  std::vector<std::string> got;
  for (int i = 0; i < 100'000 && got.size() < 2; ++i) {
    for (std::string& one : client.lines()) got.push_back(std::move(one));
    served.server.serve();
  }
  REQUIRE(got.size() == 2);
  CHECK(got[1] + "\n" == "{\"dropped\":0," + text.substr(1));
}

TEST_CASE("one client more than are served is told so, and the next place is given away",
          "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix, {.most_clients = 3});
  EventServer& server = served.server;
  std::vector<Client> clients;
  for (int i = 0; i < 3; ++i) clients.emplace_back(server.name());
  server.serve();
  Client fourth(server.name());
  server.serve();
  const std::vector<std::string> refusal = fourth.lines();
  REQUIRE(refusal.size() == 1);
  CHECK(json::parse(refusal[0])["type"] == "refused");
  CHECK(fourth.ended());
  CHECK(server.counts().refused == 1);

  for (Client& client : clients) CHECK(client.lines().size() == 1);
  clients.pop_back();  // indistinguishable from a client that only ended its sending
  Client fifth(server.name());
  server.serve();
  CHECK(fifth.lines().size() == 1);
  CHECK_FALSE(fifth.ended());
  CHECK(server.client_count() == 3);
  server.send(line(0));
  for (Client& client : clients) CHECK(client.lines().size() == 1);
}

TEST_CASE("a thousand connections that come and go leave nothing open", "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  Client stays(server.name());
  server.serve();
  const int before = open_files();
  std::size_t got = 0;
  for (int i = 0; i < 1000; ++i) {
    const Client passes(server.name());
    if (i % 7 == 0) server.send(line(i));
    got += stays.lines().size();
  }
  for (int i = 0; i < 20; ++i) server.send(line(1000 + i));
  CHECK(server.client_count() == 1);
  CHECK(open_files() == before);
  CHECK(server.counts().clients + server.counts().refused == 1001);
  CHECK(got + stays.lines().size() == 1 + 143 + 20);
}

TEST_CASE("a client that is gone in the middle of a line is forgotten without a signal",
          "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  {
    const Client gone(server.name());
    for (int i = 0; i < 3000; ++i) server.send(line(i));
    CHECK(server.client_count() == 1);
  }
  for (int i = 0; i < 3; ++i) server.send(line(i));  // SIGPIPE would end the test program
  CHECK(server.client_count() == 0);
  CHECK(server.counts().closed_behind == 0);
}

TEST_CASE("a client that has ended its own sending still gets lines", "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  Client client(served.server.name());
  client.end_sending();
  for (int i = 0; i < 5; ++i) served.server.send(line(i));
  CHECK(client.lines().size() == 6);
  CHECK(served.server.client_count() == 1);
}

TEST_CASE("what a client sends is discarded, and a flood of it delays no other", "[events]") {
  const bool is_unix = GENERATE(true, false);
  Served served(is_unix);
  EventServer& server = served.server;
  Client floods(server.name());
  Client other(server.name());
  server.serve();
  std::size_t sent = floods.flood();
  const std::size_t held = sent;  // bytes in the system's buffers
  CHECK(held > 0);
  for (int i = 0; i < 2000; ++i) {
    server.send(line(i));
    sent += floods.flood();
    floods.lines();
    other.lines();
  }
  CHECK(sent > 2 * held);
  CHECK(server.client_count() == 2);
  CHECK(server.counts().dropped_lines == 0);
}

TEST_CASE("a line to clients that read takes no memory", "[events][allocation]") {
  Served served(true);
  const Client one(served.server.name());
  const Client two(served.server.name());
  const std::string text = line(1);
  served.server.send(text);
  CHECK(test::allocations_during([&] { served.server.send(text); }) == 0);
}

TEST_CASE("the file of a socket is the user's alone and goes with the server", "[events]") {
  const test::ScratchFolder folder("event_server_file");
  const fs::path path = folder / "s";
  {
    const EventServer server(EventAddress{.socket = path});
    CHECK(server.name() == "unix:" + path.string());
    struct stat there {};
    REQUIRE(::stat(path.c_str(), &there) == 0);
    CHECK((there.st_mode & 0777) == 0600);
  }
  CHECK_FALSE(fs::exists(path));
  {
    const EventServer server(EventAddress{.socket = path});
    fs::remove(path);
    test::write_bytes(path, "somebody else's");
  }
  CHECK(test::file_bytes(path) == "somebody else's");
}

TEST_CASE("a socket that a killed program left is replaced, and nothing else is",
          "[events][refusal]") {
  const test::ScratchFolder folder("event_server_stale");
  const fs::path path = folder / "s";
  {  // A socket file on which no process listens any more.
    const EventServer first(EventAddress{.socket = path});
    fs::create_hard_link(path, folder / "stale");
  }
  REQUIRE(fs::is_socket(folder / "stale"));
  EventServer second(EventAddress{.socket = folder / "stale"});
  second.greet_with(kHello);
  CHECK_THROWS_WITH(EventServer(EventAddress{.socket = folder / "stale"}),
                    Catch::Contains("stale: another program listens there; end it, or name"));
  Client client(second.name());  // the refused server has removed nothing
  second.serve();
  second.serve();
  CHECK(client.lines().size() == 1);

  test::write_bytes(path, "a text");
  CHECK_THROWS_WITH(EventServer(EventAddress{.socket = path}),
                    Catch::Contains("s: is in the way and is no socket; name another file"));
  CHECK(test::file_bytes(path) == "a text");
  CHECK_THROWS_WITH(EventServer(EventAddress{.socket = folder / "none" / "s"}),
                    Catch::Contains("none/s: cannot be listened on: No such file or directory"));
  CHECK_THROWS_WITH(EventServer(EventAddress{.socket = folder / std::string(120, 'n')}),
                    Catch::Contains("at most 107"));
}

TEST_CASE("a port that is taken is refused, and 0 finds one of this machine alone",
          "[events][refusal]") {
  const EventServer server(EventAddress{});
  REQUIRE(server.name().starts_with("127.0.0.1:"));
  const int port = std::stoi(server.name().substr(10));
  CHECK(port > 0);
  CHECK_THROWS_WITH(EventServer(EventAddress{.port = port}),
                    Catch::Contains("Address already in use; 0 finds a free port"));
}

TEST_CASE("an address is a port or a file", "[events][refusal]") {
  CHECK(event_address("0").value().port == 0);
  CHECK(event_address("65535").value().port == 65535);
  CHECK(event_address("65535").value().socket.empty());
  CHECK(event_address("unix:a b").value().socket == "a b");
  for (const char* text :
       {"", "unix:", "65536", "-1", "0.5", "localhost", "0.0.0.0:80", "a.sock"}) {
    INFO(text);
    REQUIRE_FALSE(event_address(text).ok());
    CHECK_THAT(event_address(text).problem().message, Catch::Contains("unix:PATH"));
  }
}

TEST_CASE("of the lines that a client sends the newest is returned, whole", "[events]") {
  Served served(true, {.takes_lines = true, .longest_line = 20'000});
  EventServer& server = served.server;
  Client one(server.name()), other(server.name());
  server.serve();
  CHECK_FALSE(server.next_line());
  one.say("first\nsec");
  server.serve();
  const auto first = server.next_line();
  REQUIRE(first);
  CHECK(first->text == "first");
  CHECK(first->skipped == 0);
  CHECK_FALSE(server.next_line());
  one.say("ond\nthird\nfourth\n");
  other.say("hello\n");
  one.say(std::string(10'000, 'z'));  // in several reads
  server.serve();
  std::vector<std::string> said;
  while (const auto line = server.next_line()) {
    CHECK(line->skipped == (line->client == first->client ? 2 : 0));
    said.emplace_back(line->text);
  }
  std::sort(said.begin(), said.end());
  CHECK(said == std::vector<std::string>{"fourth", "hello"});
  one.say("\n");
  server.serve();
  CHECK(server.next_line()->text == std::string(10'000, 'z'));
  // Its last line counts even if it cannot send another one.
  one.say("last\n");
  one.end_sending();
  server.serve();
  CHECK(server.may_send(first->client));
  CHECK(server.next_line()->text == "last");
  CHECK_FALSE(server.may_send(first->client));
}

TEST_CASE("a client whose lines are refused is told why and disconnected, others are not",
          "[events][errors]") {
  Served served(true, {.takes_lines = true, .longest_line = 5000});
  EventServer& server = served.server;
  const Time now = EventServer::Clock::now();
  Client bad(server.name()), endless(server.name()), good(server.name());
  server.serve(now);
  bad.say("nonsense\n");
  endless.say(std::string(6000, 'x'));
  server.serve(now);
  const std::string text = line(1);
  const auto sent = server.next_line();
  REQUIRE(sent);
  server.refuse(sent->client, "is \"nonsense\"", now);
  CHECK_FALSE(server.may_send(sent->client));
  server.refuse(12345, "no such client", now);
  bad.say("more\n");
  server.send(text, now);
  CHECK_FALSE(server.next_line());
  const auto told = bad.lines();
  REQUIRE(told.size() == 2);  // hello, and no frame any more
  CHECK(json::parse(told[1])["type"] == "error");
  CHECK(json::parse(told[1])["reason"] == "is \"nonsense\"");
  CHECK_THAT(endless.lines().at(1), Catch::Contains("5000 bytes"));
  bad.lines();
  CHECK(bad.ended());
  CHECK(good.lines().size() == 2);
  CHECK(server.counts().sent_away == 2);
  // They are closed when they end, or when they do not.
  bad.end_sending();
  server.serve(now);
  CHECK(server.client_count() == 2);
  server.serve(now + seconds(6));
  server.serve(now + seconds(6));
  CHECK(server.client_count() == 1);
  CHECK(server.counts().closed_behind == 0);
}

TEST_CASE("without takes_lines what clients send is never a line", "[events]") {
  Served served(true);
  Client client(served.server.name());
  served.server.serve();
  client.say("line\n");
  served.server.serve();
  CHECK_FALSE(served.server.next_line());
}

TEST_CASE("one client may get another line than all others", "[events]") {
  Served served(true, {.takes_lines = true});
  Client one(served.server.name());
  served.server.serve();
  one.say("x\n");
  served.server.serve();
  const auto number = served.server.next_line()->client;
  Client other(served.server.name());
  served.server.serve();
  served.server.send(line(1), number, line(2));
  CHECK(json::parse(one.lines().at(1))["frame"] == 2);
  CHECK(json::parse(other.lines().at(1))["frame"] == 1);
}

}  // namespace
}  // namespace palpable
