/// @file
/// A socket on this machine that tells whoever connects what happens, a line of JSON at a time, and
/// waits for nobody: every function returns at once, whatever clients do.
///
/// A client that does not read fast enough loses whole lines, never part of one, and is told how
/// many. What clients send is read and thrown away. docs/touch_events.md has what a client sees.
#pragma once

#include "palpable/common/base/error.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace palpable {

/// Where to listen. Nothing outside of this machine can connect to either.
struct EventAddress {
  std::filesystem::path socket = {};  ///< of a Unix socket; empty: the port
  int port = 0;                       ///< of 127.0.0.1; 0: any free one
};

/// "unix:PATH", or a port from 0 to 65535; a problem when it is neither.
[[nodiscard]] Result<EventAddress> event_address(const std::string& text);

struct EventServerSettings {
  int most_clients = 16;
  /// Who takes not one byte for so long while something waits for it is closed.
  std::chrono::steady_clock::duration patience = std::chrono::seconds(5);
};

struct EventCounts {
  int clients = 0;                 ///< that were let in
  int refused = 0;                 ///< because there were most_clients already
  int closed_behind = 0;           ///< because they did not read
  std::int64_t dropped_lines = 0;  ///< of all clients together
};

/// Belongs to one thread. Takes no memory per line, except for a client that does not take the
/// whole of it.
class EventServer {
 public:
  using Clock = std::chrono::steady_clock;

  /// Listens. Clients may connect, and wait to be let in.
  ///
  /// The file of a Unix socket belongs to the user alone (mode 0600). One on which nobody listens
  /// any more, as a program that was killed leaves it, is replaced.
  /// @throws Error when somebody listens there, or something else has the name
  explicit EventServer(const EventAddress& address, const EventServerSettings& settings = {});
  EventServer(const EventServer&) = delete;
  EventServer& operator=(const EventServer&) = delete;
  /// Closes everything and removes the socket's file, if it is still this server's.
  ~EventServer();

  /// For people and programs: "unix:PATH", or "127.0.0.1:PORT" with the port that was found.
  [[nodiscard]] const std::string& name() const { return name_; }

  /// From now on clients are let in, and this is the first line that each gets, its end included.
  void greet_with(std::string hello);

  /// Lets clients in, sends what is left over of lines, closes those that do not read. Call it now
  /// and then while there is nothing to send.
  /// @param now  what patience is measured with
  void serve(Clock::time_point now = Clock::now());

  /// serve(), then a line to each client.
  /// @param line  {...} with at least one key, its end included; each client gets it with
  ///              "dropped" put in front of its keys: how many lines it lost before this one
  void send(std::string_view line, Clock::time_point now = Clock::now());

  [[nodiscard]] int client_count() const { return static_cast<int>(clients_.size()); }
  [[nodiscard]] const EventCounts& counts() const { return counts_; }

 private:
  struct Client {
    int descriptor = -1;
    std::string unsent = {};   // the end of the last line that it was sent
    std::size_t sent = 0;      // bytes of `unsent` that are on their way
    Clock::time_point took{};  // when it took something, or nothing waited for it
    std::int64_t dropped = 0;  // lines since the last one
    bool input_ended = false;  // it has closed its side of the connection, or all of it
    bool gone = false;
  };

  void listen_at(const std::filesystem::path& path);
  void listen_at_port(int port);
  void let_in(Clock::time_point now);
  void make_room();
  void send_to(Client& client, std::string_view line);
  static void throw_away_input(Client& client);
  static void send_rest(Client& client, Clock::time_point now);
  void close_gone();

  EventServerSettings settings_;
  std::string name_;
  std::string hello_;
  int listening_ = -1;
  std::filesystem::path socket_;  // the file to be removed; empty: none
  dev_t device_ = 0;              // by which it is known again
  ino_t inode_ = 0;
  std::vector<Client> clients_;
  EventCounts counts_;
};

}  // namespace palpable
