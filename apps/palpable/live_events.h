/// @file
/// `palpable live --events`: sends touches to clients during the run.
#pragma once

#include "palpable/live/events/event_lines.h"
#include "palpable/live/events/event_server.h"
#include "palpable/live/player/contact_ticks.h"

#include <mutex>
#include <optional>
#include <string>

namespace palpable::app {

class Command;

inline constexpr const char* kNoEvents = "none";

/// Adds --events to a command.
void add_events_option(Command command, std::string& events);

/// The clients of one run; without effect for kNoEvents. After begin(), send() and serve() may be
/// called on any thread.
class LiveEvents {
 public:
  /// Listens. Clients that connect are accepted only after begin().
  /// @param events  kNoEvents, or a text for event_address()
  /// @throws Error that names --events
  explicit LiveEvents(const std::string& events);

  /// Accepts clients from now on, and prints the address.
  void begin(const Session& session);
  /// Switches to a new session, whose bodies may have other poses; clients that connect later are
  /// greeted with these.
  void begin_anew(const Session& session);
  /// Sends the results of a frame.
  void send(const Scene& scene);
  /// Sends the touches of a tick between two frames.
  void send(const ContactTick& tick);
  /// To be called regularly while no frame comes.
  void serve();
  /// Prints the numbers of clients and lines.
  void report() const;

 private:
  std::optional<EventServer> server_;
  std::optional<EventLines> lines_;
  std::mutex mutex_;  // guards both after begin(): ticks come on another thread
};

}  // namespace palpable::app
