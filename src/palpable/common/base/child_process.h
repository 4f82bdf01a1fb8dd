/// @file
/// A program that this one starts and talks to: its standard input and output are one stream of
/// bytes, its messages for people go where ours go.
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

/// Ends with this object: killed if it still runs, and waited for. Nothing here allocates, blocks
/// (but receive(), as long as it is told to) or raises SIGPIPE, except start() and how_it_ended().
class ChildProcess {
 public:
  [[nodiscard]] static Result<ChildProcess> start(const std::filesystem::path& program,
                                                  const std::vector<std::string>& arguments);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ~ChildProcess();

  /// False where not all bytes are taken at once: it has ended, or does not read.
  [[nodiscard]] bool send(std::span<const std::byte> bytes);
  /// How many bytes were there, at most as many as there is room for; 0: none came within `wait`
  /// (s). Nothing: it has closed its output, and nothing comes any more.
  [[nodiscard]] std::optional<std::size_t> receive(std::span<std::byte> room, double wait);
  /// "with exit code 1", "by signal 11 (Segmentation fault)", "by closing its output": once
  /// receive() has told that.
  [[nodiscard]] std::string how_it_ended();

 private:
  ChildProcess(pid_t pid, int socket) : pid_(pid), socket_(socket) {}

  pid_t pid_ = -1;  // -1: was waited for
  int socket_ = -1;
};

}  // namespace palpable
