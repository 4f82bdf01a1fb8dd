#include "palpable/live/page/folder_server.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <variant>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

constexpr int kPort = 8080;

int status_of(const std::string& head) {
  const auto read = read_file_request(head, kPort);
  const auto* refusal = std::get_if<Refusal>(&read);
  return refusal != nullptr ? refusal->status : 200;
}

std::string get(std::string_view target, std::string_view host = "127.0.0.1:8080") {
  return fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", target, host);
}

// A client that sends a text and reads until the other side ends.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    REQUIRE(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { ::close(socket_); }
  std::string ask(const std::string& text) {
    REQUIRE(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(text.size()));
    std::string answer;
    std::array<char, 4096> piece{};
    for (ssize_t got = 0; (got = ::recv(socket_, piece.data(), piece.size(), 0)) > 0;) {
      answer.append(piece.data(), static_cast<std::size_t>(got));
    }
    return answer;
  }

 private:
  int socket_;
};

TEST_CASE("a request for this machine is read", "[page][server]") {
  const auto read = read_file_request(get("/page.js?x"), kPort);
  REQUIRE(std::holds_alternative<FileRequest>(read));
  CHECK(std::get<FileRequest>(read).target == "/page.js?x");
  CHECK(std::get<FileRequest>(read).with_content);
  CHECK(status_of(get("/", "LocalHost:8080")) == 200);
  CHECK(status_of("HEAD / HTTP/1.0\r\nhost:127.0.0.1:8080 \r\n\r\n") == 200);
}

TEST_CASE("a page of another site cannot read from this machine", "[page][server]") {
  CHECK(status_of(get("/", "evil.example:8080")) == 403);
  CHECK(status_of(get("/", "127.0.0.1:8081")) == 403);
  CHECK(status_of(get("/", "127.0.0.1")) == 403);
  CHECK(status_of(get("/", "127.0.0.1:8080.evil.example")) == 403);
  CHECK(status_of("GET / HTTP/1.1\r\n\r\n") == 403);
  CHECK(status_of("GET / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nHost: evil.example\r\n\r\n") == 403);
}

TEST_CASE("what is no request for a file is refused", "[page][server]") {
  CHECK(status_of("POST / HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n\r\n") == 405);
  for (const char* head :
       {"", "GET", "GET /", "GET / HTTP/1.1\r\n", "\r\n\r\n", " \r\n\r\n", "GET / SMTP\r\n\r\n",
        "GET http://x/ HTTP/1.1\r\n\r\n", "GET  HTTP/1.1\r\n\r\n"}) {
    INFO(head);
    CHECK(status_of(head) == 400);
  }
}

TEST_CASE("only files of the folder are found", "[page][server]") {
  const ScratchFolder folder("page");
  test::write_bytes(folder / "page/index.html", "hello");
  test::write_bytes(folder / "page/a b.js", "1");
  test::write_bytes(folder / "secret", "2");
  fs::create_symlink(folder / "secret", folder / "page/link");
  const fs::path page = folder / "page";
  CHECK(file_of_target(page, "/") == fs::canonical(page / "index.html"));
  CHECK(file_of_target(page, "/?x=1") == fs::canonical(page / "index.html"));
  CHECK(file_of_target(page, "/a%20b.js").has_value());
  for (const char* target : {"/../secret", "/%2e%2e/secret", "/..%2fsecret", "/link", "//../secret",
                             "/none", "", "/%", "/%0", "/%zz", "/index.html%00", "/."}) {
    INFO(target);
    CHECK_FALSE(file_of_target(page, target).has_value());
  }
}

TEST_CASE("files are served with the type that browsers want", "[page][server]") {
  const ScratchFolder folder("page");
  test::write_bytes(folder / "index.html", "hello");
  test::write_bytes(folder / "palpable.wasm", std::string(300'000, 'w'));
  FolderServer server(folder.path(), 0);
  std::thread answers([&] { server.run(); });
  const std::string host = fmt::format("127.0.0.1:{}", server.port());
  {
    const Client silent(server.port());  // as browsers open some ahead
    const std::string page = Client(server.port()).ask(get("/", host));
    CHECK(page.starts_with(
        "HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: 5\r\n"));
    CHECK(page.ends_with("\r\n\r\nhello"));
    const std::string core = Client(server.port()).ask(get("/palpable.wasm", host));
    CHECK(core.find("Content-Type: application/wasm\r\n") != std::string::npos);
    CHECK(core.ends_with("\r\n\r\n" + std::string(300'000, 'w')));
    CHECK(Client(server.port()).ask(get("/none", host)).starts_with("HTTP/1.1 404"));
    CHECK(Client(server.port()).ask(get("/", "evil.example")).starts_with("HTTP/1.1 403"));
    CHECK(Client(server.port()).ask(std::string(20'000, 'x')).starts_with("HTTP/1.1 400"));
  }
  server.stop();
  answers.join();
}

}  // namespace
}  // namespace palpable
