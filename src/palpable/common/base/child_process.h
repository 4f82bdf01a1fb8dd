/// @file
/// A child process with which this program exchanges bytes through the child's standard input and
/// output. The child's standard error is that of this program.
#pragma once

#include "palpable/common/base/error.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <sys/types.h>
#include <vector>

namespace palpable {

/// The destructor kills the child if it still runs, and waits for its end. Except for start() and
/// how_it_ended(), no member allocates, blocks (receive() only for the given time) or raises
/// SIGPIPE.
class ChildProcess {
 public:
  [[nodiscard]] static Result<ChildProcess> start(const std::filesystem::path& program,
                                                  const std::vector<std::string>& arguments);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  /// False if not all bytes were accepted at once: the child has ended, or does not read.
  [[nodiscard]] bool send(std::span<const std::byte> bytes);
  /// Number of bytes received into `room`; 0 if none came within `wait` (s). Nothing if the child
  /// has closed its output.
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> room, double wait);
  /// "with exit code 1", "by signal 11 (Segmentation fault)" or "by closing its output". To be
  /// called after receive() has returned nothing.
  [[nodiscard]] std::string how_it_ended();

 private:
  ChildProcess(pid_t pid, int socket) : pid_(pid), socket_(socket) {}

  pid_t pid_ = -1;  // -1: already waited for
  int socket_ = -1;
};

}  // namespace palpable
