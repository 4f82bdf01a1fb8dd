/// @file
/// Simulates a full disk.
#pragma once

#include "tests/support/test.h"

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable::test {

/// Limits the size of every file that this program writes: beyond it, writing fails as on a full
/// disk, but with another reason (File too large). The limit ends with the object.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::size_t bytes) {
    handler_ = std::signal(SIGXFSZ, SIG_IGN);  // otherwise a signal ends the program
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

/// Set in a process whose leaks are not checked at its end: HDF5 leaks memory when
/// the disk is full.
inline bool leaks_are_foreign = false;

/// Runs `work` in a process of its own with a limit on the size of its files; the process ends
/// like a complete program, with all exit handlers. Returns the result of `work`, or the
/// negative signal number.
inline int run_with_full_disk(rlim_t bytes, const std::function<int()>& work) {
  const pid_t process = ::fork();
  REQUIRE(process >= 0);
  if (process == 0) {
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::signal(SIGXFSZ, SIG_IGN);
    leaks_are_foreign = true;
    std::exit(work());
  }
  int status = 0;
  REQUIRE(::waitpid(process, &status, 0) == process);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace palpable::test
