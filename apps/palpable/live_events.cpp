#include "apps/palpable/live_events.h"

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cstdio>
#include <vector>

namespace palpable::app {

void add_events_option(Command command, std::string& events) {
  command.add_option(
      "--events", events,
      "Tell other programs of touches, forces and poses while the run goes on, a line "
      "of JSON for each frame (docs/touch_events.md): unix:PATH, a socket in the file "
      "system that is the user's alone, or a port of 127.0.0.1, 0: any free one");
}

LiveEvents::LiveEvents(const std::string& events) {
  if (events == kNoEvents) return;
  try {
    server_.emplace(value_or_throw(event_address(events)));
  } catch (const Error& error) { throw Error(fmt::format("--events: {}", error.what())); }
}

void LiveEvents::begin(const Session& session) {
  if (!server_) return;
  const std::vector<EventBody> bodies = event_bodies(session);
  lines_.emplace(bodies);
  server_->greet_with(hello_line(bodies));
  fmt::print("events: {}\n", server_->name());
  std::fflush(stdout);  // at once also for a pipe
}

void LiveEvents::begin_anew(const Session& session) {
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

void LiveEvents::send(const ContactTick& tick) {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->send(lines_->tick_line(tick.frame, tick.number, tick.time, *tick.touches));
}

void LiveEvents::serve() {
  const std::lock_guard lock(mutex_);
  if (lines_) server_->serve();
}

void LiveEvents::report() const {
  if (!server_) return;
  const EventCounts& counts = server_->counts();
  fmt::print(
      "events: {} clients, {} refused, {} closed because they did not read, {} lines dropped\n",
      counts.clients, counts.refused, counts.closed_behind, counts.dropped_lines);
}

}  // namespace palpable::app
