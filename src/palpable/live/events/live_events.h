/// @file
/// The clients of a live run: greets them with the run's bodies and sends them its touches.
#pragma once

#include "palpable/live/events/event_lines.h"
#include "palpable/live/events/event_server.h"
#include "palpable/live/session/things_line.h"

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

inline constexpr const char* kNoEvents = "none";

/// The clients of one run; without effect for kNoEvents. After begin(), send() and serve() may be
/// called on any thread.
class LiveEvents {
 public:
  /// Listens. Clients that connect are accepted only after begin().
  /// @param events  kNoEvents, or a text for event_address()
  /// @throws Error that names --events
  /// @param takes_things  clients may send what presses: next_things()
  explicit LiveEvents(const std::string& events, bool takes_things = false);

  /// Accepts clients from now on. Called again when the run has a new session, whose bodies may
  /// have other poses; clients that connect later are greeted with these.
  void begin(const Session& session);
  /// The same without a session.
  void begin(const std::vector<EventBody>& bodies, EventWorld world);
  /// Sends the results of a frame.
  void send(const Scene& scene);
  /// Sends the touches of a tick between two frames, as EventLines::tick_line().
  void send(int frame, int tick, double time, std::span<const Touch> touches);
  /// To be called regularly while no frame comes.
  void serve();

  enum class News {
    kNone,
    kThings,   ///< a client has sent a line
    kReleased  ///< the client that pressed has gone, or sent a line that is none: nothing presses
  };
  /// Serves the clients and waits for a line about what presses. One client presses at a time, the
  /// first that sends a line, until it goes; who sends a line meanwhile, or one that is none, is
  /// answered with an error and disconnected. Of several lines only the newest is returned. Throws
  /// nothing.
  /// @param line     of kThings overwritten: its answer is the next send()
  /// @param longest  s, after which it returns kNone; later by the time of one line
  News next_things(ThingsLine& line, double longest);

  /// The address (EventServer::name()); empty for kNoEvents.
  [[nodiscard]] std::string name() const { return server_ ? server_->name() : ""; }
  /// The numbers of clients and lines in a readable line; empty for kNoEvents.
  [[nodiscard]] std::string text() const;

 private:
  News answer(const SentLine& sent, ThingsLine& line);

  std::optional<EventServer> server_;
  std::optional<EventLines> lines_, lines_of_presser_;
  std::optional<std::uint64_t> presser_;  // the client that presses
  std::optional<double> presser_time_;    // s, of its last line
  std::optional<EventExtras> extras_;     // of its answer; nothing: it was sent
  std::mutex mutex_;  // guards all of these after begin(): ticks are sent from another thread
};

}  // namespace palpable
