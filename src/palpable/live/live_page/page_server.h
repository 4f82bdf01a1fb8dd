/// @file
/// Serves the page of a running session on 127.0.0.1, and sends the session to it by WebSocket.
///
///     http://127.0.0.1:PORT/TOKEN/            the files
///     ws://127.0.0.1:PORT/TOKEN/live          the session
///
/// Whatever clients do, no function blocks: a thread of the server's own talks to them. It accepts
/// a bounded number of connections, keeps a bounded queue for each (client_queue.h), and ends those
/// that are silent or send what is no message of theirs. Uses Boost.Beast, in page_server.cpp
/// alone.
#pragma once

#include "palpable/common/base/error.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The address of the WebSocket relative to the page's.
inline constexpr std::string_view kLiveSocket = "live";

/// One file of the page.
struct ServedFile {
  std::string name;  ///< "page.js"; empty: the page itself
  std::string type;  ///< of media
  std::string bytes;
};

struct PageServerSettings {
  int port = 0;       ///< of 127.0.0.1; 0: any free one
  std::string token;  ///< new_page_token()
  std::vector<ServedFile> files;
  int most_clients = 8;       ///< of the WebSocket
  int most_connections = 64;  ///< of all kinds; more are closed at once
  /// Of lines that wait for a client, bytes.
  std::size_t most_line_bytes = std::size_t{1} << 20;
  /// A connection that has sent no whole request after this time is closed, and a client that has
  /// answered no ping for twice as long.
  std::chrono::milliseconds patience{5000};
};

struct PageCounts {
  int clients = 0;                                 ///< of the WebSocket, accepted
  int refused = 0;                                 ///< because of most_clients, or by page_access()
  int closed_behind = 0;                           ///< because they were silent or did not read
  int sent_away = 0;                               ///< for what they sent
  std::int64_t lost_lines = 0, lost_pictures = 0;  ///< sums over all clients
};

class PageServer {
 public:
  /// Listens. Connections wait until begin(). @throws Error "127.0.0.1:PORT: cannot be listened on:
  /// REASON"
  explicit PageServer(PageServerSettings settings);
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;
  /// Sends what waits, for half a second at most, and closes all connections.
  ~PageServer();

  [[nodiscard]] int port() const;
  [[nodiscard]] const std::string& token() const;

  /// Answers from now on. Called again for another session: clients that are there are greeted with
  /// it, too, after what was sent before, and get no skin of the earlier one any more.
  /// @param greetings  lines of JSON without line breaks, which each client gets first
  /// @param mesh       a binary message for clients that want skins (skin_message.h), sent to each
  ///                   once a session
  void begin(std::vector<std::string> greetings, std::string mesh);

  // From any thread. They copy and do not wait; memory is reused from call to call.

  [[nodiscard]] bool has_clients() const;
  [[nodiscard]] bool wants_pictures() const;  ///< some client does
  [[nodiscard]] bool wants_skins() const;
  /// How often a client has come, or has begun to want more: grows where there may be somebody who
  /// has not got the last frame.
  [[nodiscard]] std::uint64_t arrivals() const;
  /// @param line      of JSON, with or without its line break (ClientQueue::add_line())
  /// @param is_frame  whether it is the line of a frame (send_missed_line())
  void send_line(std::string_view line, bool is_frame = true);
  /// Sends the line of the last frame to those clients alone who have got no line of a frame since
  /// the session began.
  void send_missed_line(std::string_view line);
  void send_skin(std::string_view message);
  void send_picture(std::string_view jpeg);

  [[nodiscard]] PageCounts counts() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace palpable
