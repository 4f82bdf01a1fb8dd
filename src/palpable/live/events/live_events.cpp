#include "palpable/live/events/live_events.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <vector>

namespace palpable {

LiveEvents::LiveEvents(const std::string& events) {
  if (events == kNoEvents) return;
  try {
    server_.emplace(value_or_throw(event_address(events)));
  } catch (const Error& error) { throw Error(fmt::format("--events: {}", error.what())); }
}

void LiveEvents::begin(const Session& session) {
  if (!server_) return;
  const std::vector<EventBody> bodies = event_bodies(session);
  const std::lock_guard lock(mutex_);
  lines_.emplace(bodies);
  server_->greet_with(hello_line(bodies));
}

void LiveEvents::send(const Scene& scene) {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->send(lines_->line_of(scene));
}

void LiveEvents::send(int frame, int tick, double time, std::span<const Touch> touches) {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->send(lines_->tick_line(frame, tick, time, touches));
}

void LiveEvents::serve() {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->serve();
}

std::string LiveEvents::text() const {
  if (!server_) return {};
  const EventCounts& counts = server_->counts();
  return fmt::format(
      "events: {} clients, {} refused, {} closed because they did not read, {} lines dropped\n",
      counts.clients, counts.refused, counts.closed_behind, counts.dropped_lines);
}

}  // namespace palpable
