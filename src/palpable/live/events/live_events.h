/// @file
/// The clients of a live run: greets them with the run's bodies and sends them its touches.
#pragma once

#include "palpable/live/events/event_lines.h"
#include "palpable/live/events/event_server.h"

#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace palpable {

inline constexpr const char* kNoEvents = "none";

/// The clients of one run; without effect for kNoEvents. After begin(), send() and serve() may be
/// called on any thread.
class LiveEvents {
 public:
  /// Listens. Clients that connect are accepted only after begin().
  /// @param events  kNoEvents, or a text for event_address()
  /// @throws Error that names --events
  explicit LiveEvents(const std::string& events);

  /// Accepts clients from now on. Called again when the run has a new session, whose bodies may
  /// have other poses; clients that connect later are greeted with these.
  void begin(const Session& session);
  /// Sends the results of a frame.
  void send(const Scene& scene);
  /// Sends the touches of a tick between two frames, as EventLines::tick_line().
  void send(int frame, int tick, double time, std::span<const Touch> touches);
  /// To be called regularly while no frame comes.
  void serve();

  /// The address (EventServer::name()); empty for kNoEvents.
  [[nodiscard]] std::string name() const { return server_ ? server_->name() : ""; }
  /// The numbers of clients and lines in a readable line; empty for kNoEvents.
  [[nodiscard]] std::string text() const;

 private:
  std::optional<EventServer> server_;
  std::optional<EventLines> lines_;
  std::mutex mutex_;  // guards both after begin(): ticks come on another thread
};

}  // namespace palpable
