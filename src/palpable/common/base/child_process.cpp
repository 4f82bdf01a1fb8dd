#include "palpable/common/base/child_process.h"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

constexpr int kEnds = 200;  // ms: how long a child may take to end after it has closed its output

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::filesystem::path& program,
                                         const std::vector<std::string>& arguments) {
  const auto problem = [&](int error) {
    return Problem{fmt::format("cannot start {}: {}", program.string(), std::strerror(error))};
  };
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return problem(errno);
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO})
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], stream);
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, program.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    return problem(error);
  }
  return ChildProcess(pid, ends[0]);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), socket_(std::exchange(other.socket_, -1)) {}

ChildProcess::~ChildProcess() {
  if (socket_ >= 0) ::close(socket_);
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {}
}

bool ChildProcess::send(std::span<const std::byte> bytes) {
  const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(bytes.size());
}

std::optional<std::size_t> ChildProcess::receive(std::span<std::byte> room, double wait) {
  pollfd ready{.fd = socket_, .events = POLLIN, .revents = 0};
  const int found = ::poll(&ready, 1, static_cast<int>(std::ceil(1e3 * std::max(0.0, wait))));
  if (found < 0 && errno != EINTR) return std::nullopt;
  if (found <= 0) return 0;
  const ssize_t count = ::recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
  if (count > 0) return static_cast<std::size_t>(count);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  return std::nullopt;
}

std::string ChildProcess::how_it_ended() {
  int status = 0;
  for (int waited = 0; waited < kEnds && pid_ > 0; ++waited) {
    const pid_t found = ::waitpid(pid_, &status, WNOHANG);
    if (found == pid_) {
      pid_ = -1;
      if (WIFSIGNALED(status)) {
        return fmt::format("by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
      }
      return fmt::format("with exit code {}", WEXITSTATUS(status));
    }
    ::poll(nullptr, 0, 1);
  }
  return "by closing its output";
}

}  // namespace palpable
