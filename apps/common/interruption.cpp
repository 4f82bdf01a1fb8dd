#include "apps/common/interruption.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

namespace palpable::app {
namespace {

constexpr std::array kEndingSignals{SIGINT, SIGTERM, SIGHUP};

// Composed before, because a signal handler may neither allocate nor format.
std::string line_at_end;
std::string file_removed_at_end;
// A forked child, such as the mesher's, receives the user's Ctrl-C too, but says nothing.
pid_t process_that_says = 0;

extern "C" void say_and_end(int signal) {
  // SA_RESETHAND has restored what the signal does otherwise.
  if (::getpid() == process_that_says) {
    static_cast<void>(::write(STDERR_FILENO, line_at_end.data(), line_at_end.size()) < 0);
    struct stat there {};  // a file with content is somebody's
    if (!file_removed_at_end.empty() && ::stat(file_removed_at_end.c_str(), &there) == 0 &&
        there.st_size == 0) {
      ::unlink(file_removed_at_end.c_str());
    }
  }
  ::raise(signal);
}

void set_handler(int signal, void (*handler)(int)) {
  struct sigaction before {};
  if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  ::sigaction(signal, &action, nullptr);
}

}  // namespace

InterruptionNote::InterruptionNote(const std::string& line, const std::string& removed) {
  PALPABLE_EXPECT(line_at_end.empty(), "a program ends once");
  if (line.empty()) return;
  process_that_says = ::getpid();
  file_removed_at_end = removed;
  // On a terminal a bar of progress is open, whose line is ended first.
  line_at_end = (::isatty(STDERR_FILENO) != 0 ? "\n" : "") + ("palpable: " + line + "\n");
  for (const int signal : kEndingSignals) set_handler(signal, say_and_end);
}

InterruptionNote::~InterruptionNote() {
  for (const int signal : kEndingSignals) set_handler(signal, SIG_DFL);
  line_at_end.clear();
  file_removed_at_end.clear();
}

std::string quoted_for_shell(const std::string& word) {
  constexpr std::string_view kPlain = "_-+=./:,@%";
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [&](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
           static_cast<signed char>(c) < 0 || kPlain.find(c) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace palpable::app
