#include "palpable/live/events/event_server.h"

#include "palpable/common/base/json.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <tuple>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnix = "unix:";
constexpr int kMostWaiting = 64;  // connections that the system queues until they are accepted
// Limits of one call, so that many clients or much input cannot delay a frame: accepting a
// connection takes about 20 us, reading 4 KiB about 1 us.
constexpr int kMostLetIn = 32;
constexpr int kMostReads = 4;
constexpr int kMostReadsOfLines = 16;  // 64 KiB
// Bytes that the system buffers for a client that does not read. A larger buffer would only hold
// lines that are outdated when they are read.
constexpr int kSendBuffer = 64 * 1024;  // bytes
constexpr std::string_view kFull =
    "{\"type\":\"refused\",\"reason\":\"as many clients as are served are connected already\"}\n";

std::string reason() { return std::strerror(errno); }

// A file descriptor, closed by the destructor unless keep() was called.
class Opened {
 public:
  explicit Opened(int descriptor) : descriptor_(descriptor) {}
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] int get() const { return descriptor_; }
  int keep() { return std::exchange(descriptor_, -1); }

 private:
  int descriptor_;
};

int new_socket(int family) {
  return ::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

// The type by which the system's functions take addresses of all kinds.
template <class Address>
auto* plain(Address& address) {
  return reinterpret_cast<sockaddr*>(&address);  // NOLINT(*-reinterpret-cast)
}

// Removes the file of a socket on which no process listens. @throws Error for anything else there
void remove_dead(const fs::path& path, sockaddr_un& address) {
  struct stat there {};
  if (::lstat(path.c_str(), &there) != 0) return;  // bind() reports any other problem
  if (!S_ISSOCK(there.st_mode)) {
    throw Error(
        fmt::format("{}: is in the way and is no socket; name another file", path.string()));
  }
  const Opened probe(new_socket(AF_UNIX));
  if (::connect(probe.get(), plain(address), sizeof(address)) == 0 || errno == EAGAIN) {
    throw Error(fmt::format("{}: another program listens there; end it, or name another file",
                            path.string()));
  }
  if (errno != ECONNREFUSED || ::unlink(path.c_str()) != 0) {
    throw Error(fmt::format("{}: is in the way: {}; name another file", path.string(), reason()));
  }
}

}  // namespace

Result<EventAddress> event_address(const std::string& text) {
  if (text.starts_with(kUnix) && text.size() > kUnix.size()) {
    return EventAddress{.socket = text.substr(kUnix.size())};
  }
  const auto port = to_whole_number(text);
  if (!port || *port < 0 || *port > 65535) {
    return Problem{
        fmt::format("'{}' is neither a port from 0 (any free one) to 65535 nor unix:PATH", text)};
  }
  return EventAddress{.port = static_cast<int>(*port)};
}

EventServer::EventServer(const EventAddress& address, const EventServerSettings& settings)
    : settings_(settings) {
  PALPABLE_EXPECT(settings.most_clients >= 1, "somebody may connect");
  clients_.reserve(static_cast<std::size_t>(settings.most_clients));
  if (address.socket.empty()) {
    listen_at_port(address.port);
  } else {
    listen_at(address.socket);
  }
}

EventServer::~EventServer() {
  for (Client& client : clients_) {
    read_input(client, client.took);  // TCP discards unsent data on close() if input is unread
    send_rest(client, client.took);
    ::close(client.descriptor);
  }
  ::close(listening_);
  struct stat there {};
  if (!socket_.empty() && ::lstat(socket_.c_str(), &there) == 0 && there.st_dev == device_ &&
      there.st_ino == inode_) {
    ::unlink(socket_.c_str());
  }
}

void EventServer::listen_at(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof(address.sun_path)) {
    throw Error(
        fmt::format("{}: has {} bytes, and the name of a socket at most {}; name one nearer "
                    "to the folder that you are in, or to /",
                    name, name.size(), sizeof(address.sun_path) - 1));
  }
  name.copy(address.sun_path, name.size());
  remove_dead(path, address);
  Opened opened(new_socket(AF_UNIX));
  // bind() makes the file with the mode set here: at no moment may others connect.
  if (opened.get() < 0 || ::fchmod(opened.get(), S_IRUSR | S_IWUSR) != 0 ||
      ::bind(opened.get(), plain(address), sizeof(address)) != 0) {
    throw Error(fmt::format("{}: cannot be listened on: {}", name, reason()));
  }
  struct stat made {};
  if (::listen(opened.get(), kMostWaiting) != 0 || ::lstat(name.c_str(), &made) != 0) {
    const std::string why = reason();
    ::unlink(name.c_str());
    throw Error(fmt::format("{}: cannot be listened on: {}", name, why));
  }
  socket_ = path;
  device_ = made.st_dev;
  inode_ = made.st_ino;
  listening_ = opened.keep();
  name_ = fmt::format("{}{}", kUnix, name);
}

