/// @file
/// `palpable live --events`: whoever connects is told of touches while the run goes on.
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

/// The clients of one run; of kNoEvents nothing happens. From begin() on any thread may tell and
/// serve.
class LiveEvents {
 public:
  /// Listens; who connects waits until begin().
  /// @param events  kNoEvents, or what event_address() reads
  /// @throws Error that names --events
  explicit LiveEvents(const std::string& events);

  /// Lets clients in from now on, and prints where they are to connect.
  void begin(const Session& session);
  /// From now on what is told is of another session, whose bodies may stand elsewhere; who connects
  /// is greeted with that.
  void begin_anew(const Session& session);
  /// Tells what was answered to a frame.
  void tell(const Scene& scene);
  /// What was answered between two frames.
  void tell(const ContactTick& tick);
  /// While no frame comes.
  void serve();
  /// Prints what became of them.
  void report() const;

 private:
  std::optional<EventServer> server_;
  std::optional<EventLines> lines_;
  std::mutex mutex_;  // guards both from begin() on: ticks come on a thread of their own
};

}  // namespace palpable::app
