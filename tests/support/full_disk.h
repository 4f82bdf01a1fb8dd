/// @file
/// A disk that is full, as far as a program can tell.
#pragma once

#include <csignal>
#include <cstddef>
#include <sys/resource.h>

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

}  // namespace palpable::test