void EventServer::listen_at_port(int port) {
  Opened opened(new_socket(AF_INET));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  // Permits the port although closed connections of an earlier run may still be in TIME_WAIT.
  const int yes = 1;
  ::setsockopt(opened.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  socklen_t size = sizeof(address);
  if (opened.get() < 0 || ::bind(opened.get(), plain(address), sizeof(address)) != 0 ||
      ::listen(opened.get(), kMostWaiting) != 0 ||
      ::getsockname(opened.get(), plain(address), &size) != 0) {
    throw Error(fmt::format("127.0.0.1:{}: cannot be listened on: {}; 0 finds a free port", port,
                            reason()));
  }
  listening_ = opened.keep();
  name_ = fmt::format("127.0.0.1:{}", ntohs(address.sin_port));
}

void EventServer::greet_with(std::string hello) { hello_ = std::move(hello); }

void EventServer::serve(Clock::time_point now) {
  for (Client& client : clients_) {
    read_input(client, now);
    send_rest(client, now);
    if (client.refused && client.unsent.empty()) {
      // It can read why; then its side ends, and it is closed once it has noticed.
      ::shutdown(client.descriptor, SHUT_WR);
      client.gone |= client.input_ended;
    } else if (client.unsent.empty()) {
      client.took = now;
    }
    if (!client.gone && now - client.took > settings_.patience) {
      client.gone = true;
      if (!client.refused) ++counts_.closed_behind;
    }
  }
  close_gone();
  if (!hello_.empty()) let_in(now);
}

void EventServer::send(std::string_view line, Clock::time_point now) {
  PALPABLE_EXPECT(line.size() > 4 && line.front() == '{' && line.ends_with("}\n"),
                  "a line is one object that holds something");
  serve(now);
  for (Client& client : clients_) send_to(client, line);
  close_gone();
}

void EventServer::send(std::string_view line, std::uint64_t one, std::string_view line_of_one,
                       Clock::time_point now) {
  serve(now);
  for (Client& client : clients_) send_to(client, client.number == one ? line_of_one : line);
  close_gone();
}

std::optional<SentLine> EventServer::next_line() {
  const std::size_t count = clients_.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = (turn_ + i) % count;
    Client& client = clients_[index];
    if (!client.has_line || client.refused) continue;
    client.has_line = false;
    turn_ = index + 1;
    return SentLine{client.number, client.line, std::exchange(client.skipped, 0)};
  }
  return std::nullopt;
}

const EventServer::Client* EventServer::find(std::uint64_t client) const {
  const auto found = std::find_if(clients_.begin(), clients_.end(),
                                  [&](const Client& other) { return other.number == client; });
  return found != clients_.end() ? &*found : nullptr;
}

void EventServer::refuse(std::uint64_t client, std::string_view reason, Clock::time_point now) {
  for (Client& other : clients_) {
    if (other.number == client) refuse(other, reason, now);
  }
}

void EventServer::refuse(Client& client, std::string_view reason, Clock::time_point now) {
  if (client.refused || client.gone) return;
  client.refused = true;
  client.has_line = false;
  client.input = {};
  client.line = {};
  client.took = now;  // from now on it has the usual patience to read
  ++counts_.sent_away;
  client.unsent += Json{{"type", "error"}, {"reason", std::string(reason)}}.dump() + "\n";
  send_rest(client, now);
}

bool EventServer::may_send(std::uint64_t client) const {
  const Client* found = find(client);
  return found != nullptr && !found->gone && !found->refused &&
         (found->has_line || !found->input_ended);
}

void EventServer::wait(std::chrono::milliseconds longest) {
  polled_.clear();
  polled_.push_back({listening_, POLLIN, 0});
  for (const Client& client : clients_) {
    const int events = (client.input_ended ? 0 : POLLIN) | (client.unsent.empty() ? 0 : POLLOUT);
    if (events != 0) polled_.push_back({client.descriptor, static_cast<short>(events), 0});
  }
  std::ignore = ::poll(polled_.data(), polled_.size(), static_cast<int>(longest.count()));
}

