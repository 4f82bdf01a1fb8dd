#include "palpable/live/page/folder_server.h"

#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <netinet/in.h>
#include <span>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr int kMostWaiting = 64;             // connections that the system queues
constexpr int kMostOpen = 64;                // connections that are answered at once
constexpr std::size_t kLongestHead = 16384;  // bytes
constexpr timeval kPatience{10, 0};          // for a client that sends or reads nothing

struct MediaType {
  std::string_view ending, type;
};
constexpr std::array<MediaType, 9> kMediaTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".wasm", "application/wasm"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".txt", "text/plain; charset=utf-8"},
}};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

// The value of the only header of that name; nothing if there is none, or more than one.
std::optional<std::string_view> only_header(std::string_view lines, std::string_view name) {
  std::optional<std::string_view> found;
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find("\r\n"), lines.size());
    const std::string_view line = lines.substr(0, end);
    lines.remove_prefix(std::min(end + 2, lines.size()));
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || lower(line.substr(0, colon)) != name) continue;
    if (found) return std::nullopt;
    found = trimmed(line.substr(colon + 1));
  }
  return found;
}

std::optional<std::string> decoded(std::string_view text) {
  const auto digit = [](char c) {
    const std::string_view digits = "0123456789abcdef";
    return digits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
  };
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] != '%') {
      result += text[k];
      continue;
    }
    if (k + 2 >= text.size()) return std::nullopt;
    const std::size_t high = digit(text[k + 1]), low = digit(text[k + 2]);
    if (high == std::string_view::npos || low == std::string_view::npos) return std::nullopt;
    result += static_cast<char>(16 * high + low);
    k += 2;
  }
  return result;
}

bool send_text(int connection, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(connection, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

// The head of a request; what could be read of it if the client is too slow, or sends too much.
std::string receive_head(int connection) {
  std::string head;
  std::array<char, 2048> piece{};
  while (head.size() < kLongestHead && head.find("\r\n\r\n") == std::string::npos) {
    const ssize_t got = ::recv(connection, piece.data(), piece.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    head.append(piece.data(), static_cast<std::size_t>(got));
  }
  return head;
}

void send_refusal(int connection, int status) {
  const std::string text = fmt::format("{} {}\n", status, reason_of_status(status));
  send_text(connection, fmt::format("HTTP/1.1 {} {}\r\nContent-Type: text/plain\r\nContent-Length: "
                                    "{}\r\nConnection: close\r\n\r\n{}",
                                    status, reason_of_status(status), text.size(), text));
}

void send_file(int connection, const fs::path& path, bool with_content) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat facts {};
  if (file < 0 || ::fstat(file, &facts) != 0) {
    if (file >= 0) ::close(file);
    return send_refusal(connection, 404);
  }
  const std::string head = fmt::format(
      "HTTP/1.1 200 OK\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\n"
      "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
      media_type_of(path), facts.st_size);
  off_t done = 0;
  bool goes_on = send_text(connection, head) && with_content;
  while (goes_on && done < facts.st_size) {
    const auto left = static_cast<std::size_t>(facts.st_size - done);
    const ssize_t sent = ::sendfile(connection, file, &done, left);
    goes_on = sent > 0 || (sent < 0 && errno == EINTR);
  }
  ::close(file);
}

}  // namespace

std::string_view reason_of_status(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 503:
      return "Service Unavailable";
    default:
      return "Bad Request";
  }
}

bool names_this_machine(std::string_view host, int port) {
  const std::string asked = lower(host);
  const auto is_us = [&](std::string_view name) {
    return asked == fmt::format("{}:{}", name, port) || (port == 80 && asked == name);
  };
  return is_us("127.0.0.1") || is_us("localhost");
}

