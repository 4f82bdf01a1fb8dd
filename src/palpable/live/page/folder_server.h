/// @file
/// Serves the files of a folder over HTTP to browsers on this machine (palpable serve): a page may
/// not fetch from a disk.
///
/// It listens on 127.0.0.1 and answers requests to that name alone: a page of another site that has
/// its name point here (DNS rebinding) is refused by the header Host. GET and HEAD only, one
/// request for each connection.
#pragma once

#include "palpable/common/base/error.h"

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace palpable {

/// Whether the value of a header Host names this machine and a port of it: "127.0.0.1:PORT" or
/// "localhost:PORT", of port 80 also without it.
[[nodiscard]] bool names_this_machine(std::string_view host, int port);

/// What a request asks for.
struct FileRequest {
  bool with_content = true;  ///< GET; false: HEAD
  std::string target;        ///< "/page.js?x": as sent
};

/// The status of HTTP with which a request is refused.
struct Refusal {
  int status = 400;
};

/// Reads the head of a request, up to its empty line.
/// @param port  on which it came: the header Host must name this machine and it
/// @return the request; or 400 for what is no request, 405 for another method, 403 for another host
[[nodiscard]] std::variant<FileRequest, Refusal> read_file_request(std::string_view head, int port);

/// The words of HTTP for a status that servers of pages send: "Not Found" for 404.
[[nodiscard]] std::string_view reason_of_status(int status);

/// The file for a target: "/" is index.html. Nothing for one that does not exist, that is no
/// regular file, or that lies outside of the folder, by ".." or by a link.
[[nodiscard]] std::optional<std::filesystem::path> file_of_target(
    const std::filesystem::path& folder, std::string_view target);

/// By a file's ending: "application/wasm" lets browsers compile while they fetch.
[[nodiscard]] std::string_view media_type_of(const std::filesystem::path& file);

class FolderServer {
 public:
  /// @param port  0: any free one
  /// @throws Error "127.0.0.1:PORT: cannot be listened on: REASON"
  FolderServer(std::filesystem::path folder, int port);
  FolderServer(const FolderServer&) = delete;
  FolderServer& operator=(const FolderServer&) = delete;
  /// Waits for the connections that are open.
  ~FolderServer();

  [[nodiscard]] int port() const { return port_; }
  /// Answers until stop() is called, each connection on a thread of its own: browsers open some
  /// ahead, without a request, which must not block the others.
  void run();
  /// From any thread.
  void stop();

 private:
  void answer(int connection) const;

  std::filesystem::path folder_;
  int listening_ = -1;
  int port_ = 0;
  std::atomic<bool> stopped_ = false;
  std::atomic<int> open_ = 0;  // connections
};

}  // namespace palpable