void EventServer::let_in(Clock::time_point now) {
  for (int i = 0; i < kMostLetIn; ++i) {
    Opened opened(::accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (opened.get() < 0) {
      if (errno == ECONNABORTED || errno == EINTR) continue;
      return;  // none is waiting, or too many files are open: then they stay queued
    }
    if (client_count() == settings_.most_clients) make_room();
    if (client_count() == settings_.most_clients) {
      ++counts_.refused;
      std::ignore = ::send(opened.get(), kFull.data(), kFull.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      continue;
    }
    ::setsockopt(opened.get(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof(kSendBuffer));
    const int yes = 1;  // send small lines at once; fails harmlessly for a Unix socket
    ::setsockopt(opened.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    Client& client = clients_.emplace_back();
    client.number = next_number_++;
    client.descriptor = opened.keep();
    client.unsent = hello_;
    client.took = now;
    ++counts_.clients;
    send_rest(client, now);
  }
}

// A client that has closed its sending side may still read, but most likely it has ended; only
// sending to it would tell. It is disconnected when another client needs its slot.
void EventServer::make_room() {
  const auto quiet = std::find_if(clients_.begin(), clients_.end(), [](const Client& client) {
    return client.refused || (client.input_ended && !client.has_line);
  });
  if (quiet == clients_.end()) return;
  quiet->gone = true;
  close_gone();
}

void EventServer::send_to(Client& client, std::string_view line) {
  if (client.gone || client.refused) return;
  if (!client.unsent.empty()) {
    ++client.dropped;
    ++counts_.dropped_lines;
    return;
  }
  std::array<char, 48> begin{};
  const auto written =
      fmt::format_to_n(begin.data(), begin.size(), "{{\"dropped\":{},", client.dropped);
  const std::string_view rest = line.substr(1);
  // sendmsg() only reads the pieces, although iovec's type is not const.
  std::array<iovec, 2> pieces{
      {{begin.data(), written.size}, {const_cast<char*>(rest.data()), rest.size()}}};  // NOLINT
  msghdr message{};
  message.msg_iov = pieces.data();
  message.msg_iovlen = pieces.size();
  const ssize_t count = ::sendmsg(client.descriptor, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOBUFS) {
    client.gone = true;
    return;
  }
  client.dropped = 0;
  client.sent = count < 0 ? 0 : static_cast<std::size_t>(count);
  if (client.sent == written.size + rest.size()) {
    client.sent = 0;  // of `unsent`, which is empty
    return;
  }
  client.unsent.assign(begin.data(), written.size).append(rest);
}

void EventServer::read_input(Client& client, Clock::time_point now) {
  std::array<char, 4096> input{};
  const int most = settings_.takes_lines ? kMostReadsOfLines : kMostReads;
  for (int i = 0; i < most && !client.input_ended; ++i) {
    const ssize_t count = ::recv(client.descriptor, input.data(), input.size(), MSG_DONTWAIT);
    if (count == 0) client.input_ended = true;
    if (count < 0 && (errno == ECONNRESET || errno == ETIMEDOUT)) client.gone = true;
    if (count <= 0) return;
    if (settings_.takes_lines && !client.refused) {
      keep_lines(client, {input.data(), static_cast<std::size_t>(count)}, now);
    }
  }
}

// Keeps the newest whole line, and the beginning of the next one.
void EventServer::keep_lines(Client& client, std::string_view bytes, Clock::time_point now) {
  const std::size_t end = bytes.rfind('\n');
  if (end != std::string_view::npos) {
    const std::string_view whole = bytes.substr(0, end);
    const std::size_t before = whole.rfind('\n');
    client.skipped += static_cast<int>(std::count(whole.begin(), whole.end(), '\n'));
    client.skipped += client.has_line ? 1 : 0;
    if (before == std::string_view::npos) {
      client.line.assign(client.input).append(whole);
    } else {
      client.line.assign(whole.substr(before + 1));
    }
    client.has_line = true;
    client.input.clear();
    bytes.remove_prefix(end + 1);
  }
  client.input.append(bytes);
  if (std::max(client.input.size(), client.line.size()) > settings_.longest_line) {
    refuse(client, fmt::format("a line has more than {} bytes", settings_.longest_line), now);
  }
}

void EventServer::send_rest(Client& client, Clock::time_point now) {
  while (!client.gone && !client.unsent.empty()) {
    const std::string_view rest = std::string_view(client.unsent).substr(client.sent);
    const ssize_t count =
        ::send(client.descriptor, rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0) {
      client.gone = errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOBUFS;
      return;
    }
    client.took = now;
    client.sent += static_cast<std::size_t>(count);
    if (client.sent < client.unsent.size()) continue;
    client.unsent.clear();
    client.sent = 0;
  }
}

void EventServer::close_gone() {
  for (const Client& client : clients_) {
    if (client.gone) ::close(client.descriptor);
  }
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
}

}  // namespace palpable
