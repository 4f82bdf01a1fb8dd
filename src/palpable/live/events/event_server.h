/// @file
/// A socket on this machine that sends lines of JSON to every client that connects. No function
/// blocks, whatever clients do.
///
/// A client that reads too slowly loses whole lines, never a part of one, and receives their
/// number. Bytes that clients send are read and discarded, unless EventServerSettings::takes_lines.
/// docs/touch_events.md describes the clients' side.
#pragma once

#include "palpable/common/base/error.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace palpable {

/// The address to listen on, reachable from this machine only.
struct EventAddress {
  std::filesystem::path socket = {};  ///< path of a Unix socket; empty: `port` is used
  int port = 0;                       ///< on 127.0.0.1; 0: any free port
};

/// "unix:PATH", or a port from 0 to 65535; a problem when it is neither.
[[nodiscard]] Result<EventAddress> event_address(const std::string& text);

struct EventServerSettings {
  int most_clients = 16;
  /// A client that has pending data and accepts none of it for this long is disconnected.
  std::chrono::steady_clock::duration patience = std::chrono::seconds(5);
  /// Whether clients may send lines, which next_line() returns.
  bool takes_lines = false;
  std::size_t longest_line = std::size_t{1} << 20;  ///< bytes; a longer one ends its client
};

/// A line that a client sent.
struct SentLine {
  std::uint64_t client = 0;  ///< no two clients of a server have the same number
  std::string_view text;     ///< without the line end; valid until the next call to the server
  int skipped = 0;           ///< earlier lines of the client that were not returned
};

struct EventCounts {
  int clients = 0;                 ///< accepted connections
  int refused = 0;                 ///< connections refused because of most_clients
  int closed_behind = 0;           ///< clients disconnected because they did not read
  std::int64_t dropped_lines = 0;  ///< sum over all clients
  int sent_away = 0;               ///< clients disconnected by refuse() or for too long a line
};

/// Used by one thread only. Sending a line allocates nothing, unless a client's socket accepts only
/// a part of it.
class EventServer {
 public:
  using Clock = std::chrono::steady_clock;

  /// Starts to listen. Clients may connect, but are accepted only after greet_with().
  ///
  /// The file of a Unix socket belongs to the user alone (mode 0600). A file that a killed program
  /// left, on which no process listens, is replaced.
  /// @throws Error when a process listens there, or the path is something other than a socket
  explicit EventServer(const EventAddress& address, const EventServerSettings& settings = {});
  EventServer(const EventServer&) = delete;
  EventServer& operator=(const EventServer&) = delete;
  /// Closes all connections and removes the socket's file, unless another server has replaced it.
  ~EventServer();

  /// The address in readable form: "unix:PATH", or "127.0.0.1:PORT" with the actual port.
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Sets the first line for each client, with its line break. Clients are accepted from now on.
  void greet_with(std::string hello);

  /// Accepts clients, sends the pending rest of lines and disconnects clients that do not read.
  /// Must be called regularly also while there is nothing to send.
  /// @param now  the time for the comparison with `patience`
  void serve(Clock::time_point now = Clock::now());

  /// Calls serve(), then sends a line to each client.
  /// @param line  a JSON object with at least one key, and its line break. Each client gets it with
  ///              a first key "dropped" added: the number of lines that this client lost before
  ///              this one
  void send(std::string_view line, Clock::time_point now = Clock::now());

  /// Calls serve(), then sends one line to all clients but one, which gets another. Both as above.
  void send(std::string_view line, std::uint64_t one, std::string_view line_of_one,
            Clock::time_point now = Clock::now());

  /// Only with takes_lines: the newest line that a client has sent and that was not returned yet,
  /// of each client in turn; earlier ones are skipped. To be called after serve(), which reads at
  /// most 64 KiB of each client.
  [[nodiscard]] std::optional<SentLine> next_line();
  /// Sends {"type":"error","reason":...} to a client and disconnects it. Without effect if it has
  /// gone.
  void refuse(std::uint64_t client, std::string_view reason, Clock::time_point now = Clock::now());
  /// Whether this client may still send a line, or has sent one that was not returned.
  [[nodiscard]] bool may_send(std::uint64_t client) const;
  /// Returns when serve() has something to do, after `longest` at the latest.
  void wait(std::chrono::milliseconds longest);

  [[nodiscard]] int client_count() const { return static_cast<int>(clients_.size()); }
  [[nodiscard]] const EventCounts& counts() const { return counts_; }

 private:
  struct Client {
    int descriptor = -1;
    std::string unsent = {};   // the last line, if not all of it was sent
    std::size_t sent = 0;      // bytes of `unsent` that were sent
    Clock::time_point took{};  // last time at which it accepted bytes, or nothing was pending
    std::int64_t dropped = 0;  // lines lost since the last one that was sent
    bool input_ended = false;  // it has closed its sending side, or the whole connection
    bool gone = false;
    std::uint64_t number = 0;
    std::string input = {};  // the beginning of a line, with takes_lines
    std::string line = {};   // the newest whole one
    bool has_line = false;   // it was not returned yet
    int skipped = 0;         // whole lines before it
    bool refused = false;    // it gets what is unsent, then it is disconnected
  };

  void listen_at(const std::filesystem::path& path);
  void listen_at_port(int port);
  void let_in(Clock::time_point now);
  void make_room();
  void send_to(Client& client, std::string_view line);
  void read_input(Client& client, Clock::time_point now);
  void keep_lines(Client& client, std::string_view bytes, Clock::time_point now);
  void refuse(Client& client, std::string_view reason, Clock::time_point now);
  [[nodiscard]] const Client* find(std::uint64_t client) const;
  static void send_rest(Client& client, Clock::time_point now);
  void close_gone();

  EventServerSettings settings_;
  std::string name_;
  std::string hello_;
  int listening_ = -1;
  std::filesystem::path socket_;  // the file to remove; empty: none
  dev_t device_ = 0;              // with inode_: identifies the file that this server made
  ino_t inode_ = 0;
  std::vector<Client> clients_;
  std::uint64_t next_number_ = 1;
  std::size_t turn_ = 0;  // index of the client whose line next_line() returns first
  std::vector<pollfd> polled_;
  EventCounts counts_;
};

}  // namespace palpable
