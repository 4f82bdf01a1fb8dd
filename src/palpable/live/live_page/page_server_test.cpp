#include "palpable/live/live_page/page_server.h"

#include "palpable/live/live_page/page_access.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <memory>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

using std::chrono::milliseconds;

const std::string kGreeting = "{\"type\":\"hello\"}";  // NOLINT
constexpr milliseconds kPatienceOfTest{300};

PageServerSettings settings_of(const std::string& token) {
  return {.token = token,
          .files = {{"", "text/html", "<html>page</html>"}, {"page.js", "text/javascript", "1"}},
          .most_clients = 2,
          .patience = kPatienceOfTest};
}

// A server that greets, and addresses of it.
struct Served {
  explicit Served(PageServerSettings settings = settings_of(new_page_token()))
      : server(std::move(settings)) {
    server.begin({kGreeting + "\n"}, "MESH");
  }
  [[nodiscard]] std::string host() const { return fmt::format("127.0.0.1:{}", server.port()); }
  [[nodiscard]] std::string get(std::string_view name, std::string_view more = "") const {
    return fmt::format("GET /{}/{} HTTP/1.1\r\nHost: {}\r\n{}\r\n", server.token(), name, host(),
                       more);
  }
  [[nodiscard]] std::string upgrade(std::string_view more = "") const {
    return get(kLiveSocket,
               fmt::format("Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: "
                           "13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{}",
                           more));
  }
  PageServer server;
};

// A client that speaks the protocol by hand.
class PageClient {
 public:
  explicit PageClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval longest{20, 0};  // a test that waits for it fails
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    REQUIRE(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0);
  }
  explicit PageClient(const Served& served, std::string_view more = "")
      : PageClient(served.server.port()) {
    send(served.upgrade(more));
    head_ = read_head();
  }
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;
  ~PageClient() { ::close(socket_); }

  [[nodiscard]] const std::string& head() const { return head_; }
  void send(std::string_view bytes) const {
    // A server that has closed is no failure of the test.
    static_cast<void>(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
  }
  // A frame of at most 65535 bytes. @param first  0x81: text, 0x82: binary
  void send_frame(std::string_view text, unsigned first = 0x81, bool masked = true) const {
    std::string frame{static_cast<char>(first)};
    const unsigned mask_bit = masked ? 0x80 : 0;
    if (text.size() < 126) {
      frame += static_cast<char>(mask_bit | text.size());
    } else {
      frame += static_cast<char>(mask_bit | 126U);
      frame += static_cast<char>(text.size() >> 8U);
      frame += static_cast<char>(text.size() & 255U);
    }
    if (masked) frame += std::string(4, '\0');  // a mask of zeros leaves the text as it is
    send(frame + std::string(text));
  }
  // Up to the empty line.
  std::string read_head() {
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
      const auto byte = read(1);
      if (!byte) break;
      head += *byte;
    }
    return head;
  }
  // All that comes until the other side ends.
  std::string read_rest() {
    std::string all;
    while (const auto byte = read(1)) all += *byte;
    return all;
  }
  struct Frame {
    unsigned kind = 0;  // 1: text, 2: binary, 8: close, 9: ping
    std::string bytes;
  };
  // The next frame; nothing: the connection has ended.
  std::optional<Frame> read_frame() {
    const auto begin = read(2);
    if (!begin) return std::nullopt;
    CHECK((static_cast<unsigned char>((*begin)[0]) & 0x80U) != 0);  // whole messages
    std::uint64_t size = static_cast<unsigned char>((*begin)[1]);
    if (size > 125) {
      const auto more = read(size == 126 ? 2 : 8);
      if (!more) return std::nullopt;
      size = 0;
      for (const char byte : *more) size = 256 * size + static_cast<unsigned char>(byte);
    }
    auto bytes = read(size);
    if (!bytes) return std::nullopt;
    return Frame{static_cast<unsigned>((*begin)[0]) & 15U, std::move(*bytes)};
  }
  // The next message; pings are answered.
  std::optional<std::string> read_message() {
    while (auto frame = read_frame()) {
      if (frame->kind == 8) return std::nullopt;
      if (frame->kind != 9) return frame->bytes;
      send_frame(frame->bytes, 0x8A);  // a pong
    }
    return std::nullopt;
  }
  // Whether the server closes the connection, whatever it sends before.
  bool is_closed() {
    std::array<char, 4096> ignored{};
    ssize_t got = 0;
    while ((got = ::recv(socket_, ignored.data(), ignored.size(), 0)) > 0) {}
    return got == 0 || errno == ECONNRESET;
  }

 private:
  std::optional<std::string> read(std::size_t count) {
    std::string bytes(count, '\0');
    for (std::size_t done = 0; done < count;) {
      const ssize_t got = ::recv(socket_, bytes.data() + done, count - done, 0);
      if (got <= 0) return std::nullopt;
      done += static_cast<std::size_t>(got);
    }
    return bytes;
  }

  int socket_;
  std::string head_;
};

