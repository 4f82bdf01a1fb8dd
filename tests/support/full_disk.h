/// @file
/// A disk that is full, as far as a program can tell.
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

/// No file of this program grows beyond so many bytes: as on a full disk writing fails, though with
/// another reason (File too large). Ends with the object.
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

/// Set in a process whose leaks are not looked at when it ends: HDF5 that meets a full disk leaves
/// some.
inline bool leaks_are_foreign = false;

/// Runs `work` in a process of its own whose files may have so many bytes; its end is that of a
/// whole program, with all handlers at exit. Returns what `work` does, or minus the signal.
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