std::variant<FileRequest, Refusal> read_file_request(std::string_view head, int port) {
  const std::size_t end = head.find("\r\n\r\n"), first = head.find("\r\n");
  if (end == std::string_view::npos) return Refusal{400};
  const std::string_view line = head.substr(0, first);
  const std::size_t one = line.find(' '), two = line.rfind(' ');
  if (one == std::string_view::npos || two == one || !line.substr(two).starts_with(" HTTP/1.")) {
    return Refusal{400};
  }
  const std::string_view method = line.substr(0, one), target = line.substr(one + 1, two - one - 1);
  if (target.empty() || target.front() != '/') return Refusal{400};
  const auto host = only_header(head.substr(first + 2, end - first), "host");
  if (!host || !names_this_machine(*host, port)) return Refusal{403};
  if (method != "GET" && method != "HEAD") return Refusal{405};
  return FileRequest{method == "GET", std::string(target)};
}

std::optional<fs::path> file_of_target(const fs::path& folder, std::string_view target) {
  const auto path = decoded(target.substr(0, target.find_first_of("?#")));
  if (!path || path->empty() || path->front() != '/' || path->find('\0') != std::string::npos) {
    return std::nullopt;
  }
  std::error_code trouble;
  const fs::path root = fs::canonical(folder, trouble);
  if (trouble) return std::nullopt;
  fs::path file = root / path->substr(std::min(path->find_first_not_of('/'), path->size()));
  if (path->back() == '/') file /= "index.html";
  file = fs::canonical(file, trouble);  // links and ".." are gone after this
  if (trouble || !lies_in(file, root) || !fs::is_regular_file(file, trouble)) return std::nullopt;
  return file;
}

std::string_view media_type_of(const fs::path& file) {
  const std::string ending = file.extension().string();
  for (const MediaType& known : kMediaTypes) {
    if (known.ending == ending) return known.type;
  }
  return "application/octet-stream";
}

FolderServer::FolderServer(fs::path folder, int port) : folder_(std::move(folder)) {
  listening_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  auto* plain = reinterpret_cast<sockaddr*>(&address);  // NOLINT(*-reinterpret-cast)
  socklen_t size = sizeof(address);
  // Permits the port although closed connections of an earlier run may still be in TIME_WAIT.
  const int yes = 1;
  ::setsockopt(listening_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (listening_ < 0 || ::bind(listening_, plain, size) != 0 ||
      ::listen(listening_, kMostWaiting) != 0 || ::getsockname(listening_, plain, &size) != 0) {
    const std::string why = std::strerror(errno);
    if (listening_ >= 0) ::close(listening_);
    throw Error(
        fmt::format("127.0.0.1:{}: cannot be listened on: {}; 0 finds a free port", port, why));
  }
  port_ = ntohs(address.sin_port);
}

FolderServer::~FolderServer() {
  stop();
  while (open_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::close(listening_);
}

void FolderServer::run() {
  while (!stopped_) {
    const int connection = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) {
      // Out of descriptors, for example: others are closed in the meantime.
      if (!stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    if (open_ >= kMostOpen) {
      ::close(connection);
      continue;
    }
    ++open_;
    try {
      std::thread([this, connection] {
        answer(connection);
        ::close(connection);
        --open_;  // the last: from here on this object may be gone
      }).detach();
    } catch (const std::system_error&) {  // no more threads
      ::close(connection);
      --open_;
    }
  }
}

void FolderServer::stop() {
  stopped_ = true;
  ::shutdown(listening_, SHUT_RDWR);  // accept4() returns
}

void FolderServer::answer(int connection) const {
  for (const int way : {SO_RCVTIMEO, SO_SNDTIMEO}) {
    ::setsockopt(connection, SOL_SOCKET, way, &kPatience, sizeof(kPatience));
  }
  const std::string head = receive_head(connection);
  if (head.empty()) return;
  try {
    const auto request = read_file_request(head, port_);
    if (const auto* refusal = std::get_if<Refusal>(&request)) {
      return send_refusal(connection, refusal->status);
    }
    const auto& asked = std::get<FileRequest>(request);
    const auto file = file_of_target(folder_, asked.target);
    if (!file) return send_refusal(connection, 404);
    send_file(connection, *file, asked.with_content);
  } catch (const std::exception&) { send_refusal(connection, 404); }
}

}  // namespace palpable