std::string ask(const Served& served, const std::string& request) {
  PageClient client(served.server.port());
  client.send(request);
  return client.read_rest();
}

// For tests whose clients answer no pings while others are read.
PageServerSettings patient() {
  PageServerSettings settings = settings_of(new_page_token());
  settings.patience = milliseconds(20'000);
  return settings;
}

// Waits until the server's thread has done something.
template <class Condition>
bool soon(Condition is_so) {
  for (int k = 0; k < 2000 && !is_so(); ++k) std::this_thread::sleep_for(milliseconds(5));
  return is_so();
}

TEST_CASE("the page is served to whoever has its address", "[live_page][server]") {
  const Served served;
  const std::string page = ask(served, served.get(""));
  CHECK_THAT(page, Catch::StartsWith("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n") &&
                       Catch::Contains("Referrer-Policy: no-referrer\r\n") &&
                       Catch::EndsWith("\r\n\r\n<html>page</html>"));
  CHECK_THAT(ask(served, served.get("page.js")), Catch::EndsWith("\r\n\r\n1"));
  CHECK_THAT(ask(served, served.get("none")), Catch::StartsWith("HTTP/1.1 404"));
  CHECK_THAT(ask(served, served.get(kLiveSocket)), Catch::StartsWith("HTTP/1.1 400"));
  CHECK_FALSE(served.server.has_clients());
}

TEST_CASE("a wrong token, host or origin is refused, with and without a WebSocket",
          "[live_page][server]") {
  const Served served;
  const auto instead = [](std::string request, const std::string& text, const std::string& other) {
    return request.replace(request.find(text), text.size(), other);
  };
  const std::string other(32, '0');
  for (const std::string& good : {served.get("page.js"), served.upgrade()}) {
    CHECK_THAT(ask(served, instead(good, served.server.token(), other)),
               Catch::StartsWith("HTTP/1.1 403"));
    CHECK_THAT(ask(served, instead(good, "Host: 127.0.0.1", "Host: evil.example")),
               Catch::StartsWith("HTTP/1.1 403"));
    CHECK_THAT(ask(served, instead(good, "\r\nHost", "\r\nHost: evil.example\r\nHost")),
               Catch::StartsWith("HTTP/1.1 403"));
    CHECK_THAT(ask(served, instead(good, "\r\nHost", "\r\nOrigin: http://evil.example\r\nHost")),
               Catch::StartsWith("HTTP/1.1 403"));
  }
  CHECK(served.server.counts().refused == 8);
  CHECK(served.server.counts().clients == 0);
  const PageClient ours(served, fmt::format("Origin: http://{}\r\n", served.host()));
  CHECK_THAT(ours.head(), Catch::StartsWith("HTTP/1.1 101"));
}

TEST_CASE("a client gets the greeting and the lines, and what it asks for", "[live_page][server]") {
  Served served;
  PageClient client(served);
  // The key's answer is that of RFC 6455, section 1.3.
  CHECK_THAT(client.head(), Catch::Contains("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
  CHECK(client.read_message() == kGreeting);
  CHECK(served.server.has_clients());
  CHECK_FALSE(served.server.wants_pictures());
  served.server.send_line("{\"a\":1}\n");
  served.server.send_picture("that no client wants");
  CHECK(client.read_message() == "{\"dropped\":0,\"a\":1}");
  client.send_frame("{\"want\":[\"picture\",\"skin\"]}");
  CHECK(client.read_message() == "MESH");
  REQUIRE(soon([&] { return served.server.wants_pictures() && served.server.wants_skins(); }));
  const std::string skin(300'000, 's'), picture(70'000, 'p');
  served.server.send_skin(skin);
  CHECK(client.read_message() == skin);
  served.server.send_picture(picture);
  CHECK(client.read_message() == picture);
  client.send_frame("{\"want\":[]}");
  CHECK(soon([&] { return !served.server.wants_pictures() && !served.server.wants_skins(); }));
}

TEST_CASE("a client that wants skins gets the last one at once", "[live_page][server]") {
  Served served;
  served.server.send_skin("SKIN");
  PageClient client(served);
  CHECK(client.read_message() == kGreeting);
  client.send_frame("{\"want\":[\"skin\"]}");
  CHECK(client.read_message() == "MESH");
  CHECK(client.read_message() == "SKIN");
}

TEST_CASE(
    "clients that are there are greeted with another session, and get its triangles and skins",
    "[live_page][server]") {
  PageServerSettings settings = patient();
  settings.most_clients = 3;
  Served served(settings);
  PageClient client(served), without_skins(served);
  CHECK(client.read_message() == kGreeting);
  CHECK(without_skins.read_message() == kGreeting);
  client.send_frame("{\"want\":[\"skin\"]}");
  CHECK(client.read_message() == "MESH");
  served.server.send_skin("SKIN of the first");
  CHECK(client.read_message() == "SKIN of the first");
  served.server.send_line("{\"first\":1}");
  served.server.begin({"{\"type\":\"hello\",\"n\":2}", "{\"type\":\"page\"}\n"},
                      "MESH of the second");
  served.server.send_line("{\"second\":1}");
  served.server.send_skin("SKIN of the second");
  for (PageClient* one : {&client, &without_skins}) {
    CHECK(one->read_message() == "{\"dropped\":0,\"first\":1}");
    CHECK(one->read_message() == "{\"type\":\"hello\",\"n\":2}");
    CHECK(one->read_message() == "{\"type\":\"page\"}");
  }
  CHECK(without_skins.read_message() == "{\"dropped\":0,\"second\":1}");
  // Lines, triangles and skin come from one call each; the triangles may be sent before the line.
  std::vector<std::string> came;
  for (int k = 0; k < 3; ++k) came.push_back(client.read_message().value_or("ended"));
  std::sort(came.begin(), came.end());
  CHECK(came == std::vector<std::string>{"MESH of the second", "SKIN of the second",
                                         "{\"dropped\":0,\"second\":1}"});
  // A later client is greeted with the second alone, and gets its skin.
  PageClient later(served);
  CHECK(later.read_message() == "{\"type\":\"hello\",\"n\":2}");
  CHECK(later.read_message() == "{\"type\":\"page\"}");
  later.send_frame("{\"want\":[\"skin\"]}");
  CHECK(later.read_message() == "MESH of the second");
  CHECK(later.read_message() == "SKIN of the second");
}

TEST_CASE("a session gives a client no skin of the one before", "[live_page][server]") {
  Served served(patient());
  PageClient client(served);
  CHECK(client.read_message() == kGreeting);
  client.send_frame("{\"want\":[\"skin\"]}");
  CHECK(client.read_message() == "MESH");
  served.server.send_skin("SKIN");
  CHECK(client.read_message() == "SKIN");
  served.server.begin({kGreeting}, "MESH");
  CHECK(client.read_message() == kGreeting);
  CHECK(client.read_message() == "MESH");
  PageClient later(served);
  CHECK(later.read_message() == kGreeting);
  later.send_frame("{\"want\":[\"skin\"]}");
  CHECK(later.read_message() == "MESH");
  served.server.send_line("{\"a\":1}");
  CHECK(later.read_message() == "{\"dropped\":0,\"a\":1}");
}

TEST_CASE("a client gets the triangles once, however often it asks for skins",
          "[live_page][server]") {
  Served served(patient());
  PageClient client(served);
  CHECK(client.read_message() == kGreeting);
  client.send_frame("{\"want\":[\"skin\"]}");
  CHECK(client.read_message() == "MESH");
  client.send_frame("{\"want\":[]}");
  REQUIRE(soon([&] { return !served.server.wants_skins(); }));
  served.server.send_skin("SKIN");
  client.send_frame("{\"want\":[\"skin\"]}");
  CHECK(client.read_message() == "SKIN");
}

TEST_CASE("the line of a frame that was missed goes to those alone who have none",
          "[live_page][server]") {
  Served served(patient());
  CHECK(served.server.arrivals() == 0);
  PageClient early(served);
  CHECK(early.read_message() == kGreeting);
  CHECK(served.server.arrivals() == 1);
  served.server.send_line("{\"frame\":4}\n");
  CHECK(early.read_message() == "{\"dropped\":0,\"frame\":4}");
  PageClient late(served);
  CHECK(late.read_message() == kGreeting);
  CHECK(served.server.arrivals() == 2);
  served.server.send_line("{\"tick\":1}", false);  // a tick is no frame
  served.server.send_missed_line("{\"frame\":4}\n");
  CHECK(late.read_message() == "{\"dropped\":0,\"tick\":1}");
  CHECK(late.read_message() == "{\"dropped\":0,\"frame\":4}");
  served.server.send_missed_line("{\"frame\":4}");  // all have it
  served.server.send_line("{\"frame\":5}");
  CHECK(late.read_message() == "{\"dropped\":0,\"frame\":5}");
  CHECK(early.read_message() == "{\"dropped\":0,\"tick\":1}");
  CHECK(early.read_message() == "{\"dropped\":0,\"frame\":5}");
  late.send_frame("{\"want\":[\"picture\"]}");
  CHECK(soon([&] { return served.server.arrivals() == 3; }));
}

TEST_CASE("the end of the run is said, after what was sent before it", "[live_page][server]") {
  auto served = std::make_unique<Served>();
  PageClient client(*served);
  CHECK(client.read_message() == kGreeting);
  served->server.send_line("{\"last\":true}");
  served.reset();
  CHECK(client.read_message() == "{\"dropped\":0,\"last\":true}");
  const auto end = client.read_frame();
  REQUIRE(end.has_value());
  CHECK(end->kind == 8);
  CHECK(end->bytes.substr(0, 2) == "\x03\xe9");  // 1001: going away
}

TEST_CASE("clients that send what is no message of theirs are sent away", "[live_page][server]") {
  PageServerSettings settings = settings_of(new_page_token());
  settings.most_clients = 32;  // some are still being closed when the next one comes
  const Served served(settings);
  const auto greeted = [&] {
    auto client = std::make_unique<PageClient>(served);
    CHECK(client->read_message() == kGreeting);
    return client;
  };
  for (const char* text : {"", "{", "[]", "{\"want\":1}", "{\"want\":[\"everything\"]}",
                           "{\"things\":[]}", "\xff\xfe"}) {
    INFO(text);
    const auto client = greeted();
    client->send_frame(text);
    CHECK(client->is_closed());
  }
  SECTION("who is told why") {
    const auto client = greeted();
    client->send_frame("{\"want\":[\"everything\"]}");
    CHECK_THAT(client->read_message().value_or(""), Catch::Contains("\"type\":\"error\""));
    CHECK_FALSE(client->read_message().has_value());
  }
  SECTION("by frames that break the protocol") {
    const auto binary = greeted();
    binary->send_frame("{\"want\":[]}", 0x82);
    CHECK(binary->is_closed());
    const auto unmasked = greeted();
    unmasked->send_frame("{\"want\":[]}", 0x81, false);
    CHECK(unmasked->is_closed());
    const auto reserved = greeted();
    reserved->send_frame("{\"want\":[]}", 0xF3);
    CHECK(reserved->is_closed());
    const auto oversized = greeted();
    oversized->send_frame(std::string(5000, ' '));
    CHECK(oversized->is_closed());
    const auto announced = greeted();  // 2^63 bytes, of which none comes
    announced->send(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14));
    CHECK(announced->is_closed());
  }
  CHECK(soon([&] { return !served.server.has_clients(); }));
}

TEST_CASE("requests that are none are answered or ended", "[live_page][server]") {
  const Served served;
  CHECK_THAT(ask(served, "GET / SMTP\r\n\r\n"), Catch::StartsWith("HTTP/1.1 400"));
  CHECK_THAT(ask(served, served.get("", "X: " + std::string(20'000, 'x') + "\r\n")),
             Catch::StartsWith("HTTP/1.1 400"));
  CHECK(ask(served, "GET / HTTP/1.1\r\nHo").empty());  // half a request: closed after a while
  CHECK(ask(served, "").empty());
}

TEST_CASE("as many clients as are served keep others out, until one goes", "[live_page][server]") {
  const Served served;
  auto one = std::make_unique<PageClient>(served);
  const PageClient two(served);
  CHECK_THAT(two.head(), Catch::StartsWith("HTTP/1.1 101"));
  CHECK_THAT(PageClient(served).head(), Catch::StartsWith("HTTP/1.1 503"));
  one.reset();
  CHECK(soon([&] { return PageClient(served).head().starts_with("HTTP/1.1 101"); }));
}

TEST_CASE("hundreds of silent connections end, and then pages are served", "[live_page][server]") {
  const Served served;
  std::vector<std::unique_ptr<PageClient>> silent;
  for (int k = 0; k < 600; ++k)
    silent.push_back(std::make_unique<PageClient>(served.server.port()));
  CHECK(soon([&] { return ask(served, served.get("page.js")).starts_with("HTTP/1.1 200"); }));
}

TEST_CASE("who does not read loses pictures, and is closed; sending never waits",
          "[live_page][server]") {
  Served served;
  PageClient slow(served), reader(served);
  CHECK(slow.read_message() == kGreeting);
  CHECK(reader.read_message() == kGreeting);
  slow.send_frame("{\"want\":[\"picture\"]}");
  REQUIRE(soon([&] { return served.server.wants_pictures(); }));
  const std::string picture(500'000, 'p');
  // Without a limit this would be 10 GB in memory. The reader gets its lines meanwhile.
  int sent = 0;
  for (; sent < 20'000 && served.server.wants_pictures(); ++sent) {
    served.server.send_picture(picture);
    if (sent % 100 == 0) {
      served.server.send_line("{\"a\":1}");
      const auto frame = reader.read_message();
      REQUIRE(frame.has_value());
      CHECK(*frame == "{\"dropped\":0,\"a\":1}");
    }
    std::this_thread::sleep_for(milliseconds(1));
  }
  CHECK(soon([&] { return served.server.counts().closed_behind == 1; }));
  CHECK(served.server.counts().lost_pictures > 0);
}

}  // namespace
}  // namespace palpable
